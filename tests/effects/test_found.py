"""What single effects find in a fit: an eccentric encoder, short pushes, friction by load, waves at high speed."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from bench.diagnosis.name import alike
from bench.diagnosis.policy import POLICY
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.effects.catalogue import catalogue
from bench.effects.encoder_eccentricity import EFFECT
from bench.effects.load_torque_event import EFFECT as EVENT
from bench.effects.waves import followed
from bench.fit.fit import fit
from bench.fit.hypothesis import Term
from bench.trace.filter import GaussianFilter
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from tests.diagnosis.constructed import bare, moved, recorded
from tests.effects.recording import signals
from tests.recorded import QUIET

VALUES = {"amplitude": 0.05, "phase": 0.9}


def proposed(stiffness):
    """The bare fit of an eccentric axis on a spring - N*m/rad -, and what is proposed beside it."""
    motion = moved(5.0, drift=3.0)
    trace = recorded(motion, lambda motion: stiffness * motion.position)
    position, velocity = EFFECT.measured(VALUES, motion.position, motion.velocity)
    wrong = {
        "position": trace["position"] + position - motion.position,
        "velocity": trace["velocity"] + velocity - motion.velocity,
    }
    fitted = bare(trace.with_signals(wrong, {"position": "rad", "velocity": "rad/s"}))
    return fitted, EFFECT.propose(fitted)


def test_it_is_proposed_as_it_is():
    _, (found,) = proposed(0.0)
    sine, cosine = found.shape
    assert np.hypot(sine, cosine) == pytest.approx(VALUES["amplitude"], rel=0.02)
    assert np.arctan2(cosine, sine) == pytest.approx(VALUES["phase"], abs=0.02)


def test_an_inertia_that_another_effect_takes_makes_no_eccentricity():
    """A spring of 0.2 N*m/rad turns the sign of a bare J, by which the encoder would err by 3 rad."""
    fitted, found = proposed(0.2)
    assert fitted.base.inertia < 0.0
    assert max(np.hypot(*each.shape) for each in found) <= EFFECT.quantities[0].upper
    for each in found:
        saved = fitted.squares - fit(fitted.rows, fitted.hypothesis.plus(Term(EFFECT, each.shape))).squares
        assert each.gain == pytest.approx(saved)


def left(time, pushes, other, noise=0.02):
    """Of a fit that lacks some pushes - N*m, s, s - and another torque (n,): what `apart` asks of it."""
    rng = np.random.default_rng(3)
    values = gaussian_filter1d(noise / 0.38 * rng.standard_normal(time.size), 2.0) + other
    values += sum(torque * ((time >= start) & (time < stop)) for torque, start, stop in pushes)
    return SimpleNamespace(time=time, residual=values, scope=SimpleNamespace(width=2e-3))


TIME = np.arange(10_000) * 1e-3
SLOW = 0.12 * np.sin(2.0 * np.pi * 0.7 * TIME) + 0.08 * np.sin(2.0 * np.pi * 1.9 * TIME + 1.0)


@pytest.mark.parametrize("other", [0.0 * TIME, SLOW])
@pytest.mark.parametrize("pushes", [[(0.5, 3.0, 3.05)], [(-0.7, 4.0, 4.1), (0.6, 7.2, 7.27)]])
def test_short_ones_are_distinguished_by_themselves_from_what_runs_slowly(pushes, other):
    found = sorted(EVENT.apart(left(TIME, pushes, other)))
    assert len(found) == len(pushes)
    for (shape, around), (_, start, stop) in zip(found, pushes, strict=True):
        np.testing.assert_allclose(shape, (start, stop), atol=4e-3)
        assert around[0] < start < stop < around[1]


@pytest.mark.parametrize(
    "pushes",
    [
        [],  # nothing
        [(0.6 * (-1) ** k, 0.5 + 0.4 * k, 0.56 + 0.4 * k) for k in range(20)],  # at every reversal
        [(0.6 * 0.8**k, 0.5 + k, 0.56 + k) for k in range(9)],  # each a little weaker
        [(0.6, 3.0, 4.5)],  # too long to be distinguished from what else varies
    ],
)
def test_none_where_nothing_stands_out(pushes):
    assert not EVENT.apart(left(TIME, pushes, SLOW))


def test_none_across_a_gap_in_the_rows():
    """What a stretch would reach over is not there: rows around a reversal are not used."""
    kept = (TIME < 3.0) | (TIME > 3.05)
    fitted = left(TIME, [(0.5, 2.99, 3.06)], SLOW)
    cut = SimpleNamespace(time=TIME[kept], residual=fitted.residual[kept], scope=fitted.scope)
    assert not EVENT.apart(cut)


NAME = "directional_load_friction"


@pytest.mark.parametrize(("amplitude", "also"), [(0.004, (NAME,)), pytest.param(0.2, (), marks=pytest.mark.slow)])
def test_friction_by_the_motors_torque_may_be_by_the_loads_beside_a_small_load(amplitude, also):
    """Of the independent integrator: no friction by the load's torque, which a small load does not tell."""
    hidden = KINDS["load_dependent_friction"](0.1), KINDS["unbalance"](amplitude, 0.4)
    trace = QUIET.record({"both": hidden}, random_motion(QUIET.axis, np.random.default_rng(3), 6.0), 3)["both"]
    recordings = Recordings.of(trace, QUIET.rig, None)
    terms = Term(catalogue()["load_dependent_friction"]), Term(catalogue()["unbalance"])
    bare = fit_bare(recordings.rows)
    fitted = fit(bare.rows, bare.hypothesis.with_terms(terms))
    assert fitted.strengths(0)[0] == pytest.approx(0.1, rel=0.05)
    assert [alike(fitted, index, POLICY) for index in range(2)] == [also, ()]


PERIOD, WIDTH, NUMBER = 2e-3, 3e-3, 12.0


@pytest.mark.parametrize("acceleration", [180.0, 1000.0])
def test_a_wave_that_the_samples_cease_to_follow_passes_the_filter_as_little_as_a_whole_one(acceleration):
    """A sine of w passes with exp(-(w*width)**2/2); one that broke off passed with a hundred times as much."""
    time = np.arange(0.0, 360.0 / acceleration, PERIOD)
    position, velocity = 0.5 * acceleration * time**2, acceleration * time
    seen = followed(replace(signals(), velocity=velocity, sample_period=PERIOD), NUMBER)
    smooth = GaussianFilter(WIDTH, PERIOD)
    (passed,) = smooth.columns([[(seen * np.sin(NUMBER * position), 0)]])
    frequency = NUMBER * velocity[smooth.margin : time.size - smooth.margin]
    assert frequency[-1] > 2.0 * np.pi / PERIOD
    fast = frequency > 2.5 / WIDTH
    assert np.abs(passed[fast]).max() < np.exp(-0.5 * 2.5**2)
    assert np.abs(passed[frequency > 4.0 / WIDTH]).max() < 5e-3
