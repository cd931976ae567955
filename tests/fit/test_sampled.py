"""Motors whose voltage is held for a good part of their time constant, stepped by the midpoint rule in fine steps."""

from functools import cache

import numpy as np
import pytest

import bench
from tests.fit.test_motor import MOTOR, Routine, Waves, driven, noisy

CONSTANTS = {"kS": 8e-3 * 1.2 / 0.05, "kV": 0.05 + 1e-4 * 1.2 / 0.05}
RIG = {"motor": {"torque_constant": 0.05, "resistance": 1.2, "back_emf_constant": 0.05}}
SYSID = Routine()
SINES = Waves(0.02, 24.0, (6.0, 0.7), (4.0, 2.3), (3.0, 5.1))


class Steps:
    """Voltages between -10 and 10 V, each for 0.35 s."""

    def __init__(self, period, duration=20.0):
        self.period, self.duration = period, duration
        self.levels = np.random.default_rng(5).uniform(-10.0, 10.0, round(duration / 0.35) + 1)

    def __call__(self, time):
        return self.levels[int(time / 0.35)]


@cache
def run(constant, voltage, late=0):
    """A motor of a time constant - s -, by its inertia; `late`: samples by which its voltage is recorded too early."""
    motor = {**MOTOR, "inertia": constant * 0.05**2 / 1.2}
    columns = dict(driven(voltage, **motor))
    if late:
        columns["voltage"] = np.append(columns["voltage"][late:], [columns["voltage"][-1]] * late)
    return motor["inertia"], columns


def within(found, true, share):
    low, high = found.ci95
    assert low <= true <= high and abs(found.value / true - 1.0) < share, f"{found} is not {true}"


def read_before(columns):
    """The same with the current as it is at the end of each hold, before the voltage changes; the first reads none."""
    before = np.append(0.0, columns["voltage"][:-1])
    return {**columns, "current": (before - 0.05 * columns["velocity"]) / 1.2}


@pytest.mark.parametrize(
    ("constant", "voltage", "late", "source"),
    [
        (0.092, SYSID, 0, "velocity"),
        (0.092, SYSID, 0, "position"),
        (0.046, SYSID, 1, "velocity"),
        (0.092, Steps(0.02), 3, "position"),
        (0.030, Steps(0.01), 0, "velocity"),
        (0.030, Steps(0.005), 1, "position"),
        (0.092, SINES, 0, "velocity"),
    ],
    ids=["SysId", "SysId by angle", "SysId late", "late steps", "steps", "late steps of 5 ms", "sines"],
)
def test_constants_of_few_samples_to_a_time_constant(constant, voltage, late, source):
    """By derivatives kA was 3 to 40 % too large with intervals of 0 to 9 %."""
    inertia, columns = run(constant, voltage, late)
    found = bench.identify(noisy({name: columns[name] for name in ("time", "voltage", source)})).motor
    within(found.parameters["kA"], inertia * 1.2 / 0.05, 0.09 if late else 0.01)
    within(found.parameters["kV"], CONSTANTS["kV"], 0.01)
    assert found.parameters["kS"].value == pytest.approx(CONSTANTS["kS"], rel=0.06)


def test_the_inertia_by_a_voltage_that_is_held():
    inertia, columns = run(0.046, SYSID)
    found = bench.identify(noisy({name: columns[name] for name in ("time", "voltage", "velocity")}), RIG)
    within(found["moment_of_inertia"], inertia, 0.01)
    assert any("time constant has" in line for line in found.warnings)


@pytest.mark.parametrize(("constant", "period"), [(0.025, 0.02), (0.092, 0.02), (0.092, 0.005), (0.025, 0.001)])
def test_an_inertia_by_a_current_read_once_in_each_hold_counts_that(constant, period):
    """The current falls while a voltage is held, by what is induced, and is read at its end."""
    inertia, columns = run(constant, SINES if period == 0.02 else Waves(period, 12.0, *SINES.parts))
    found = bench.identify(noisy(read_before(columns)), RIG)
    low, high = found["moment_of_inertia"].ci95
    assert low <= inertia <= high
    assert any("is read before its voltage changes" in line for line in found.warnings)


def test_samples_too_far_apart_leave_the_other_constants():
    inertia, columns = run(0.012, Waves(0.02, 24.0, (6.0, 0.7), (4.0, 2.3)))
    given = noisy({name: columns[name] for name in ("time", "voltage", "velocity")})
    found = bench.identify(given, RIG)
    assert {*found.motor.parameters} == {"kS", "kV"}
    assert "every 20 ms" in found.motor.refused["kA"] and "at a higher rate" in found.motor.refused["kA"]
    low, high = found["moment_of_inertia"].ci95
    assert low <= inertia <= high


def test_a_voltage_in_steps_is_no_sensor_that_stands_still():
    _, columns = run(0.05, Steps(0.001, 6.0))
    given = {name: columns[name] for name in ("time", "voltage", "velocity")}
    assert bench.identify(noisy(given))["moment_of_inertia"].value > 0.0


@pytest.mark.parametrize("constant", [0.092, 0.025])
def test_a_hold_of_the_voltage_is_no_missing_effect(constant):
    """A torsion spring was named beside the current, by what the motor does while a voltage is held."""
    _, columns = run(constant, SINES)
    given = noisy({name: read_before(columns)[name] for name in ("time", "voltage", "velocity", "current")})
    with pytest.raises(bench.UndeterminedError, match=r"is held for the 20 ms between samples.*(rate|or more)"):
        bench.diagnose(given, RIG)


def test_a_motor_with_many_samples_is_diagnosed():
    _, columns = run(0.092, Waves(0.001, 12.0, *SINES.parts))
    found = bench.diagnose(noisy({name: columns[name] for name in ("time", "voltage", "current", "velocity")}), RIG)
    assert not found.names


@pytest.mark.parametrize("held", [True, False])
def test_a_drive_that_controls_its_current_is_as_ever(held):
    """Its voltage rises while a current is held: nothing between the samples is unknown."""
    inertia, rng, fine, every = 5.4e-5, np.random.default_rng(1), 1e-4, 100
    time = fine * np.arange(100_000)
    waves = ((60.0, 0.5, 0.0), (30.0, 1.3, 1.0), (10.0, 3.1, 2.0))
    asked = sum(size * np.sin(2.0 * np.pi * hertz * time + phase) for size, hertz, phase in waves)
    wanted, kept = np.gradient(asked, fine), np.empty((2, time.size))
    speed = current = 0.0
    for k in range(time.size):
        if k % every == 0 or not held:
            behind = (0.1 if held else 0.5) * inertia / 1e-2 * (asked[k] - speed)
            current = (inertia * wanted[k] + 1e-4 * asked[k] + 8e-3 * np.tanh(asked[k] / 0.5) + behind) / 0.05
        kept[:, k] = speed, current
        speed += fine * (0.05 * current - 1e-4 * speed - 8e-3 * np.tanh(speed / 0.02)) / inertia
    speeds, currents = kept[:, ::every]
    loud = rng.standard_normal((3, speeds.size)) * np.array([[0.05], [0.005], [0.02]])
    given = {"time": time[::every], "velocity": speeds + loud[0], "current": currents + loud[1]}
    given["voltage"] = 1.2 * currents + 0.05 * speeds + loud[2]
    found = bench.identify(given, RIG)
    within(found["moment_of_inertia"], inertia, 0.01)
    assert found["moment_of_inertia"].half_width < 0.02 * inertia
    assert bench.diagnose(given, RIG).verdict == "nothing_missing"
