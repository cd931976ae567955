"""Backlash: two free bodies in the gap, one axis when engaged, an elastic blow when the contact does not damp."""

import numpy as np
import pytest

from bench.validation.independent.effects import Backlash
from bench.validation.independent.plant import Plant
from tests.independent.axes import FREE, PLAIN, run

ROTOR, LOAD = FREE.rotor_inertia, FREE.inertia - FREE.rotor_inertia


def test_in_the_gap_the_motor_moves_alone():
    states = run(Plant([FREE], [[Backlash(0.1, 500.0, 0.05)]]), 0.1, 0.03)
    free = states["position"][:, 0] < 0.05
    assert (states["load_velocity"][free] == 0.0).all()
    exact = 0.1 * FREE.torque_constant / ROTOR * states["time"][free]
    assert np.abs(states["velocity"][free, 0] - exact).max() < 1e-9
    assert 0.0 < free.mean() < 1.0


def test_engaged_both_move_as_one():
    states = run(Plant([PLAIN], [[Backlash(0.02, 2000.0, 1.0)]]), 0.5, 0.2)
    late = states["time"] > 0.15
    torque = 0.5 * PLAIN.torque_constant - PLAIN.coulomb
    acceleration = (torque - PLAIN.viscous * states["velocity"][late, 0]) / PLAIN.inertia
    seen = np.gradient(states["velocity"][late, 0], states["time"][late])
    assert np.abs(seen / acceleration - 1.0).max() < 0.02
    twist = states["position"] - states["load_position"]
    assert twist[-1, 0] == pytest.approx(0.01 + LOAD * acceleration[-1] / 2000.0, rel=1e-3)


def test_an_undamped_blow_turns_the_relative_speed():
    plant = Plant([FREE], [[Backlash(0.02, 3000.0, 0.0)]])
    plant.velocity[:] = 4.0
    states = run(plant, 0.0, 0.006, 4e-6)
    relative = (states["velocity"] - states["load_velocity"])[:, 0]
    assert relative[0] == 4.0
    assert relative[-1] == pytest.approx(-4.0, rel=1e-3)
    assert states["velocity"][-1, 0] == pytest.approx(4.0 * (ROTOR - LOAD) / FREE.inertia, abs=4e-3)


def test_first_engagement_converges(capsys):
    def end(step):
        plant = Plant([FREE], [[Backlash(0.02, 300.0, 0.05)]])
        return run(plant, 0.5, 0.0128, step)["velocity"][-1, 0]

    exact = end(1e-6)
    errors = [abs(end(step) - exact) for step in (40e-6, 20e-6, 10e-6)]
    with capsys.disabled():
        print(f"\nbacklash, one engagement: errors at 40, 20, 10 us {errors} rad/s")
    assert errors[1] < 5e-3
    assert errors[2] < errors[0]
