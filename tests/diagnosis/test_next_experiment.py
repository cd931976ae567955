"""The experiment that is proposed tells the two explanations apart: recorded along it, each is named as it is.

Truth comes from the independent integrator.
"""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.diagnosis import diagnose
from bench.diagnosis.next_experiment import LONG_ENOUGH, motions, one_direction, separation
from bench.diagnosis.recordings import Recordings
from bench.effects.present import Present
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.drive import References
from bench.rig.rig import load_rig
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import Motion, Ramps, random_motion
from bench.validation.independent.rig import write_rig
from tests.recorded import PLAIN


def offset(seconds):
    return (KINDS["torque_offset"].draw(PLAIN.axis, 0.6, np.random.default_rng(1), seconds),)


def recorded(cases, seed):
    """Recordings by the names of cases, effects and a motion each; with the same noise."""
    effects, motions = ({name: case[k] for name, case in cases.items()} for k in range(2))
    return PLAIN.record(effects, motions, seed, dict.fromkeys(cases, 0))


def one_way(seconds=6.0):
    """Speeds between 20 and 120 rad/s, never reversed."""
    rng = np.random.default_rng(0)
    time = np.concatenate([[0.0, 0.1], 0.3 + np.arange(24) * (seconds - 0.6) / 24, [seconds - 0.1, seconds]])
    speed = np.concatenate([[0.0, 0.0], rng.uniform(20.0, 120.0, 24), [0.0, 0.0]])
    return Motion((Ramps(list(zip(time, speed, strict=True)), 0.02),))


def along(references: References, repetitions: int) -> Motion:
    """A planned motion as the independent drive follows it."""
    points = list(zip(references.time[::20].tolist(), references.velocity[::20].tolist(), strict=True))
    return Motion(tuple(Ramps([*points, (float(references.time[-1]) + 0.05, 0.0)], 0.005) for _ in range(repetitions)))


#: What is hidden in a motion of one direction.
HIDDEN = {"nothing": (), "an offset": offset(6.0)}


@pytest.fixture(scope="module")
def recordings():
    cases = {name: (effects, one_way()) for name, effects in HIDDEN.items()}
    cases["reversals, an offset"] = offset(5.0), random_motion(PLAIN.axis, np.random.default_rng(2), 5.0)
    cases["reversals, nothing"] = (), random_motion(PLAIN.axis, np.random.default_rng(3), 5.0)
    return recorded(cases, seed=4)


@pytest.fixture(scope="module")
def followed(recordings):
    """Diagnosis, experiment it proposes and recording along that, by what is hidden in a motion of one direction."""
    found, planned, cases = {}, {}, {}
    for name, effects in HIDDEN.items():
        first = found[name] = diagnose(recordings[name], PLAIN.rig)
        assert first.next_experiment is not None and first.model is not None, name
        proposals = dict(motions(Recordings.of(recordings[name], PLAIN.rig, None), first.model.model))
        planned[name] = proposals[first.next_experiment.profile]
        cases[name] = effects, along(planned[name], first.next_experiment.repetitions)
    along_them = recorded(cases, seed=5)
    return {name: (found[name], planned[name], along_them[name]) for name in HIDDEN}


@pytest.mark.parametrize("hidden", HIDDEN)
def test_motion_in_one_direction_is_followed_by_reversals_that_tell(recordings, followed, hidden):
    first, proposed, along_it = followed[hidden]
    assert first.next_experiment.tells_apart == ("coulomb_friction", "torque_offset")
    assert first.next_experiment.speed <= 1.01 * np.abs(recordings[hidden]["velocity"]).max()
    assert float(proposed.time[-1]) == pytest.approx(first.next_experiment.duration)
    together = first.next_experiment.repetitions * first.next_experiment.duration
    assert LONG_ENOUGH <= together < LONG_ENOUGH + first.next_experiment.duration
    second = diagnose(along_it, PLAIN.rig)
    names = {"torque_offset" if e.name == "direction_dependent_friction" else e.name for e in second.effects}
    assert names == {effect.name for effect in HIDDEN[hidden]}
    assert second.parameters["coulomb_friction_torque"].value == pytest.approx(PLAIN.axis.coulomb, rel=0.1)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_what_may_be_friction_in_one_direction_acts_against_that(recordings, followed, direction):
    seen = recordings["nothing"]
    turned = seen.with_signals({name: direction * values for name, values in seen.signals.items()}, {})
    model = followed["nothing"][0].model.model
    ((_, (friction, instead), _),) = one_direction(Recordings.of(turned, PLAIN.rig, None), PLAIN.axis.coulomb, model)
    assert friction.parameters.coulomb_friction == PLAIN.axis.coulomb
    assert instead.parameters.coulomb_friction == 0.0
    assert dict(instead.effects[-1].values) == {"torque": direction * PLAIN.axis.coulomb}


def test_what_a_model_misses_is_the_torque_of_the_effect_that_the_other_has(tmp_path, recordings):
    """Whatever a weak drive makes of it: an unbalance over many turns has an RMS of its amplitude over a root of 2."""
    weak = replace(PLAIN.axis, viscous=5e-3, velocity_gain=0.01, integral_gain=0.02)
    write_rig(weak, tmp_path / "rig.toml")
    weakly = Recordings.of(recordings["reversals, nothing"], load_rig(tmp_path / "rig.toml"), None)
    plain = AxisModel(AxisParameters(weak.inertia, weak.viscous, weak.coulomb))
    unbalanced = plain.with_effects([Present.of("unbalance", {"amplitude": 0.05, "phase": 0.3})])
    turning = dict(motions(weakly, plain))["speed_staircase"]
    missed = separation(weakly, (plain, unbalanced), turning, width=2e-3)
    assert missed == pytest.approx(0.05 / np.sqrt(2.0), rel=0.02)


def test_names_that_no_motion_parts_have_no_experiment(recordings):
    found = diagnose(recordings["reversals, an offset"], PLAIN.rig)
    assert found.effects[0].ambiguous_with
    assert found.next_experiment is None


def test_nothing_missing_needs_no_experiment(recordings):
    found = diagnose(recordings["reversals, nothing"], PLAIN.rig)
    assert found.verdict == "nothing_missing"
    assert found.next_experiment is None
