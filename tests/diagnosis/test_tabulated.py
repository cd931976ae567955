"""What has no name becomes a table where held-out motion confirms it, and nowhere else.

The recordings are closed forms: a prescribed motion, and the torque that the equation of motion takes for it.
"""

from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.diagnosis.model import Extension, HeldOut
from bench.diagnosis.recordings import Recordings
from bench.diagnosis.tabulated import choices, tabulated, unknown_effect
from bench.effects.tabulated import NAMES, NODES
from bench.fit.hypothesis import Hypothesis
from bench.plant.model_file import load_model
from bench.report.diagnosis import diagnosis
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from tests.shared import SHARED, needs_shared
from tests.sines import sines

INERTIA, VISCOUS, COULOMB, PERIOD, NOISE = 2e-3, 1e-3, 0.05, 1e-3, 2e-3
RIG = Rig.of({"name": "axis", "kind": "rotary"})


def bump(position):
    """Of no effect of the catalogue: a torque at one angle of the turn."""
    return 0.06 * np.exp(-(((np.mod(position, 2.0 * np.pi) - 2.5) / 0.5) ** 2))


def stiff_speed(velocity):
    """Friction that rises steeply above 6 rad/s."""
    return 0.04 * np.sign(velocity) / (1.0 + np.exp(-(np.abs(velocity) - 6.0) / 0.4))


def recorded(extra, duration=20.0, seed=0):
    """A recording of the axis with an `extra` torque, of time, position and speed."""
    rng, time = np.random.default_rng(seed), PERIOD * np.arange(round(duration / PERIOD))
    position, velocity, acceleration = sines(time, [(2.2, 0.31, 0.3), (1.1, 0.83, 1.1), (0.35, 1.9, 2.0)])
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity) + extra(time, position, velocity)
    signals = {
        "time [s]": time,
        "position [rad]": position,
        "velocity [rad/s]": velocity + rng.normal(scale=1e-3, size=time.size),
        "torque [N*m]": torque + rng.normal(scale=NOISE, size=time.size),
    }
    return Trace.from_arrays(signals)


def held_out(extra, duration=20.0, seed=0):
    """An extension without effects of a recording, and its held-out motion."""
    recordings = Recordings.of([recorded(extra, duration, seed)], RIG, None)
    extension = Extension(recordings.rows, Hypothesis(()), {}, RIG)
    return extension, HeldOut.of(recordings, True, True, extension.fitted)


def values_of(tables, name):
    (found,) = (dict(one.values) for one in tables if one.name == name)
    return np.linspace(found["low"], found["high"], NODES), np.array([found[node] for node in NAMES])


def test_a_torque_over_position_is_recovered():
    found = unknown_effect(*held_out(lambda _, position, __: bump(position)))
    assert found is not None
    assert found.over[0] == "position"
    x, torque = values_of(found.tables, "unknown_torque_over_position")
    expected = bump(x)
    # a constant is friction's or the table's: what differs is the shape
    np.testing.assert_allclose(torque - torque.mean(), expected - expected.mean(), atol=0.05 * bump(2.5))
    assert found.share > 0.9
    assert found.velocity[1] < 0.5 * found.velocity[0]


def test_friction_over_speed_is_recovered():
    found = unknown_effect(*held_out(lambda _, __, velocity: stiff_speed(velocity)))
    assert found is not None
    assert found.over == ("speed",)
    x, torque = values_of(found.tables, "unknown_friction_over_speed")
    base = held_out(lambda _, __, velocity: stiff_speed(velocity))[0].fitted.base
    total = base.coulomb + base.viscous * x + torque
    moving = (x > 1.0) & (x < 0.95 * x[-1])
    expected = COULOMB + VISCOUS * x + stiff_speed(x)
    np.testing.assert_allclose(total[moving], expected[moving], atol=0.003)


@pytest.mark.parametrize("seed", range(3))
def test_noise_alone_is_no_table(seed):
    extension, held = held_out(lambda time, _, __: np.zeros_like(time), seed=seed)
    assert extension.fitted.chi < 1.12  # so that it is not even asked
    assert unknown_effect(extension, held) is None


def test_a_residual_of_time_alone_is_no_table():
    extension, held = held_out(lambda time, _, __: 0.03 * np.sin(2.0 * np.pi * 7.3 * time))
    assert extension.fitted.chi > 3.0
    assert unknown_effect(extension, held) is None


def test_tables_are_ranked_by_blocks_that_they_were_not_fitted_to():
    extension, _ = held_out(lambda _, position, __: bump(position))
    ranked = tabulated(extension.fitted, choices(extension.fitted))
    assert ranked[0][0].name == "unknown_torque_over_position"


def synthetic():
    """The axis with the bump, twice, and its rig."""
    one, other = (recorded(lambda _, position, __: bump(position), 5.0, seed) for seed in range(2))
    return one, RIG, other


def real():
    """A joint of a robot, twice, and its rig."""
    return tuple(SHARED / "data/real/damiao_m1" / name for name in ("r1.csv.gz", "rig.toml", "r2.csv.gz"))


@pytest.mark.parametrize("axis", [synthetic, pytest.param(real, marks=[pytest.mark.slow, needs_shared])])
def test_an_axis_moves_by_its_table_and_keeps_its_verdict(tmp_path, axis):
    recording, rig, holdout = axis()
    found = bench.diagnose(recording, rig, holdout)
    assert found.verdict == "unexplained_remainder"
    assert found.unknown_effect is not None
    assert found.unknown_effect.torque[1] < found.unknown_effect.torque[0]
    assert found.unknown_effect.velocity[1] < found.unknown_effect.velocity[0]
    assert {effect.name for effect in found}.isdisjoint(one.name for one in found.unknown_effect.tables)
    assert "tabulated over position" in diagnosis(found, "axis").answers["What was missing?"]
    assert found.model is not None
    found.save(tmp_path)
    assert load_model(tmp_path / "model.toml") == found.model
    assert bench.Diagnosis.load(tmp_path).unknown_effect == found.unknown_effect
    plain = [one for one in found.model.model.effects if one not in found.unknown_effect.tables]
    without = replace(found, model=replace(found.model, model=found.model.model.with_effects(plain)))
    gaps = []
    for model in (without, tmp_path):
        replayed = bench.replay(model, holdout, rig)
        gaps.append(np.sqrt(np.nanmean((replayed.torque - replayed.torque_simulated) ** 2)))
    assert gaps[1] < 0.9 * gaps[0]
