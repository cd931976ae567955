"""Where a remainder is left, intervals of a fit count what the model lacks, as those of `identify` do."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term, lay_out
from bench.fit.quantities import uncertain
from bench.fit.rows import Rows
from bench.fit.solution import NOISE_ALONE, equations_of, solve
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


def test_beside_a_name_a_friction_too_weak_for_one_counts():
    """It leaves 1.07 floors. Without a name nothing counts below 1.12, as with `identify`."""
    trace = spoiled(1, 4e-6)
    velocity = trace["velocity"]
    weak = 0.04 * np.sign(velocity) * np.exp(-((velocity / 15.0) ** 2))
    with_weak = trace.with_signals({"current": trace["current"] + weak}, {"current": "A"})
    drag = Hypothesis((Term(catalogue()["quadratic_drag"]),))
    without, having = (fit(Rows.of(one, RIG), drag) for one in (trace, with_weak))
    assert 1.03 < having.chi < NOISE_ALONE
    less, more = (np.array([one.half_width for one in uncertain(which).base(UNITS).values()])
                  for which in (without, having))  # fmt: skip
    assert (more > 1.05 * having.chi / without.chi * less).all()
