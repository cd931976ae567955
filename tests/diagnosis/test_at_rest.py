"""A recording that ends at rest: the part that is held out tells no torque, and says nothing against a name."""

import numpy as np

from bench.diagnosis.diagnosis import diagnose
from bench.trace.trace import Trace
from tests.fit.motions import RIG, UNITS, Truth

COGGING, HARMONIC = 0.03, 6


def stopping(rng, moving=6.0, resting=4.0, period=1e-3):
    """Six pushes in one direction, then rest - closed form, with noise of the sensors."""
    truth, time = Truth(), period * np.arange(round((moving + resting) / period), dtype=np.float64)
    w, pushed = 2.0 * np.pi, time < moving
    speed = np.where(pushed, 30.0 * (1.0 - np.cos(w * time)), 0.0)
    position = np.where(pushed, 30.0 * (time - np.sin(w * time) / w), 30.0 * moving)
    acceleration = np.where(pushed, 30.0 * w * np.sin(w * time), 0.0)
    torque = truth.inertia * acceleration + truth.viscous * speed + truth.coulomb * np.sign(speed)
    torque += np.where(pushed, COGGING * np.sin(HARMONIC * position), 0.0)
    signals = {
        "velocity": speed + 0.03 * rng.standard_normal(time.size),
        "position": position + 1e-5 * rng.standard_normal(time.size),
        "current": (torque + 2e-3 * rng.standard_normal(time.size)) / 0.8,
    }
    return Trace(time, signals, UNITS, "stops")


def test_what_is_held_out_at_rest_judges_no_torque():
    found = diagnose(stopping(np.random.default_rng(0)), RIG)
    assert [effect.name for effect in found.effects] == ["cogging_torque"]
    assert found.effects[0].parameters["harmonic"].value == HARMONIC


def creeping(rng, moving=6.0, resting=4.0, period=1e-3):
    """Motion both ways, then 0.4 rad/s while friction holds a torque that is not its own."""
    truth, time = Truth(), period * np.arange(round((moving + resting) / period), dtype=np.float64)
    moved = time < moving
    speed = np.where(moved, 30.0 * np.sin(2.0 * np.pi * time) + 12.0 * np.sin(6.6 * np.pi * time), 0.0)
    speed += np.where(moved, 0.0, 0.4)
    acceleration = np.gradient(speed, period) * (np.abs(time - moving) > 2.0 * period)
    torque = truth.inertia * acceleration + truth.viscous * speed + truth.coulomb * np.sign(speed)
    torque += np.where(moved, 0.0, 0.05)
    signals = {
        "velocity": speed + 0.03 * rng.standard_normal(time.size),
        "current": (torque + 2e-3 * rng.standard_normal(time.size)) / 0.8,
    }
    return Trace(time, signals, UNITS, "creeps")


def test_where_an_axis_creeps_nothing_speaks_for_an_event():
    trace = creeping(np.random.default_rng(0))
    assert "load_torque_event" not in [effect.name for effect in diagnose(trace, RIG).effects]
