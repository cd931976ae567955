"""Each effect on an axis under a constant torque, against the closed form of its motion; what holds at rest."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from bench.axis_kind import LINEAR
from bench.effects.elastic_coupling import _driven
from bench.errors import InputError
from bench.plant.axis_model import AxisParameters
from tests.effects.axes import AXIS, FREE, PERIOD, VALUES, WINDING, Present, moved, present

J, MOTOR, LOAD = FREE.inertia, AXIS.rotor_inertia, AXIS.inertia - AXIS.rotor_inertia
DRY, VISCOUS = replace(FREE, coulomb_friction=0.06), replace(FREE, viscous_friction_coefficient=2e-3)
SLIDE = AxisParameters(3.0, motor_inertia=1.0, kind=LINEAR)
#: Of the axis with each stiffness of its coupling - rad/s.
RESONANCE, OF_SLIDE = np.sqrt(40.0 * (1.0 / MOTOR + 1.0 / LOAD)), np.sqrt(1e4 * (1.0 / 1.0 + 1.0 / 2.0))
PITCH = 2.0 * np.pi / 0.03
SWING = np.sqrt(0.02 / J)


def of(name, **values):
    """The effect with these values alone."""
    return Present.of(name, values)


WARM = {"relative_amplitude": 1.5, "time_constant": 0.3}
BY_DIRECTION = of("direction_dependent_friction", coulomb_difference=0.05)
STEPPED = of("load_dependent_friction", load_friction_coefficient=1e-12)  # next to nothing, in every step
ASYMMETRY, DRIFT, RATE = (
    next(iter(VALUES[name].values()))
    for name in ("current_gain_asymmetry", "current_offset_drift", "torque_constant_drift")
)
MOTORS, RATIO = VALUES["directional_load_friction"].values()


def spring(reference):
    """Position on the spring: a sine from its rest position, and a cosine of the distance from elsewhere."""
    law = lambda t: reference + 10.0 / SWING * np.sin(SWING * t) - reference * np.cos(SWING * t)  # noqa: E731
    return [present("torsion_spring", reference=reference)], {"velocity": 10.0}, 2.0, law, 1e-4


#: Effects, start and torque, duration - s -, the closed form over time, and how near it - rad or rad/s.
POSITIONS = {
    "spring": spring(0.0),
    "spring with a reference": spring(0.3),
    "unbalance about its lowest": (
        [present("unbalance")], {"position": 0.51}, 1.0, lambda t: 0.5 + 0.01 * np.cos(np.sqrt(0.2 / J) * t), 1e-5,
    ),
}  # fmt: skip
SPEEDS = {
    "offset": ([present("torque_offset")], {}, 0.2, lambda t: 0.12 * t / J, 1e-9),
    "offset drift": ([present("current_offset_drift")], {}, 0.4, lambda t: -0.5 * DRIFT * t**2 / J, 1e-4),
    # drag acts with the speed at the start of the step: half a step of its own decay early
    "drag": (
        [present("quadratic_drag")], {"velocity": 150.0}, 2.0, lambda t: 150.0 / (1.0 + 1.5e-5 * 150.0 * t / J), 0.02,
    ),
    "constant drift": (
        [present("torque_constant_drift")], {"torque": 0.5}, 0.4, lambda t: 0.5 / J * (t + 0.5 * RATE * t**2), 1e-3,
    ),
    "event": (
        [of("load_torque_event", torque=0.2, start=0.05, end=0.1)], {}, 0.2,
        lambda t: -0.2 / J * np.clip(t - 0.05, 0.0, 0.05), 1e-6,
    ),
    "friction by load": (
        [present("load_dependent_friction")], {"torque": 1.0, "parameters": DRY}, 0.1,
        lambda t: (1.0 - 0.06 - 0.12) * t / J, 1e-6,
    ),
    "friction by motor and no load": (
        [present("directional_load_friction")], {"torque": 1.0, "parameters": DRY}, 0.1,
        lambda t: (1.0 - 0.06 - MOTORS) * t / J, 1e-6,
    ),
    "warm dry friction": (
        [of("friction_warmup", **WARM)], {"velocity": 60.0, "parameters": DRY}, 0.5,
        lambda t: 60.0 - 0.06 / J * (t + 1.5 * 0.3 * (1.0 - np.exp(-t / 0.3))), 1e-5,
    ),
    "warm viscous friction": (
        [of("friction_warmup", **WARM, viscous_share=0.5)], {"velocity": 60.0, "parameters": VISCOUS}, 0.5,
        lambda t: 60.0 * np.exp(-2e-3 / J * (t + 0.5 * 1.5 * 0.3 * (1.0 - np.exp(-t / 0.3)))), 5e-4,
    ),
    "viscous difference": (
        [of("direction_dependent_friction", coulomb_difference=0.0, viscous_difference=2e-3)], {"velocity": 30.0}, 1.0,
        lambda t: 30.0 * np.exp(-1e-3 * t / J), 1e-5,
    ),
    "a level below zero is none": (
        [of("direction_dependent_friction", coulomb_difference=0.2)], {"velocity": -30.0, "parameters": DRY}, 0.1,
        lambda t: -30.0 + 0.0 * t, 1e-9,
    ),
    "torque lag": (
        [present("current_loop_lag")], {"torque": 0.5}, 0.05,
        lambda t: 0.5 / J * (t - 2e-3 * (1.0 - np.exp(-t / 2e-3))), 4e-3,
    ),
    "no current, no ripple": ([present("torque_ripple")], {"velocity": 20.0}, 0.3, lambda t: 20.0 + 0.0 * t, 1e-9),
    "coupling": (
        [of("elastic_coupling", stiffness=40.0)], {"torque": 0.5}, 0.2,
        lambda t: 0.5 * t / J + LOAD / J * 0.5 / (MOTOR * RESONANCE) * np.sin(RESONANCE * t), 0.02,
    ),
    "coupling of a linear axis": (
        [of("elastic_coupling", stiffness=1e4)], {"torque": 2.0, "parameters": SLIDE}, 0.5,
        lambda t: 2.0 * t / 3.0 + 2.0 / 3.0 * 2.0 / OF_SLIDE * np.sin(OF_SLIDE * t), 1e-3,
    ),
    **{f"saturation at {torque} N*m": (
        [present("torque_constant_saturation")], {"torque": torque}, 0.05,
        lambda t, m=torque: m * (1.0 - 0.2 * (m / AXIS.peak_torque) ** 2) * t / J, 1e-9,
    ) for torque in (0.5, -3.0)},
    **{f"gain asymmetry at {torque} N*m": (
        [present("current_gain_asymmetry")], {"torque": torque}, 0.1,
        lambda t, m=torque: m / J * (1.0 + 0.5 * np.sign(m) * ASYMMETRY) * t, 1e-5,
    ) for torque in (0.5, -0.5)},
    **{f"friction by direction {'stepped ' * bool(more)}from {speed} rad/s": (
        [BY_DIRECTION, *more], {"velocity": speed, "parameters": DRY}, 0.2,
        lambda t, w=speed: w - np.sign(w) * (0.06 + np.sign(w) * 0.025) * t / J, 1e-6 if more else 1e-9,
    ) for speed in (30.0, -30.0) for more in ([], [STEPPED])},
    # a weight that is driven, and one that drives
    **{f"friction by motor and load at {torque} N*m": (
        [present("directional_load_friction"), of("torque_offset", torque=0.8)],
        {"torque": torque, "velocity": 5.0 * up, "parameters": DRY}, 0.1,
        lambda t, m=torque, up=up: 5.0 * up + (m - 0.8 - up * (0.06 + MOTORS * abs(m + RATIO * 0.8))) * t / J, 1e-6,
    ) for torque, up in ((1.5, 1.0), (0.4, -1.0))},
}  # fmt: skip


@pytest.mark.parametrize("name", [*SPEEDS, *POSITIONS])
def test_motion_is_that_of_its_closed_form(name):
    effects, start, duration, law, near = (SPEEDS | POSITIONS)[name]
    states = moved(effects, duration, **start)
    found = states.velocity if name in SPEEDS else states.position
    np.testing.assert_allclose(found, law(states.time), atol=near)
    np.testing.assert_array_equal(states.torque[:-1], start.get("torque", 0.0))  # reported is what was asked


def kinetic(w, inertia=J):
    return 0.5 * inertia * w**2


#: Effects, start and torque, duration - s -, the energy that is constant along q and w, and how near - J.
ENERGIES = {
    "cogging": (
        [present("cogging_torque")], {"velocity": 20.0}, 1.0,
        lambda q, w: kinetic(w) - 0.08 / 6.0 * np.cos(6.0 * q + 1.1), 2e-5,
    ),
    "two harmonics": (
        [of("cogging_torque", amplitude=0.05, harmonic=n) for n in (4.0, 18.0)], {"velocity": 20.0}, 1.0,
        lambda q, w: kinetic(w) - sum(0.05 / n * np.cos(n * q) for n in (4.0, 18.0)), 5e-5,
    ),
    "cogging of a pole pitch": (
        [of("cogging_torque", amplitude=1.0, harmonic=PITCH)], {"velocity": 0.2, "parameters": SLIDE}, 1.0,
        lambda q, w: kinetic(w, 3.0) - 1.0 / PITCH * np.cos(PITCH * q), 6e-5,
    ),
    "unbalance": (
        [present("unbalance")], {"velocity": 20.0}, 2.0, lambda q, w: kinetic(w) - 0.2 * np.cos(q - 0.5), 2e-5,
    ),
    "inertia over position": (
        [present("position_dependent_inertia")], {"velocity": 20.0}, 1.0,
        lambda q, w: kinetic(w) * (1.0 + 0.1 * np.sin(2.0 * q + 0.4)), 2e-4,
    ),
    "friction over position": (
        [present("position_dependent_friction")], {"velocity": 40.0, "parameters": DRY}, 0.5,
        lambda q, w: kinetic(w) + 0.06 * (q + 0.6 * (np.cos(0.7) - np.cos(q + 0.7))), 2e-5,
    ),
    "ripple": (
        [present("torque_ripple")], {"torque": 0.3}, 0.3,
        lambda q, w: kinetic(w) - 0.3 * (q - 0.15 / 4.0 * np.cos(4.0 * q - 1.0)), 2e-3,
    ),
    # friction builds up as K_0*(1 - exp(-sigma*q/K_0))
    "Dahl's bristles": (
        [of("presliding_friction", bristle_stiffness=2.5)], {"torque": 0.15, "parameters": DRY}, 0.1,
        lambda q, w: kinetic(w) - 0.15 * q + 0.06 * (q + 0.06 / 2.5 * np.expm1(-q * 2.5 / 0.06)), 1e-5,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ENERGIES)
def test_energy_is_constant(name):
    effects, start, duration, energy, near = ENERGIES[name]
    states = moved(effects, duration, **start)
    found = energy(states.position, states.velocity)
    np.testing.assert_allclose(found, found[0], atol=near)
    assert np.ptp(states.velocity) > 0.01


@pytest.mark.parametrize(
    ("effect", "torque", "holds"),
    [
        (present("stribeck_friction"), 0.135, True),
        (present("stribeck_friction"), 0.145, False),
        *(
            (of("direction_dependent_friction", coulomb_difference=0.05, viscous_difference=viscous), torque, holds)
            for torque, holds in ((0.08, True), (0.09, False), (-0.03, True), (-0.04, False))
            for viscous in (0.0, 1e-9)  # natively, and step by step
        ),
    ],
)
def test_an_axis_at_rest_stays_up_to_the_level_of_its_friction(effect, torque, holds):
    states = moved([effect], 0.5, torque=torque, parameters=DRY)
    assert (np.abs(states.velocity).max() < 1e-4) == holds


def test_bristles_swing_and_do_not_creep_below_breakaway():
    """With damping they come to rest where they carry the torque."""
    damped = of("presliding_friction", bristle_stiffness=2.5, bristle_damping=0.05)
    states = moved([damped], 2.0, torque=0.03, parameters=DRY)
    assert np.abs(states.velocity[-100:]).max() < 1e-3
    assert states.position[-1] < 0.06 / 2.5


def test_stribeck_friction_stops_an_axis_in_its_time():
    states = moved([present("stribeck_friction")], 0.5, velocity=15.0, parameters=DRY)
    needed, _ = quad(lambda w: DRY.inertia / (0.06 + 0.08 * np.exp(-((w / 5.0) ** 2))), 0.0, 15.0)
    assert states.time[np.argmax(states.velocity < 1e-3)] == pytest.approx(needed, abs=2.0 * PERIOD)


def test_a_motor_runs_by_itself_through_half_of_its_gap_and_carries_the_load_then():
    states = moved([present("backlash")], 1.0, torque=0.5)
    free, late = states.position < 0.0099, states.time > 0.5
    np.testing.assert_allclose(states.velocity[free], 0.5 * states.time[free] / MOTOR, atol=1e-6)
    assert 10 < free.sum() < 200
    assert np.polyfit(states.time[late], states.velocity[late], 1)[0] == pytest.approx(0.5 / J, rel=1e-3)


def test_a_contact_need_not_be_given():
    assert moved([of("backlash", gap=0.02)], 1.0, torque=0.5).velocity[-1] == pytest.approx(0.5 / J, rel=5e-3)


def test_damping_ends_the_swing_of_a_coupling():
    states = moved([of("elastic_coupling", stiffness=40.0, damping=0.1)], 0.5, torque=0.5)
    np.testing.assert_allclose((states.velocity - 0.5 * states.time / J)[-400:], 0.0, atol=1e-3)


def test_a_coupling_needs_a_load_beside_the_motor():
    with pytest.raises(InputError, match="motor's inertia"):
        moved([of("elastic_coupling", stiffness=40.0)], 0.1, parameters=AxisParameters(1e-3))


def test_top_speed_is_that_of_the_voltage():
    """Without friction the current ends at zero: U = K_e*omega. What is reported is what flows."""
    states = moved([of("voltage_limit", voltage=36.0)], 1.0, torque=1.5)
    assert states.velocity[-1] == pytest.approx(36.0 / WINDING.back_emf_constant, rel=1e-3)
    np.testing.assert_allclose(states.torque, states.motor_torque, atol=1e-12)
    assert abs(states.torque[-1]) < 0.05


@pytest.mark.parametrize(("frequency", "damping"), [(300.0, 0.05), (300.0, 1.0), (1e3, 3.0), (1e5, 2000.0)])
def test_a_step_of_any_damping_is_exact(frequency, damping):
    """Against the matrix exponential: of much damping the terms of its closed form overflow, but not their product."""
    state = np.array([[0.0, 1.0], [-(frequency**2), -2.0 * damping * frequency]])
    driven, denominator = _driven(state, np.array([0.0, frequency**2]), 1e-3, np.ones((3, 5)))
    exact = expm(1e-3 * state)
    assert np.isfinite(driven).all()
    assert denominator == pytest.approx([1.0, -np.trace(exact), np.linalg.det(exact)], abs=1e-9)
