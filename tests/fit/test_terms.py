"""Terms of a fit: what is around an event, frictions that multiply, shapes that are searched, hum beside them."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from bench.arrays import rms
from bench.diagnosis.model import Extension
from bench.diagnosis.policy import Policy
from bench.diagnosis.search import search
from bench.effects.catalogue import catalogue
from bench.fit.fit import FURTHEST, fit, shaped, together
from bench.fit.hum import mains
from bench.fit.hypothesis import AROUND, Hypothesis, Term
from bench.fit.quantities import strengths_are_sure, uncertain
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.trace.filter import GaussianFilter
from tests.diagnosis.constructed import CONSTANT, COULOMB, RIG, bare, moved, recorded, wave

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
    balance = Balance.from_table({"torque_balance": Balance.of(fitted).table()}, "model.toml")
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


RISE, SPEED, AMPLITUDE = 0.06, 6.0, 1.5
MOTION = moved(4.0)


def frictions(duration, motion):
    """Coulomb friction with a Stribeck rise, which decays as the axis warms up; less the Coulomb friction alone."""
    level = COULOMB * motion.sign + RISE * motion.sign * np.exp(-((motion.velocity / SPEED) ** 2))
    return level * (1.0 + AMPLITUDE * np.exp(-motion.time / duration)) - COULOMB * motion.sign


def fitted(duration, seed):
    effects = [Term(catalogue()["stribeck_friction"], (SPEED,)), Term(catalogue()["friction_warmup"], (duration,))]
    trace = recorded(MOTION, partial(frictions, duration), seed=seed, noise=0.3)
    return fit(Rows.of(trace, RIG), Hypothesis((*effects,)))


def test_scatter_of_the_levels_is_what_their_intervals_say():
    found = [uncertain(together(fitted(2.0, seed))) for seed in range(16)]
    places = [int(np.flatnonzero(found[0].fitted.owners == name)[0]) for name in ("coulomb", 0, 1)]
    scatter = np.std([each.values[places] for each in found], axis=0, ddof=1)
    said = np.sqrt(np.mean([np.diag(each.covariance)[places] for each in found], axis=0))
    assert scatter / said == pytest.approx(np.ones(3), abs=0.42)


def test_friction_that_decays_longer_than_the_recording_lasts_is_sure_without_its_size():
    """Of a decay over 40 s, 6 s show the beginning: not to what friction it decays, which its amplitude counts in."""
    slow = fitted(40.0, 0)
    (amplitude, *_), numbers = slow.strengths(1), uncertain(slow)
    size = numbers.quantities(1, lambda *_: "")["relative_amplitude"]
    assert amplitude > 0.0
    assert size.ci95[0] < 0.0
    assert strengths_are_sure(slow)[slow.owners == 1][0]


def test_damping_of_bristles_at_its_bound_of_zero_has_an_interval():
    """Bristles without damping: noise may take it to the bound, where no other bound says how large it is at most."""
    bristles = catalogue()["presliding_friction"]
    held = next(
        one
        for seed in range(12)
        if (one := fit(Rows.of(recorded(MOTION, seed=seed), RIG), Hypothesis((Term(bristles, (60.0,)),)))).held
        if one.held[-1] == one.theta.size - 1
    )
    assert held.theta[-1] == 0.0
    assert uncertain(held).covariance[held.theta.size - 1, held.theta.size - 1] > 0.0


COUPLING, COGGING, STRIBECK = (
    catalogue()[name] for name in ("elastic_coupling", "cogging_torque", "stribeck_friction")
)


def stribeck(motion):
    return 0.06 * motion.sign * np.exp(-((motion.velocity / 4.0) ** 2))


def test_the_search_of_a_rigid_axis_for_a_coupling_stays_within_numbers():
    rows, term = Rows.of(recorded(moved()), RIG), Term(COUPLING, (100.0, 0.04))
    (found,) = shaped(fit(rows, Hypothesis()), Hypothesis((term,)), 0).hypothesis.terms
    for k, (value, start) in enumerate(zip(found.shape, term.shape, strict=True)):
        assert abs(np.log(value / start)) <= FURTHEST * COUPLING.reach(term.shape, k) * (1.0 + 1e-9)


@pytest.mark.parametrize("start", [1.0, 2.5, 7.0])
def test_one_shape_is_found_from_either_side(start):
    rows = Rows.of(recorded(moved(), stribeck), RIG)
    found = shaped(fit(rows, Hypothesis()), Hypothesis((Term(STRIBECK, (start,)),)), 0)
    assert found.hypothesis.terms[0].shape[0] == pytest.approx(4.0, rel=0.05)
    for beside in (0.98, 1.02):
        near = found.hypothesis.reshaped(0, (beside * found.hypothesis.terms[0].shape[0],))
        assert fit(rows, near).squares > found.squares


def test_shapes_searched_together_end_no_higher_than_one_after_the_other():
    """From shapes off by a tenth: derivatives by steps that a fit resolves, not by those of rounding."""
    rows = Rows.of(recorded(moved(), stribeck, wave(0.05, 6.0, 0.3)), RIG)
    fitted = fit(rows, Hypothesis((Term(STRIBECK, (4.6,)), Term(COGGING, (6.0,)))))
    once = shaped(fit(rows, Hypothesis()), fitted.hypothesis, 0)
    both = together(fitted)
    assert both.squares <= once.squares * (1.0 + 1e-4)
    assert both.squares < fitted.squares
    assert both.hypothesis.terms[0].shape[0] == pytest.approx(4.0, rel=0.05)


#: Amplitudes of the current's hum - A - and of cogging - N*m.
HUM, WAVES = 0.06, 0.03


@pytest.fixture(scope="module")
def humming():
    """Cogging recorded through a current sensor that picks up the mains."""

    def hum(motion):
        return CONSTANT * HUM * np.sin(2.0 * np.pi * 50.0 * motion.time + 0.3)

    return bare(recorded(moved(), wave(WAVES, 6.0), pick_up=hum))


def test_hum_stays_when_terms_go():
    both = Hypothesis((Term(COGGING, (6.0,)), Term(COGGING, (9.0,))), (50.0,))
    assert both.without(0).hum == both.with_terms(()).hum == (50.0,)
    assert both.plus(Term(COGGING, (4.0,))).hum == both.reshaped(0, (5.0,)).hum == (50.0,)


def test_steps_credit_an_effect_only_with_what_the_humming_axis_leaves(humming):
    """RMS before: cogging's as the filter passes it, and noise; hum would add (HUM*k_T)**2/2 to its square."""
    found = search(humming, [COGGING], Policy())
    assert found.last.hypothesis.hum == humming.hypothesis.hum != ()
    before, after = (stage.fitted for stage in Extension(humming.rows, found.last.hypothesis, {}, RIG).stages)
    smooth = humming.rows.conditioning.filter
    wave_rms = rms(humming.rows.table(lambda s: [[(WAVES * np.sin(6.0 * s.position), 0)]]))
    assert before.rms == pytest.approx(np.hypot(wave_rms, after.floor), rel=0.03)
    assert before.rms == pytest.approx(humming.rms)
    assert after.chi < 1.12
    passed = np.exp(-0.5 * (2.0 * np.pi * 50.0 * smooth.width) ** 2)
    with_hum = fit(humming.rows, Hypothesis()).rms
    assert with_hum == pytest.approx(np.hypot(before.rms, CONSTANT * HUM * passed / np.sqrt(2.0)), rel=0.05)
    assert with_hum > 1.3 * before.rms


@pytest.mark.parametrize("line", [50.0, 60.0, 100.0, 120.0, 150.0])
def test_lines_of_the_mains_and_their_multiples_are_found(humming, line):
    """A hundredth of a hertz off, as grids are."""
    rows, rng = humming.rows, np.random.default_rng(4)
    residual = np.sin(2.0 * np.pi * (line + 0.01) * rows.time) + 0.1 * rng.standard_normal(rows.time.size)
    assert mains(rows, residual) == pytest.approx((line,), abs=0.1)
