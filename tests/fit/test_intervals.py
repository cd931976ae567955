"""Intervals: how often they contain the truth, their correlations, and what misfit, weak effects and tolerances add."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.fit import fit, hint
from bench.fit.hypothesis import Hypothesis, Term, lay_out
from bench.fit.identify import identify
from bench.fit.quantities import uncertain
from bench.fit.rows import Rows
from bench.fit.solution import NOISE_ALONE, equations_of, solve
from bench.rig.rig import Rig
from tests.fit.motions import NAMES, RIG, Truth, recording

RECORDINGS = 80
#: Given where intervals are not about it, which takes a fifth of the time - Hz.
CUTOFF = 66.0


def made(seed, **what):
    return recording(np.random.default_rng(seed), **what)


def dragged(trace, drag):
    """The recording of an axis with a torque that grows with the square of speed - N*m*s**2/rad**2."""
    current = trace["current"] + drag * trace["velocity"] * np.abs(trace["velocity"]) / 0.8
    return trace.with_signals({"current": current}, {"current": "A"})


def drifting(trace, drift=0.01):
    """The recording of an axis whose motor gives more torque per ampere in the end."""
    gain = 1.0 + drift * trace.time / trace.time[-1]
    return trace.with_signals({"current": trace["current"] / gain}, {"current": "A"})


def coverage(count, seed, **what):
    rng, inside = np.random.default_rng(seed), []
    for _ in range(count):
        found = identify(recording(rng, **what), RIG)
        intervals = (found[name].ci95 for name in NAMES)
        inside.append([low <= value <= high for (low, high), value in zip(intervals, Truth().values, strict=True)])
    share = np.mean(inside, axis=0)
    print(f"\ncoverage of nominal 95 %, {what}: {share} (J, viscous, Coulomb)")
    return share


@pytest.mark.parametrize("correlation", [0.0, 0.95])
def test_intervals_cover(correlation):
    share = coverage(40, 20, duration=2.0, correlation=correlation)
    assert (share > 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / 40)).all()


@pytest.mark.slow
@pytest.mark.parametrize("duration", [2.0, 6.0, 20.0])
@pytest.mark.parametrize("correlation", [0.0, 0.9, 0.95, 0.99])
def test_intervals_cover_over_many_recordings(duration, correlation):
    assert (coverage(400, 21, duration=duration, correlation=correlation) > 0.90).all()


def test_correlations_are_those_of_repeated_recordings():
    """Of the same motion with other noise."""
    rng, plain, found = (
        np.random.default_rng(4),
        made(3, torque_noise=0.0, velocity_noise=0.0, bias=15.0, duration=2.0),
        [],
    )
    for _ in range(RECORDINGS):
        noisy = {
            "velocity": plain["velocity"] + rng.normal(scale=0.03, size=len(plain)),
            "current": plain["current"] + rng.normal(scale=0.01, size=len(plain)),
        }
        found.append(identify(replace(plain, signals={**plain.signals, **noisy}), RIG, CUTOFF))
    values = np.array([[one[name].value for name in NAMES] for one in found])
    stated = np.mean([one.correlation[:3, :3] for one in found], axis=0)
    assert np.abs(stated[1, 2]) > 0.5  # speed and its sign are alike
    # the standard error of a correlation r of n pairs is (1 - r**2)/sqrt(n)
    assert np.all(np.abs(np.corrcoef(values.T) - stated) < 3.5 * (1.0 - stated**2) / np.sqrt(RECORDINGS) + 1e-12)


def test_correlations_of_several_recordings_are_those_of_their_sum():
    each = [made(seed, duration=4.0) for seed in (5, 6)]
    both, one = identify(each, RIG), identify(each[0], RIG)
    assert both.correlation.shape == (len(both), len(both))
    assert np.allclose(np.diag(both.correlation)[:3], 1.0)
    assert np.allclose(np.sqrt(np.diag(both.covariance)[:3]), [both[name].std_error for name in NAMES])
    assert np.all(np.linalg.eigvalsh(both.correlation[:3, :3]) > 0.0)
    assert np.isnan(one.correlation[[*one].index("load_moment_of_inertia")]).all()


def base(trace, *terms):
    """Parameters of a fit with their intervals, and by how many floors it leaves a residual."""
    fitted = fit(Rows.of(trace, RIG), Hypothesis(terms))
    return uncertain(fitted).base(dict.fromkeys(NAMES, "")), fitted.chi


def test_intervals_of_a_fit_count_what_the_model_lacks_as_those_of_identify():
    trace = dragged(made(1), 4e-6)
    rows = Rows.of(trace, RIG)
    laid = lay_out(rows, Hypothesis())
    found = solve(rows, Hypothesis(), laid, equations_of(rows, laid), offset=False)
    reach = found.misfit[:3]
    assert (reach > 0.5 * found.reach * found.errors[:3]).all()
    for value, error, beside in zip(base(trace)[0].values(), found.errors, reach, strict=False):
        assert value.half_width == pytest.approx(np.hypot(found.reach * error, beside), rel=0.05)


def test_noise_alone_widens_nothing():
    clean, least = base(made(0))[0], base(dragged(made(0), 1e-12))[0]
    for name in NAMES:
        assert clean[name].std_error == pytest.approx(least[name].std_error, rel=1e-3)


def test_beside_a_name_a_friction_too_weak_for_one_counts():
    """It leaves 1.07 floors. Without a name nothing counts below 1.12, as with `identify`."""
    trace, drag = dragged(made(1), 4e-6), Term(catalogue()["quadratic_drag"])
    weak = 0.04 * np.sign(trace["velocity"]) * np.exp(-((trace["velocity"] / 15.0) ** 2))
    with_weak = trace.with_signals({"current": trace["current"] + weak}, {"current": "A"})
    (less, without), (more, having) = (base(one, drag) for one in (trace, with_weak))
    assert 1.03 < having < NOISE_ALONE
    for narrow, wide in zip(less.values(), more.values(), strict=True):
        assert wide.half_width > 1.05 * having / without * narrow.half_width


def hinted(trace):
    return hint(fit(Rows.of(trace, RIG), Hypothesis()), catalogue().values())


def standard_errors(trace):
    """By how many of its own a drift beside the plain axis differs from zero, by plain least squares."""
    fitted = fit(Rows.of(trace, RIG), Hypothesis())
    drift = lay_out(fitted.rows, Hypothesis((Term(catalogue()["torque_constant_drift"]),)), missing={0: fitted.left})
    theta, *_ = np.linalg.lstsq(drift.columns, drift.effort, rcond=None)
    variance = np.linalg.inv(drift.columns.T @ drift.columns)[-1, -1]
    return abs(theta[-1]) / (np.sqrt(variance * fitted.rows.correlation) * fitted.floor)


@pytest.mark.parametrize(("seed", "drift"), [(0, 2.3e-3), (2, 2.1e-3), (0, 1.9e-3), (2, 1.6e-3)])
def test_an_effect_too_weak_for_a_name_is_a_hint_from_three_standard_errors_on(seed, drift):
    trace = drifting(made(seed), drift)
    away, beside = standard_errors(trace), hinted(trace)
    assert 2.6 < away < 3.5 and abs(away - 3.0) > 0.1
    assert (beside is not None) == (away > 3.0)
    assert beside is None or beside.hypothesis.names == ("torque_constant_drift",)


def test_the_interval_of_the_inertia_contains_it_under_a_weak_drift():
    for seed in range(6):
        low, high = identify(drifting(made(seed)), RIG)["moment_of_inertia"].ci95
        assert low < Truth().inertia < high


def test_the_interval_of_viscous_friction_contains_it_under_a_weak_drag():
    """Off by a third to a half of itself: without the hint no interval contains it, at 1.02 noise floors."""
    estimates = [identify(dragged(made(seed), 2e-6), RIG)["viscous_friction_coefficient"] for seed in range(6)]
    assert all(found.value > 1.3 * Truth().viscous for found in estimates)
    assert sum(found.ci95[0] < Truth().viscous < found.ci95[1] for found in estimates) >= 5


def test_what_chance_makes_is_no_hint():
    """Some ten effects tried at three standard errors each: 3 in 100 recordings by chance."""
    hints = [hinted(made(seed)) is not None for seed in range(30)]
    assert sum(hints) <= 4  # of 30: by chance one time in 500


class UncertainTwice(Rig):
    """A rig whose torque constant may be off for two reasons that do not know of each other."""

    def within_tolerance(self):
        for factor in (1.03, 1.04):
            motor = self.motor.model_copy(update={"torque_constant": factor * self.motor.torque_constant})
            yield self.model_copy(update={"motor": motor})


@pytest.mark.parametrize("count", [1, 3])
def test_independent_tolerances_add_in_squares_and_are_common_to_recordings(count):
    """All coefficients go with the torque constant, and no average over recordings lessens what it leaves open."""
    traces = [made(k) for k in range(count)]
    exact, found = (identify(traces, rig, CUTOFF) for rig in (RIG, UncertainTwice(**dict(RIG))))
    for name in NAMES:
        reach = 0.05 * found[name].value
        assert count > 1 or found[name].value == exact[name].value
        assert found[name].half_width == pytest.approx(np.hypot(exact[name].half_width, reach), rel=5e-3)
        if count == 1:
            error = np.hypot(exact[name].std_error, reach / 1.959964)
            assert found[name].std_error == pytest.approx(error, rel=5e-3)
