"""Held-out motion judges what was named; each judge takes back an effect that the others would have kept.

Of a cut recording no true name is lost to how it is cut, or to a simulation that cannot keep its phase.
"""

import numpy as np
import pytest

from bench.diagnosis.add import add, unlimited
from bench.diagnosis.diagnosis import diagnose, gaps_of_steps, time_series
from bench.diagnosis.model import Extension, Recorded, keeps_phase
from bench.diagnosis.name import Suspects
from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import Probabilities
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.search import candidates
from bench.effects.catalogue import catalogue
from bench.effects.effect import Detected
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis
from bench.report.verdict import reason as in_words
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import Motion, Ramps, random_motion, slow_reversals
from tests.diagnosis.constructed import RIG, SINES, moved, only_during, recorded, wave
from tests.diagnosis.hand_made import term
from tests.outside import SlowMemoryFriction
from tests.recorded import PLAIN

MOTION = moved(3.0)
OTHER = moved(3.0, sines=tuple((amplitude, 1.1 * f, phase + 1.0) for amplitude, f, phase in SINES))
LAG = {catalogue()["velocity_filter_lag"]: Detected({"time_constant": 4e-3}, {"time_constant": 1e-5})}
OFFSET, COGGING, HARMONIC = 0.1, 0.15, 60.0
STANDS, JERK = 5.0, 0.02


def spring(motion):
    return 0.02 * motion.position


def strokes(speeds):
    """To each speed - rad/s - and to rest again, one after the other."""
    points = [(0.0, 0.0)]
    for speed in speeds:
        time, rise = points[-1][0], abs(speed) / 600.0
        points += [(time + rise, speed), (time + rise + 0.15, speed)]
        points += [(time + 2.0 * rise + 0.15, 0.0), (time + 2.0 * rise + 0.2, 0.0)]
    return Ramps(points, JERK)


@pytest.fixture(scope="module")
def integrated():
    """An axis on a spring, twice; one that runs forward, stands, and runs backward; one slowly over strong cogging."""
    there = strokes([10.0, 40.0, -2.0, 80.0, 25.0, -2.0, 60.0, 15.0, 90.0])
    back = strokes([-30.0, -70.0, -12.0, -50.0])
    slow = slow_reversals([4.0, 3.0, 6.0, 2.0], 0.6, JERK)
    first, last = strokes([10.0, -40.0, 8.0, -25.0, 6.0, -15.0, 30.0]), strokes([-30.0, -7.0, -12.0, 5.0])
    motions = {k: random_motion(PLAIN.axis, np.random.default_rng(k), 4.0) for k in range(2)}
    motions |= {"stands": Motion((there, Ramps([(0.0, 0.0), (STANDS, 0.0)], JERK), back))}
    motions |= {"cogging": Motion((first, slow, last))}
    sprung = (KINDS["torsion_spring"].draw(PLAIN.axis, 0.6, np.random.default_rng(0), 4.0),)
    effects = {
        **dict.fromkeys(range(2), sprung),
        "stands": (KINDS["torque_offset"](OFFSET), SlowMemoryFriction(0.8, 0.5, 40.0)),
        "cogging": (KINDS["cogging_torque"](COGGING, HARMONIC, 0.4),),
    }
    return PLAIN.record(effects, motions, 3)


def added(trace, holdout, terms, detected=None, rig=RIG):
    """What is kept of effects that somebody names."""
    recordings = Recordings.of(trace, rig, holdout)
    fitted = fit(recordings.rows, Hypothesis(tuple(terms)))
    return add(recordings, Suspects(fitted, (fitted,), Probabilities({}, 1.0), detected or {}, Policy()))


@pytest.mark.parametrize("with_holdout", [True, False])
def test_a_true_effect_is_kept_and_both_gaps_shrink(integrated, with_holdout):
    holdout = integrated[1] if with_holdout else None
    result = added(integrated[0], holdout, [term("torsion_spring")], LAG, PLAIN.rig)
    assert [effect.name for effect in result.effects] == ["torsion_spring"]
    before, after = gaps_of_steps(result, time_series(result))
    assert (before.effect, after.effect) == ("", "torsion_spring")
    for early, late in ((before.torque, after.torque), (before.velocity, after.velocity)):
        assert len(late) == 1 + with_holdout
        assert all(one < 0.3 * other for one, other in zip(late, early, strict=True))
    ((name, reason),) = result.rejected
    assert name == "velocity_filter_lag"
    assert "velocity gap" in in_words(reason) and ("holdout" in in_words(reason)) is with_holdout


