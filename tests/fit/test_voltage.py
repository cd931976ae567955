"""Motors that are driven by a voltage: volts or a duty cycle, speed or position, stepped by explicit Euler."""

import numpy as np
import pytest

import bench

RESISTANCE, CONSTANT, INERTIA, VISCOUS, COULOMB = 1.2, 0.05, 2e-4, 1e-4, 8e-3
STEP, EVERY, COUNT, SUPPLY = 1e-4, 20, 100_000, 24.0
MOTOR = {"torque_constant": CONSTANT, "back_emf_constant": CONSTANT, "resistance": RESISTANCE}


@pytest.fixture(scope="module")
def run():
    """Time, voltage that is held for 2 ms, position of 12 bit, speed: (5000,) each."""
    time = STEP * np.arange(COUNT)
    volts = np.zeros(COUNT)
    for amplitude, frequency, phase in ((6.0, 0.7, 0.0), (4.0, 2.3, 1.0), (2.0, 6.1, 0.0)):
        volts += amplitude * np.sin(2.0 * np.pi * frequency * time + phase)
    volts = np.repeat(volts[::EVERY], EVERY)
    position, speed, where = np.empty(COUNT), np.empty(COUNT), 0.0
    now = 0.0
    for k, voltage in enumerate(volts.tolist()):
        position[k], speed[k] = where, now
        torque = CONSTANT * (voltage - CONSTANT * now) / RESISTANCE
        now += STEP * (torque - VISCOUS * now - COULOMB * np.tanh(now / 0.02)) / INERTIA
        where += STEP * now
    bit = 2.0 * np.pi / 4096
    noise = 0.05 * np.random.default_rng(0).normal(size=COUNT)
    return [one[::EVERY] for one in (time, volts, bit * np.round(position / bit), speed + noise)]


def found(columns, units=None, **motor):
    return bench.identify(columns, {"motor": {**MOTOR, **motor}}, units=units)


@pytest.mark.parametrize("signal", ["position", "velocity"])
def test_inertia_and_friction_from_volts_and(run, signal):
    time, volts, position, speed = run
    estimate = found({"time": time, "voltage": volts, signal: position if signal == "position" else speed})
    assert estimate["moment_of_inertia"].value == pytest.approx(INERTIA, rel=1e-3)
    assert estimate["coulomb_friction_torque"].value == pytest.approx(COULOMB, rel=5e-3)
    low, high = estimate["viscous_friction_coefficient"].ci95
    assert low <= VISCOUS <= high


def test_a_duty_cycle_is_a_share_of_the_supply_whose_sag_is_measured(run):
    time, volts, position, _ = run
    sag = SUPPLY - 0.05 * np.abs(volts)
    columns = {"time": time, "duty": volts / sag, "supply_voltage": sag, "position": position}
    estimate = found(columns, {"time": "s", "supply_voltage": "V", "position": "rad"})
    assert estimate["moment_of_inertia"].value == pytest.approx(INERTIA, rel=1e-3)
    constant = found({"time": time, "duty": volts / SUPPLY, "position": position}, supply_voltage=SUPPLY)
    assert constant["moment_of_inertia"].value == pytest.approx(INERTIA, rel=1e-3)


def test_a_duty_cycle_of_an_unknown_supply_is_asked_for(run):
    time, volts, position, _ = run
    with pytest.raises(bench.InputError, match=r"duty cycle; allowed: .*motor.supply_voltage"):
        found({"time": time, "duty": volts / SUPPLY, "position": position})


def test_a_duty_beyond_one_needs_its_unit(run):
    time, volts, position, _ = run
    columns = {"time": time, "duty": 100.0 * volts / SUPPLY, "position": position}
    with pytest.raises(bench.InputError, match=r"voltage left out: .* exceeds 1"):
        found(columns, supply_voltage=SUPPLY)
    known = found(columns, {"time": "s", "duty": "%", "position": "rad"}, supply_voltage=SUPPLY)
    assert known["moment_of_inertia"].value == pytest.approx(INERTIA, rel=1e-3)
