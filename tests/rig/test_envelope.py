"""Limits read from motion: motors whose current and voltage limit them, stepped by explicit Euler of its own."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from bench.cli import app
from bench.errors import UndeterminedError
from bench.rig.envelope import envelope

PERIOD, FINER = 1e-3, 4  # speed and torque of an instant belong together at any step
INERTIA, VISCOUS, COULOMB = 4e-3, 1e-3, 0.05


def driven(targets, gain, peak, slope, no_load):
    """Speed and torque (n, k) of motors under a proportional controller towards target speeds (n, k) - rad/s."""
    rng, speed = np.random.default_rng(0), np.zeros(targets.shape[1])
    speeds, torques = np.empty((2, *targets.shape))
    for k, target in enumerate(targets):
        for _ in range(FINER):
            torque = np.clip(gain * (target - speed), -peak, peak)
            torque = np.clip(torque, -slope * (no_load + speed), slope * (no_load - speed))
            speeds[k], torques[k] = speed, torque
            friction = VISCOUS * speed + COULOMB * np.tanh(speed / 0.05)
            speed = speed + PERIOD / FINER * (torque - friction) / INERTIA
    noisy = (one + size * rng.normal(size=one.shape) for one, size in zip((speeds, torques), (0.2, 0.01), strict=True))
    return SimpleNamespace(**dict(zip(("speed", "torque"), noisy, strict=True)))


RNG = np.random.default_rng(1)
#: 40 motors drawn at random, and three of a peak torque of 2 N*m and a no-load speed of 200 rad/s.
PEAK = np.append(RNG.uniform(2.0, 4.0, 40), [2.0] * 3)
NO_LOAD = np.append(RNG.uniform(120.0, 250.0, 40), [200.0] * 3)
SLOPE = np.append(RNG.uniform(1.5, 3.0, 40), [2.0] * 3) * PEAK / NO_LOAD
GAIN = np.append([0.5] * 40, [0.003, 0.5, 0.5])
#: Of their target speeds, which jump every 0.4 s: the three are weak and slow, slow, and fast.
REACH = np.append(1.2 * NO_LOAD[:40], [60.0, 60.0, 240.0])


@pytest.fixture(scope="module")
def motors():
    targets = np.random.default_rng(0).uniform(-REACH, REACH, (20, REACH.size))
    return driven(np.repeat(targets, 400, axis=0), GAIN, PEAK, SLOPE, NO_LOAD)


def found(speed, torque):
    return envelope(speed, torque, "rad/s", "N*m")


def test_intervals_of_the_limits_hold_the_truth(motors):
    """40 motors: of their intervals 95 % is 152 +- 2.8 of 160."""
    truth = {"peak": PEAK, "no_load": NO_LOAD, "slope": SLOPE, "corner": NO_LOAD - PEAK / SLOPE}
    inside, errors = [], []
    for k in range(40):
        one = found(motors.speed[:, k], motors.torque[:, k])
        for name, values in truth.items():
            if (value := getattr(one, name)) is not None:
                inside.append(value.ci95[0] <= values[k] <= value.ci95[1])
                errors.append(abs(value.value / values[k] - 1.0))
    assert len(inside) >= 152
    assert np.mean(inside) >= 0.91
    assert np.median(errors) < 1e-3


def test_a_limit_that_is_not_reached_is_none(motors):
    weak, slow = (found(motors.speed[:, k], motors.torque[:, k]) for k in (40, 41))
    assert (weak.peak, weak.no_load, weak.slope, weak.corner, weak.stall) == (None,) * 5
    assert weak.largest == pytest.approx(np.abs(motors.torque[:, 40]).max(), abs=0.05)
    assert slow.peak.value == pytest.approx(2.0, rel=2e-3)
    assert slow.no_load is None


@pytest.mark.parametrize("shape", ["sine", "triangle"])
def test_planned_motions_that_repeat_reach_no_limit(shape):
    """Torque that falls towards the same top speed again and again, as acceleration does: bent, not straight."""
    rng, count = np.random.default_rng(3), 333
    half = np.arange(count) / count
    rise = np.sin(np.pi * half) if shape == "sine" else 2.0 * np.minimum(half, 1.0 - half)
    cycle = 470.0 * np.concatenate([rise, np.zeros(100), -rise, np.zeros(60), -rise, np.zeros(100), rise, np.zeros(60)])
    acceleration = np.tile(cycle, 5)
    speed = np.cumsum(acceleration) * PERIOD
    torque = INERTIA * acceleration + VISCOUS * speed + COULOMB * np.sign(speed)
    one = found(*(true + noise * rng.normal(size=speed.size) for true, noise in ((speed, 0.2), (torque, 0.01))))
    assert (one.peak, one.no_load) == (None, None)


def test_what_never_drives_has_no_limits():
    with pytest.raises(UndeterminedError, match="never acts along the motion"):
        found(np.linspace(1.0, 2.0, 500), np.full(500, -1.0))


def test_the_command_tells_the_limits_without_a_datasheet(motors, tmp_path):
    log, told = tmp_path / "log.csv", tmp_path / "limits.json"
    table = np.column_stack([np.arange(8000) * PERIOD, motors.speed[:, 42], motors.torque[:, 42]])
    np.savetxt(log, table, delimiter=",", header="time [s],velocity [rad/s],torque [N*m]", comments="", fmt="%.6g")
    done = CliRunner().invoke(app, ["limits", str(log), "--out", str(tmp_path / "limits.png"), "--json", str(told)])
    assert done.exit_code == 0, done.output
    assert "reaches the limit of current and of voltage" in done.output
    found = json.loads(told.read_text(encoding="utf-8"))["parameters"]
    for name, value, error in (
        ("peak_torque", 2.0, 1e-3),
        ("no_load_speed", 200.0, 2e-3),
        ("corner_speed", 100.0, 5e-3),
    ):
        assert found[name]["value"] == pytest.approx(value, rel=error)
    assert (tmp_path / "limits.png").stat().st_size > 10_000