def test_a_share_is_that_of_the_residual_it_was_tried_on():
    """A lower cut-off takes a vibration of 40 Hz away, and with it most of the residual that the share is of."""
    trace = recorded(MOTION, spring, lambda motion: 0.3 * np.sin(2.0 * np.pi * 40.0 * motion.time))
    bare = fit_bare(Recordings.of(trace, RIG, None).rows)
    ((term, gain),) = candidates(bare, [catalogue()["torsion_spring"]])
    assert gain == pytest.approx(bare.squares - fit(bare.rows, Hypothesis((term,))).squares, rel=1e-3)


@pytest.mark.parametrize(
    ("here", "there", "name", "shape", "reason"),
    [
        (wave(0.02, 17.0), wave(0.02, 17.0), "cogging_torque", (17.0,), None),
        # so fast that inertia hides it in speed: only torque shows it
        (wave(0.02, 17.0), None, "cogging_torque", (17.0,), "the torque gap of the holdout grows"),
        (only_during(0.08, 1.0, 1.5), None, "load_torque_event", (1.0, 1.5), None),
    ],
    ids=["in both", "in one", "an event, which a holdout may lack"],
)
def test_a_holdout_judges_a_name(here, there, name, shape, reason):
    holdout = recorded(OTHER, *([] if there is None else [there]), seed=1)
    rejected = added(recorded(MOTION, here), holdout, [term(name, *shape)]).rejected
    assert [one for one, _ in rejected] == [name] * (reason is not None)
    assert all(in_words(why).startswith(reason) for _, why in rejected)


def test_a_lag_that_torque_does_not_feel_is_rejected_by_the_velocity_gap():
    trace, holdout = recorded(MOTION, spring), recorded(OTHER, spring, seed=1)
    ((name, reason),) = added(trace, holdout, [term("torsion_spring")], LAG).rejected
    assert name == "velocity_filter_lag"
    assert in_words(reason).startswith("the velocity gap of the holdout grows")


@pytest.mark.parametrize(("gap", "kept"), [((1.0, 2.0), False), ((2.0, 1.0), True), (None, True)])
def test_what_shows_under_the_drive_only_has_to_help_there(gap, kept):
    rows = Recordings.of(recorded(MOTION, spring), RIG, None).rows
    limit = {catalogue()["voltage_limit"]: Detected({"voltage": 40.0}, {"voltage": 1.0})}
    against = unlimited(Extension(rows, Hypothesis((term("torsion_spring"),)), limit, RIG), gap)
    assert (against is None) is kept
    if against is not None:
        assert (against[0], "under the rig's drive grows" in in_words(against[1])) == (1, True)


def test_an_axis_that_stands_in_the_middle_keeps_its_constant_torque(integrated):
    """Beside friction of no catalogue. Its first two thirds go forward, where an offset is friction."""
    result = added(integrated["stands"], None, [term("direction_dependent_friction")], rig=PLAIN.rig)
    assert result.rejected == ()
    (named,) = result.effects  # forward less backward is twice an offset
    assert named.parameters["coulomb_difference"].value == pytest.approx(2.0 * OFFSET, rel=0.02)


def test_a_wave_whose_simulation_loses_its_phase_is_judged_by_its_torque(integrated):
    """Weakly coupled, the simulated axis slips over cogs stiffer than the cascade: A*n > 0.37*J*w**2."""
    found = diagnose(integrated["cogging"], PLAIN.rig)
    assert found.verdict == "explained"
    (named,) = found.effects
    assert named.parameters["harmonic"].value == HARMONIC
    assert named.parameters["amplitude"].value == pytest.approx(COGGING, rel=0.02)
    assert any("torque at the measured position" in warning for warning in found.warnings)


@pytest.mark.parametrize(
    ("one", "drift", "kept"),
    [
        (term("cogging_torque", 60.0), 0.017, True),
        (term("cogging_torque", 60.0), 0.018, False),
        (term("backlash", 0.06, 639.0, 0.5, 0.0), 0.0099, True),
        (term("backlash", 0.06, 639.0, 0.5, 0.0), 0.0101, False),
        (term("torsion_spring"), 1.0, True),
    ],
)
def test_phase_is_kept_within_a_sixth_of_a_turn_of_the_wave_or_of_the_gap(one, drift, kept):
    """A wave out of phase by p leaves |exp(j*p) - 1| of itself: all of it from pi/3 on."""
    trace = recorded(moved(2.0))
    assert keeps_phase([one], Recorded("recording", trace, RIG).drift(trace["position"] + drift)) is kept
