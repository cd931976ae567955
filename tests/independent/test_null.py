"""An effect at its null value is exactly absent, bit for bit."""

import numpy as np

from bench.validation.independent.effects import (
    KINDS,
    CoggingTorque,
    CurrentFilterLag,
    CurrentGainAsymmetry,
    CurrentLoopLag,
    CurrentOffsetDrift,
    DirectionalLoadFriction,
    DirectionDependentFriction,
    EncoderEccentricity,
    FrictionWarmup,
    LoadDependentFriction,
    LoadTorqueEvent,
    PositionDependentFriction,
    PositionDependentInertia,
    QuadraticDrag,
    StribeckFriction,
    TorqueConstantDrift,
    TorqueConstantSaturation,
    TorqueOffset,
    TorqueRipple,
    TorsionSpring,
    Unbalance,
    VelocityFilterLag,
    VoltageLimit,
)
from bench.validation.independent.plant import Plant
from tests.independent.axes import FREE, PLAIN, run
from tests.outside import OUTSIDE, PositionNotch, RestHardening, SlowMemoryFriction, Vibration

NULL = [
    StribeckFriction(PLAIN.coulomb, 1.0),
    DirectionDependentFriction(0.0, 1.0),
    QuadraticDrag(0.0),
    LoadDependentFriction(0.0),
    PositionDependentFriction(0.0, 1.0),
    FrictionWarmup(0.0, 1.0, 1.0),
    TorqueOffset(0.0),
    Unbalance(0.0, 1.0),
    TorsionSpring(0.0),
    PositionDependentInertia(0.0, 2.0, 1.0),
    LoadTorqueEvent(0.01, 0.02, 0.0),
    CoggingTorque(0.0, 6.0, 1.0),
    TorqueRipple(0.0, 6.0, 1.0),
    TorqueConstantSaturation(0.0),
    VoltageLimit(1e6),
    CurrentLoopLag(1e-12),
    VelocityFilterLag(1e-12),
    EncoderEccentricity(0.0, 1.0),
    CurrentFilterLag(1e-12),
    CurrentGainAsymmetry(0.0),
    CurrentOffsetDrift(0.0),
    TorqueConstantDrift(0.0),
    DirectionalLoadFriction(0.0, 2.0),
    SlowMemoryFriction(0.0, 1.0, 1.0),
    PositionNotch(0.0, 1.0, 0.1),
    Vibration(0.0, 20.0, 1.0),
    RestHardening(0.0, 1.0, 1.0),
]
#: These have no null value but a limit: rigid bristles, a rigid coupling.
LIMITS = {"presliding_friction", "elastic_coupling", "backlash"}


def test_every_effect_is_listed_here():
    assert {effect.name for effect in NULL} | LIMITS == {*KINDS, *OUTSIDE}


def test_null_is_the_bare_axis():
    def push(time):
        return 0.8 if time < 0.02 else -0.5

    states = run(Plant([PLAIN] * (len(NULL) + 1), [[], *([effect] for effect in NULL)]), push, 0.06)
    for k, effect in enumerate(NULL, start=1):
        # a voltage limit far away drives the current by its inductance, which rounds and acts half a step later; a
        # filter of 1e-12 s rounds
        allowed = {"voltage_limit": 1e-2, "velocity_filter_lag": 1e-9}.get(effect.name, 0.0)
        for name in ("position", "velocity", "measured_position", "measured_velocity", "current"):
            assert np.abs(states[name][:, k] - states[name][:, 0]).max() <= allowed, (effect.name, name)


def _push(time):
    return 6.0 * np.sin(120.0 * time)


def test_effects_act_alike_alone_and_among_neighbours_whom_they_leave_alone():
    strong = [kind.draw(PLAIN, 0.6, np.random.default_rng(4), 0.03) for kind in (KINDS | OUTSIDE).values()]
    bare = run(Plant([PLAIN], [[]]), _push, 0.03)
    side_by_side = [effects for effect in strong for effects in ([], [effect])]
    both = run(Plant([PLAIN] * len(side_by_side), side_by_side), _push, 0.03)
    for k, effect in enumerate(strong):
        plant = Plant([PLAIN], [[effect]])
        alone = run(plant, _push, 0.03)
        for name in ("position", "velocity", "measured_velocity"):
            assert (both[name][:, 2 * k] == bare[name][:, 0]).all(), effect.name
            # vectorised sine and exponential may round differently
            away = np.abs(both[name][:, 2 * k + 1] - alone[name][:, 0]).max()
            assert away < 1e-9 * (1.0 + np.abs(alone[name]).max()), effect.name
        heard = [np.abs(alone[name] - bare[name]).max() for name in ("velocity", "measured_velocity")]
        heard.append(np.abs(plant.recorded_current - alone["current"][-1]).max())
        assert max(heard) > 1e-6, effect.name


def test_a_derived_effect_acts_as_the_one_it_is_derived_from():
    class Rubber(TorsionSpring):
        name = "rubber"

    states = [run(Plant([FREE], [[kind(30.0)]], velocity=5.0), 0.0, 0.05) for kind in (TorsionSpring, Rubber)]
    np.testing.assert_array_equal(states[0]["velocity"], states[1]["velocity"])
    assert states[0]["velocity"][-1, 0] < 4.99
