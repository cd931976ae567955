"""Dead time of torque against motion, and of a torque behind its command; the motion is given in closed form."""

import numpy as np
import pytest

import bench
from tests.sines import sines

PERIOD, COUNT, FINER = 2e-3, 10_000, 20
INERTIA, VISCOUS, COULOMB = 0.25, 2.0, 1.5
UNITS = {"time": "s", "position": "rad", "velocity": "rad/s", "torque": "N*m"}


def recorded(delay=0.0, lag=0.0, faster=1.0, noise=0.02):
    """Torque that acts a delay after it is recorded, or behind a first-order lag: M = acting + lag*d(acting)/dt."""
    rng = np.random.default_rng(0)
    time = PERIOD / FINER * np.arange(-2000, COUNT * FINER)
    waves = [(0.9, 0.13), (0.35, 0.5), (0.12, 1.3), (0.04, 2.7), (0.015, 5.0)]
    drawn = [(size / faster, faster * rate, rng.uniform(0.0, 2.0 * np.pi)) for size, rate in waves]
    position, speed, acceleration = sines(time, drawn)
    acting = INERTIA * acceleration + VISCOUS * speed + COULOMB * np.sign(speed)
    torque = np.interp(time + delay, time, acting) + lag * np.gradient(acting, time)
    at = slice(2000, None, FINER)
    return {
        "time": time[at],
        "position": position[at] + 2e-5 * rng.standard_normal(COUNT),
        "velocity": speed[at] + 1e-3 * rng.standard_normal(COUNT),
        "torque": torque[at] + noise * rng.standard_normal(COUNT),
    }


def followed(delay, lag, highest):
    """Command that is held between samples, torque behind it, exact for a command that is held, and what it moves."""
    rng, period, count = np.random.default_rng(1), 1e-3, 8000
    time, step = period * np.arange(count), period / FINER
    omega, phase = 2.0 * np.pi * rng.uniform(1.0, highest, (12, 1)), rng.uniform(0.0, 2.0 * np.pi, (12, 1))
    command = np.sum(np.sin(omega * time + phase), axis=0)
    torque, speed, now, moves = np.empty(count), np.empty(count), command[0], 0.0
    passed, late = np.exp(-step / lag), round(delay / step)
    for k in range(count * FINER):
        if k % FINER == 0:
            torque[k // FINER], speed[k // FINER] = now, moves
        asked = command[max(k - late, 0) // FINER]
        now = asked + (now - asked) * passed
        moves += step * (now - 0.02 * moves - 0.2 * np.tanh(moves / 0.02)) / 0.01
    loud = 0.02 * rng.standard_normal(count), 0.01 * rng.standard_normal(count)
    return {"time": time, "velocity": speed + loud[1], "torque_reference": command, "torque": torque + loud[0]}


@pytest.mark.parametrize("delay", [3e-3, 5e-3, 10e-3, -5e-3])
def test_a_dead_time_is_found_and_undone(delay):
    found = bench.identify(recorded(delay), units=UNITS)
    late = found.dead_time
    assert late.kind == "dead_time" and late.delay.value == pytest.approx(delay, abs=2e-5)
    assert late.delay.ci95[0] <= delay <= late.delay.ci95[1]
    assert found["misalignment"].value == pytest.approx(-delay, abs=5e-5)
    assert found["moment_of_inertia"].value == pytest.approx(INERTIA, rel=1e-3)
    assert any("a dead time of" in warning for warning in found.warnings)


@pytest.mark.parametrize("lag", [3e-3, 5e-3, 9e-3])
def test_a_first_order_lag_is_no_dead_time_and_is_undone(lag):
    """The inertia was 1 to 8 % too large by a shift in the place of a lag."""
    found = bench.identify(recorded(lag=lag), units=UNITS)
    late, inertia = found.dead_time, found["moment_of_inertia"]
    assert late.kind == "first_order_lag" and late.lag.value == pytest.approx(lag, rel=0.03)
    assert found["misalignment"].value == pytest.approx(-lag, rel=0.03)
    assert inertia.ci95[0] <= INERTIA <= inertia.ci95[1] and inertia.value == pytest.approx(INERTIA, rel=5e-3)


def test_slow_motion_does_not_tell_them_apart():
    late = bench.identify(recorded(8e-3, faster=0.3, noise=0.2), units=UNITS).dead_time
    assert late.kind is None and ", or a first-order lag of" in str(late)
    for size in (late.delay, late.lag):
        assert size.ci95[0] <= 8e-3 <= size.ci95[1]


def test_in_step_there_is_none():
    found = bench.identify(recorded(), units=UNITS)
    assert found.dead_time is None and found.command is None


@pytest.mark.parametrize(("delay", "lag"), [(4e-3, 3e-3), (20e-3, 2e-3), (2.3e-3, 1e-3)])
def test_a_torque_behind_its_command_as_an_ethercat_drive_has_it(delay, lag):
    """OpenEtherCATsociety/SOEM#619: some cycles of dead time, then a low-pass; a held command is half a cycle late."""
    units = {"time": "s", "velocity": "rad/s", "torque": "N*m", "torque_reference": "N*m"}
    found = bench.identify(followed(delay, lag, 40.0), units=units)
    assert found.command.dead_time.value == pytest.approx(delay + 0.5e-3, abs=2e-4)
    assert found.command.lag.value == pytest.approx(lag, rel=0.05)
