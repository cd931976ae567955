"""Where a remainder is left, intervals of a fit count what the model lacks, as those of `identify` do."""

import numpy as np
import pytest

from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, lay_out
from bench.fit.quantities import uncertain
from bench.fit.rows import Rows
from bench.fit.solution import equations_of, solve
from tests.fit.motions import NAMES, RIG, recording

UNITS = dict.fromkeys(NAMES, "")


def spoiled(seed, drag):
    """A recording with a torque that grows with the square of speed, which the plain axis lacks."""
    trace = recording(np.random.default_rng(seed))
    current = trace["current"] + drag * trace["velocity"] * np.abs(trace["velocity"]) / 0.8
    return trace.with_signals({"current": current}, {"current": "A"})


def base(trace):
    return uncertain(fit(Rows.of(trace, RIG), Hypothesis())).base(UNITS)


def test_intervals_are_those_of_identify_where_more_than_noise_is_left():
    trace = spoiled(1, 4e-6)
    rows = Rows.of(trace, RIG)
    laid = lay_out(rows, Hypothesis())
    found = solve(rows, Hypothesis(), laid, equations_of(rows, laid), offset=False)
    reach = found.misfit[:3]
    assert (reach > 0.5 * found.reach * found.errors[:3]).all()
    for value, error, beside in zip(base(trace).values(), found.errors, reach, strict=False):
        half = 0.5 * (value.ci95[1] - value.ci95[0])
        assert half == pytest.approx(np.hypot(found.reach * error, beside), rel=0.05)


@pytest.mark.parametrize("name", NAMES)
def test_noise_alone_widens_nothing(name):
    clean, least = base(spoiled(0, 0.0))[name], base(spoiled(0, 1e-12))[name]
    assert clean.std_error == pytest.approx(least.std_error, rel=1e-3)
