"""What else is left around a short event is a nuisance: its torque hangs on its edges, through any filter."""

from dataclasses import replace

import numpy as np
import pytest

from bench.arrays import rms
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import AROUND, Hypothesis, Term
from bench.fit.quantities import uncertain
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.trace.filter import GaussianFilter
from tests.diagnosis.constructed import RIG, moved, recorded

TORQUE, START, STOP = 0.06, 1.7, 1.76
EVENT = Term(catalogue()["load_torque_event"], (START, STOP))
BESIDE = replace(EVENT, around=(START - 0.03, STOP + 0.03))


@pytest.fixture(scope="module")
def trace():
    """A push on the axis beside a slow torque that no effect is."""
    return recorded(
        moved(),
        lambda m: TORQUE * ((m.time >= START) & (m.time < STOP)),
        lambda m: 0.03 * np.cos(2.0 * np.pi * 0.9 * (m.time - START)),
        noise=0.2,
    )


@pytest.mark.parametrize("width", [2e-3, 8e-3])
def test_the_torque_of_a_push_beside_what_runs_slowly(trace, width):
    rows = Rows.of(trace, RIG).through(GaussianFilter(width, trace.sample_period))
    plain, beside = (fit(rows, Hypothesis((term,))) for term in (EVENT, BESIDE))
    assert abs(plain.strengths(0)[0] / TORQUE - 1.0) > 0.2
    assert beside.strengths(0) == pytest.approx([TORQUE], rel=0.04)
    assert sum(isinstance(owner, int) for owner in beside.layout.owners) == 1
    far = np.abs(rows.time - 0.5 * (START + STOP)) > 0.1
    assert not beside.columns[far][:, beside.owners == AROUND].any()


def test_it_belongs_to_one_recording_and_is_kept_with_it(trace):
    rows, other = (Rows.of(each, RIG) for each in (trace, replace(trace, origin="another")))
    fitted = fit(rows, Hypothesis((BESIDE,)))
    balance = Balance.from_table(Balance.of(fitted).table(), "model.toml")
    assert balance.hypothesis.terms[0].around == BESIDE.around
    np.testing.assert_allclose(balance.left(rows), fitted.residual, atol=1e-12)
    effectless = fitted.effort - fitted.columns[:, :4] @ fitted.theta[:4]
    np.testing.assert_allclose(balance.left(other), effectless, atol=1e-12)
    assert rms(balance.left(other)) > rms(fitted.residual)


def test_a_start_among_rows_that_hang_on_impacts_is_known_by_the_rows_around_them():
    """Rows behind may move with it by the impacts alone, which the fit does not hold: they tell it no better."""
    trace = recorded(moved(), lambda m: TORQUE * ((m.time >= START) & (m.time < STOP)), noise=0.2)
    fitted = fit(Rows.of(trace, RIG), Hypothesis((EVENT,)))
    gap = (START - 0.013, START + 0.027)
    hidden = replace(fitted, determined=(fitted.time < gap[0]) | (fitted.time > gap[1]))
    sure, open_ = (uncertain(each).quantities(0, lambda *_: "s") for each in (fitted, hidden))
    half = {key: 0.5 * (value.ci95[1] - value.ci95[0]) for key, value in open_.items()}
    assert half["start"] == pytest.approx(gap[1] - gap[0], rel=0.1)
    assert 0.5 * (sure["start"].ci95[1] - sure["start"].ci95[0]) < 0.1 * half["start"]
    assert half["end"] < 0.1 * half["start"]
