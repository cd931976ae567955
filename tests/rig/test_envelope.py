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


def steps(reach):
    """Target speeds (8000, k) that jump every 0.4 s, up to a reach (k,) - rad/s."""
    return np.repeat(np.random.default_rng(0).uniform(-reach, reach, (20, reach.size)), 400, axis=0)


@pytest.fixture(scope="module")
def known():
    """Of a peak torque of 2 N*m and a no-load speed of 200 rad/s: weak and slow, slow, and fast."""
    return driven(steps(np.array([60.0, 60.0, 240.0])), np.array([0.003, 0.5, 0.5]), 2.0, 0.02, 200.0)


def found(speed, torque):
    return envelope(speed, torque, "rad/s", "N*m")


def test_intervals_of_the_limits_hold_the_truth():
    """40 motors: of their intervals 95 % is 152 +- 2.8 of 160."""
    rng = np.random.default_rng(1)
    peak, no_load = rng.uniform(2.0, 4.0, 40), rng.uniform(120.0, 250.0, 40)
    slope = rng.uniform(1.5, 3.0, 40) * peak / no_load
    run = driven(steps(1.2 * no_load), 0.5, peak, slope, no_load)
    truth = {"peak": peak, "no_load": no_load, "slope": slope, "corner": no_load - peak / slope}
    inside, errors = [], []
    for k in range(40):
        one = found(run.speed[:, k], run.torque[:, k])
        for name, values in truth.items():
            if (value := getattr(one, name)) is not None:
                inside.append(value.ci95[0] <= values[k] <= value.ci95[1])
                errors.append(abs(value.value / values[k] - 1.0))
    assert len(inside) >= 152
    assert np.mean(inside) >= 0.91
    assert np.median(errors) < 1e-3


def test_a_limit_that_is_not_reached_is_none(known):
    one = found(known.speed[:, 0], known.torque[:, 0])
    assert (one.peak, one.no_load, one.slope, one.corner, one.stall) == (None,) * 5
    assert one.largest == pytest.approx(np.abs(known.torque[:, 0]).max(), abs=0.05)


def test_the_limit_of_current_alone(known):
    one = found(known.speed[:, 1], known.torque[:, 1])
    assert one.peak is not None
    assert one.peak.value == pytest.approx(2.0, rel=2e-3)
    assert one.no_load is None


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
    one = found(
        speed + 0.2 * rng.normal(size=speed.size),
        torque + 0.01 * rng.normal(size=speed.size),
    )
    assert (one.peak, one.no_load) == (None, None)


def test_what_never_drives_has_no_limits():
    with pytest.raises(UndeterminedError, match="never acts along the motion"):
        found(np.linspace(1.0, 2.0, 500), np.full(500, -1.0))


def test_the_command_tells_the_limits_without_a_datasheet(known, tmp_path):
    log, told = tmp_path / "log.csv", tmp_path / "limits.json"
    table = np.column_stack([np.arange(8000) * PERIOD, known.speed[:, 2], known.torque[:, 2]])
    np.savetxt(log, table, delimiter=",", header="time [s],velocity [rad/s],torque [N*m]", comments="", fmt="%.6g")
    done = CliRunner().invoke(app, ["limits", str(log), "--out", str(tmp_path / "limits.png"), "--json", str(told)])
    assert done.exit_code == 0, done.output
    assert "reaches the limit of current and of voltage" in done.output
    found = json.loads(told.read_text(encoding="utf-8"))["parameters"]
    assert found["peak_torque"]["value"] == pytest.approx(2.0, rel=1e-3)
    assert found["no_load_speed"]["value"] == pytest.approx(200.0, rel=2e-3)
    assert found["corner_speed"]["value"] == pytest.approx(100.0, rel=5e-3)
    assert (tmp_path / "limits.png").stat().st_size > 10_000
