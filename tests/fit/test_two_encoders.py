"""Coupling from a motor's and a load's encoder, of two masses that are integrated by small steps of their own."""

import math
from functools import cache

import numpy as np
import pytest

import bench

PERIOD, COUNT, STEP = 1e-3, 8000, 2e-5
ROTOR, LOAD, RATIO = 1e-4, 0.04, 20.0
STIFFNESS, DAMPING = 300.0, 0.6
UNITS = {"time": "s", "position": "rad", "velocity": "rad/s", "torque": "N*m", "load_position": "rad"}
RIG = {"motor": {"rotor_inertia": ROTOR}, "load": {"gear_ratio": RATIO}}


@cache
def recorded(gap=0.0, error=0.0, size=1.0):
    """Motor behind a gear, a spring with play and a load; encoders of 16 bit on the motor and 20 bit on the load."""
    rng, waves = np.random.default_rng(0), [(0.35, 0.9), (0.25, 2.7), (0.2, 6.1), (0.15, 13.0)]
    motor = load = speed = turning = 0.0
    found = np.empty((COUNT, 4))
    for k in range(COUNT):
        torque = size * sum(a * math.sin(2.0 * math.pi * f * k * PERIOD + n) for n, (a, f) in enumerate(waves))
        found[k] = motor, speed, load, torque
        for _ in range(round(PERIOD / STEP)):
            twist = motor / RATIO - load - error * math.sin(load)
            rate = speed / RATIO - turning
            beyond = twist - min(max(twist, -0.5 * gap), 0.5 * gap)
            push = STIFFNESS * beyond + (DAMPING * rate if beyond or not gap else 0.0)
            speed += STEP * (torque - push / RATIO - 2e-4 * speed - 0.01 * math.tanh(speed / 0.05)) / ROTOR
            turning += STEP * (push - 0.05 * turning - 0.1 * math.tanh(turning / 0.002)) / LOAD
            motor, load = motor + STEP * speed, load + STEP * turning
    motor, speed, load, torque = found.T
    fine, finer = 2.0 * math.pi / 2**16, 2.0 * math.pi / 2**20
    return {
        "time": PERIOD * np.arange(COUNT),
        "position": fine * np.round(motor / fine),
        "velocity": speed + 0.05 * rng.standard_normal(COUNT),
        "load_position": finer * np.round(load / finer),
        "torque": torque + 2e-3 * rng.standard_normal(COUNT),
    }


@pytest.mark.parametrize(
    ("has", "name", "share"),
    [
        ({}, "damping", 0.2),
        ({"gap": 4e-3}, "backlash_gap", 0.05),
        ({"error": 1e-3}, "transmission_error_per_load_turn", 0.05),
    ],
    ids=["a spring", "backlash", "a transmission error"],
)
def test_a_coupling_has_its_stiffness_and_what_else_it_has(has, name, share):
    found = bench.identify(recorded(**has), RIG, units=UNITS).coupling
    assert found["stiffness"].value == pytest.approx(STIFFNESS, rel=0.02)
    assert found[name].value == pytest.approx(next(iter(has.values()), DAMPING), rel=share)
    assert has or "backlash_gap" not in found


def test_without_a_torque_it_says_what_is_missing():
    columns = dict(recorded())
    columns["current"] = columns.pop("torque") / 0.1
    units = {name: unit for name, unit in UNITS.items() if name != "torque"} | {"current": "A"}
    found = bench.identify(columns, RIG, units=units)
    assert not found.coupling and any("motor.torque_constant in the rig" in each for each in found.warnings)
