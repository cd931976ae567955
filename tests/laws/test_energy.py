"""Energy of the simulated axis under axes, drives and frictions that are drawn: it closes, and friction only takes."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.present import Present
from bench.effects.torque import Friction
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.plant.run import run
from tests.effects.axes import VALUES, WINDING, Reversals

PERIOD = 125e-6
MOTION = Reversals(0.4).references(PERIOD)
#: Frictions of the catalogue that give nothing back; bristles return what they stored and have a test of their own.
TAKING = [name for name, effect in catalogue().items() if isinstance(effect, Friction)]


def drawn(seed, effects=()):
    """A random axis under a random drive that follows the motion, in torque without limit."""
    rng = np.random.default_rng(seed)
    inertia, viscous, coulomb = 10.0 ** rng.uniform((-3.3, -3.5, -1.6), (-2.3, -2.5, -0.8))
    gain = inertia * rng.uniform(50.0, 200.0)
    cascade = Cascade(rng.uniform(5.0, 40.0), gain, gain * rng.uniform(5.0, 20.0), inertia, 1e3, PERIOD)
    axis = AxisParameters(inertia, viscous, coulomb, motor_inertia=inertia * rng.uniform(0.1, 0.5))
    return Plant(AxisModel(axis, tuple(effects), winding=WINDING), cascade, PERIOD)


def disturbed(name, seed):
    """The effect with values of half to all of those that suit an axis."""
    rng = np.random.default_rng(seed)
    return Present.of(name, {key: value * rng.uniform(0.5, 1.0) for key, value in VALUES[name].items()})


def taken(states, inertia):
    """Energy that left the motion by each step's end - J (ticks - 1,): the motor's work less kinetic energy."""
    middle = (states.velocity[1:] + states.velocity[:-1]) / 2.0
    work = np.cumsum(states.torque[:-1] * middle, axis=0) * PERIOD
    return work - inertia * (states.velocity[1:] ** 2 - states.velocity[0] ** 2) / 2.0, work


@pytest.mark.parametrize("seed", range(6))
def test_the_motors_work_is_kinetic_energy_and_heat(seed):
    plant = drawn(seed)
    axis, states = plant.axis.parameters, run(plant, MOTION)
    left, work = taken(states, axis.inertia)
    middle = (states.velocity[1:] + states.velocity[:-1]) / 2.0
    heat = axis.viscous_friction_coefficient * middle**2 + axis.coulomb_friction * np.abs(middle)
    off = np.abs(left - np.cumsum(heat, axis=0) * PERIOD).max() / np.abs(work).max()
    print(f"\nenergy closes to {off:.1e} of the work; heat {left[-1]:.3g} J")
    assert off < 1e-6
    assert np.abs(states.velocity).max() > 10.0


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", TAKING)
def test_friction_only_takes(name, seed):
    """Under the drive too, which moves the axis and brakes it: at no step has the axis more than the motor gave."""
    plant = drawn(seed, [disturbed(name, seed)])
    inertia, without = plant.axis.parameters.inertia, replace(plant, axis=plant.axis.with_effects([]))
    states = run(plant, MOTION)
    left, less = (taken(each, inertia)[0] for each in (states, run(without, MOTION)))
    print(f"\n{name}: takes {left[-1]} J, {less[-1]} J without it")
    one_way = np.sign(states.velocity[1:-1]) == np.sign(states.velocity[2:])
    gained = -np.diff(left, axis=0) / left[-1]
    assert gained[one_way].max() < 1e-12
    # where it turns within a step, the middle of its ends is not its speed
    assert gained.max() < 1e-5
    assert abs(left[-1] / less[-1] - 1.0) > 1e-4
