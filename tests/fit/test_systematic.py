"""An effect too weak to be named: what it may move is counted; what is not there is not."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.fit import fit, hint
from bench.fit.hypothesis import Hypothesis, Term, lay_out
from bench.fit.identify import identify
from bench.fit.rows import Rows
from tests.fit.motions import RIG, Truth, recording

#: Relative change of the torque constant over a recording.
DRIFT = 0.01


def drifting(trace, drift=DRIFT):
    """The recording of an axis whose motor gives more torque per ampere in the end."""
    gain = 1.0 + drift * trace.time / trace.time[-1]
    return trace.with_signals({"current": trace["current"] / gain}, {"current": "A"})


def dragged(trace, drag):
    """The recording of an axis with a torque that grows with the square of speed - N*m*s**2/rad**2."""
    current = trace["current"] + drag * trace["velocity"] * np.abs(trace["velocity"]) / 0.8
    return trace.with_signals({"current": current}, {"current": "A"})


def hinted(trace):
    return hint(fit(Rows.of(trace, RIG), Hypothesis()), catalogue().values())


def test_a_weak_drift_is_hinted_at():
    beside = hinted(drifting(recording(np.random.default_rng(1))))
    assert beside is not None
    assert beside.hypothesis.names == ("torque_constant_drift",)


def standard_errors(trace):
    """By how many of its own a drift beside the plain axis differs from zero, by plain least squares."""
    fitted = fit(Rows.of(trace, RIG), Hypothesis())
    drift = lay_out(fitted.rows, Hypothesis((Term(catalogue()["torque_constant_drift"]),)), missing={0: fitted.left})
    theta, *_ = np.linalg.lstsq(drift.columns, drift.effort, rcond=None)
    variance = np.linalg.inv(drift.columns.T @ drift.columns)[-1, -1]
    return abs(theta[-1]) / (np.sqrt(variance * fitted.rows.correlation) * fitted.floor)


@pytest.mark.parametrize(("seed", "drift"), [(0, 2.3e-3), (2, 2.1e-3), (0, 1.9e-3), (2, 1.6e-3)])
def test_three_standard_errors_are_a_hint(seed, drift):
    trace = drifting(recording(np.random.default_rng(seed)), drift)
    away = standard_errors(trace)
    assert 2.6 < away < 3.5 and abs(away - 3.0) > 0.1
    assert (hinted(trace) is not None) == (away > 3.0)


def test_the_interval_of_the_inertia_holds_it_under_a_weak_drift():
    for seed in range(10):
        trace = recording(np.random.default_rng(seed))
        low, high = identify(drifting(trace), RIG)["moment_of_inertia"].ci95
        assert low < Truth().inertia < high


def test_the_interval_of_viscous_friction_holds_it_under_a_weak_drag():
    """Off by a third to a half of itself: without the hint no interval holds it, at 1.02 noise floors."""
    traces = [dragged(recording(np.random.default_rng(seed)), 2e-6) for seed in range(10)]
    estimates = [identify(trace, RIG)["viscous_friction_coefficient"] for trace in traces]
    assert all(found.value > 1.3 * Truth().viscous for found in estimates)
    assert sum(found.ci95[0] < Truth().viscous < found.ci95[1] for found in estimates) >= 8


def test_what_chance_makes_is_no_hint():
    """Some ten effects tried at three standard errors each: 3 in 100 recordings by chance."""
    hints = [hinted(recording(np.random.default_rng(seed))) is not None for seed in range(40)]
    assert sum(hints) <= 5  # of 40: by chance one time in 300
