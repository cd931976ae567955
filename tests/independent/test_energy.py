"""Energy: conserved where nothing dissipates, balanced where friction does, never gained from a passive effect."""

from dataclasses import replace

import numpy as np
import pytest

from bench.validation.independent.effects import (
    Backlash,
    DirectionDependentFriction,
    ElasticCoupling,
    FrictionWarmup,
    PositionDependentFriction,
    PositionDependentInertia,
    PreslidingFriction,
    QuadraticDrag,
    StribeckFriction,
    TorsionSpring,
    Unbalance,
)
from bench.validation.independent.plant import Plant
from tests.independent.axes import FREE, PLAIN, run
from tests.outside import RestHardening, SlowMemoryFriction


def test_a_spring_swings_for_ever_at_its_frequency():
    stiffness = 30.0
    states = run(Plant([FREE], [[TorsionSpring(stiffness)]], velocity=5.0), 0.0, 0.3)
    omega = np.sqrt(stiffness / FREE.inertia)
    energy = FREE.inertia * states["velocity"] ** 2 / 2 + stiffness * states["position"] ** 2 / 2
    assert np.ptp(energy) < 1e-5 * energy[0]
    assert np.abs(states["velocity"][:, 0] - 5.0 * np.cos(omega * states["time"])).max() < 2e-3


def test_varying_inertia_conserves_kinetic_energy():
    effect = PositionDependentInertia(0.2, 3.0, 0.4)
    states = run(Plant([FREE], [[effect]], velocity=60.0), 0.0, 0.12)
    inertia = FREE.inertia * (1.0 + 0.2 * np.sin(3.0 * states["position"] + 0.4))
    energy = inertia * states["velocity"] ** 2 / 2
    assert np.ptp(energy) < 2e-4 * energy.mean()


def test_work_of_the_motor_is_kinetic_energy_and_heat():
    states = run(Plant([PLAIN], [[]]), lambda t: 0.5 * np.sin(40.0 * t), 0.3)
    w = np.concatenate([[0.0], states["velocity"][:, 0]])
    middle = (w[1:] + w[:-1]) / 2
    work = np.cumsum(states["motor_torque"][:, 0] * middle) * 20e-6
    # w**2 integrates over a step as for a straight line
    heat = np.cumsum(PLAIN.coulomb * np.abs(middle) + PLAIN.viscous * (w[1:] ** 2 + w[1:] * w[:-1] + w[:-1] ** 2) / 3)
    kinetic = PLAIN.inertia * w[1:] ** 2 / 2
    assert np.abs(work - heat * 20e-6 - kinetic).max() < 1e-5 * work.max()


PASSIVE = [
    StribeckFriction(0.2, 3.0),
    PreslidingFriction(5.0, 0.002),
    DirectionDependentFriction(0.04, 0.5),
    QuadraticDrag(1e-5),
    PositionDependentFriction(0.8, 0.3),
    FrictionWarmup(1.0, 0.1, 1.0),
    SlowMemoryFriction(1.0, 0.1, 30.0),
    RestHardening(1.0, 0.1, 3.0),
]


@pytest.mark.parametrize("start", [20.0, -20.0])
def test_friction_only_dissipates_and_ends_in_rest(start):
    states = run(Plant([PLAIN] * len(PASSIVE), [[effect] for effect in PASSIVE], velocity=start), 0.0, 0.7, 140e-6)
    for effect, speed in zip(PASSIVE, np.abs(states["velocity"]).T, strict=True):
        if effect.name == "presliding_friction":  # bristles give back what they stored
            stored = PLAIN.coulomb**2 / (2 * effect.bristle_stiffness)
            assert PLAIN.inertia * speed[-1] ** 2 / 2 <= stored
        else:
            assert (np.diff(speed) <= 0.0).all(), effect.name
            assert speed[-1] == 0.0, effect.name


@pytest.mark.parametrize("coupling", [ElasticCoupling(40.0, 0.01), Backlash(0.05, 200.0, 0.05)])
def test_a_coupling_with_damping_only_dissipates(coupling):
    plant = Plant([FREE], [[coupling]], velocity=10.0)
    plant.load_velocity[:] = -5.0
    states = run(plant, 0.0, 0.15)
    rotor, load = FREE.rotor_inertia, FREE.inertia - FREE.rotor_inertia
    momentum = rotor * states["velocity"] + load * states["load_velocity"]
    assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.abs(rotor * 10.0)
    kinetic = (rotor * states["velocity"] ** 2 + load * states["load_velocity"] ** 2) / 2
    common = momentum[0] ** 2 / (2 * FREE.inertia)
    # in free flight and at extreme twist nothing is stored beyond the start's energy
    assert (kinetic <= kinetic[0] * (1 + 1e-6)).all()
    assert kinetic[-1] < common * 1.2 + 0.2 * kinetic[0]


def test_gravity_conserves_energy_of_a_pendulum():
    axis = replace(FREE, inertia=2e-3)
    states = run(Plant([axis], [[Unbalance(0.3)]], velocity=12.0), 0.0, 0.25)
    energy = axis.inertia * states["velocity"] ** 2 / 2 + 0.3 * (1 - np.cos(states["position"]))
    assert np.ptp(energy) < 1e-6 * energy[0]
