"""The mechanics against the closed forms of J*dw/dt = M - K_w*w - K_0*sgn(w) - M_L."""

import dataclasses

import numpy as np
import pytest

from bench.axis_kind import LINEAR
from bench.plant.axis_model import AxisParameters, build_spec
from tests.plant.open_loop import open_loop

AXES = {
    "the lab's axis": (AxisParameters(2.2e-3, 1.1e-3, 0.085, motor_inertia=2.5e-5), 144.0, 250e-6),
    "coarse step": (AxisParameters(2.2e-3, 1.1e-3, 0.085), 144.0, 1e-3),
    "strongly damped": (AxisParameters(1e-3, 5e-2, 0.01), 200.0, 1e-3),
    "undamped": (AxisParameters(1e-3, 0.0, 0.05), 100.0, 250e-6),
    "linear": (AxisParameters(95.1, 203.5, 20.4, kind=LINEAR), 0.8, 1e-3),
}


def coast(parameters, torque, speed, position, steps, timestep):
    return open_loop(build_spec(parameters, timestep), np.full(steps, torque), position, speed)


def closed_form(
    p: AxisParameters, torque: float, speed: float, time: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Velocity, distance and stopping time of positive motion under a constant torque that ends it, or never does."""
    drive = torque - p.coulomb_friction - p.load_torque
    rate = p.viscous_friction_coefficient / p.inertia
    if rate == 0.0:
        stop = -speed * p.inertia / drive if drive < 0.0 else np.inf
        t = np.minimum(time, stop)
        return speed + drive / p.inertia * t, speed * t + drive / p.inertia * t**2 / 2.0, stop
    final = drive / p.viscous_friction_coefficient
    stop = np.log(1.0 - speed / final) / rate if final < 0.0 else np.inf
    t = np.minimum(time, stop)
    velocity = final + (speed - final) * np.exp(-rate * t)
    return velocity, final * t + (speed - final) * -np.expm1(-rate * t) / rate, stop


@pytest.mark.parametrize("name", AXES)
def test_coast_down_to_standstill(name):
    parameters, speed, timestep = AXES[name]
    stop = closed_form(parameters, 0.0, speed, np.zeros(1))[2]
    steps = round(1.3 * stop / timestep)
    states = coast(parameters, 0.0, speed, 0.3, steps, timestep)
    velocity, distance, stop = closed_form(parameters, 0.0, speed, states.time)
    worst = np.abs(states.velocity - velocity).max()
    stopped = states.time[np.flatnonzero(np.abs(states.velocity) < 1e-4)[0]]
    print(f"coast-down, {name}: worst velocity deviation {worst:.2e} rad/s, stop {stopped:.5f} s, exact {stop:.5f} s")
    assert worst < 1e-4
    assert 0.0 <= stopped - stop <= timestep
    # The trapezoidal rule over each step, h**2/12 of the change of acceleration, and h**2/8 of it where motion ends.
    deceleration = (parameters.viscous_friction_coefficient * speed + parameters.coulomb_friction) / parameters.inertia
    assert np.abs(states.position - 0.3 - distance).max() < 0.21 * timestep**2 * deceleration


@pytest.mark.parametrize("share", [-0.5, 0.5, 0.95])
@pytest.mark.parametrize("name", AXES)
def test_sticks_below_breakaway(name, share):
    parameters, _, timestep = AXES[name]
    states = coast(parameters, share * parameters.coulomb_friction, 0.0, 0.0, 4000, timestep)
    worst = np.abs(states.velocity).max()
    print(f"sticking under {share:+.0%} of breakaway, {name}: worst velocity {worst:.2e} rad/s")
    assert worst < 1e-4


def test_breaks_away_above_breakaway_torque():
    parameters, _, timestep = AXES["the lab's axis"]
    states = coast(parameters, 1.05 * parameters.coulomb_friction, 0.0, 0.0, 4000, timestep)
    velocity = closed_form(parameters, 1.05 * parameters.coulomb_friction, 0.0, states.time)[0]
    assert np.abs(states.velocity - velocity).max() < 1e-4


@pytest.mark.parametrize("load_torque", [0.0, 0.4])
def test_constant_torque_accelerates_to_its_final_speed(load_torque):
    parameters = dataclasses.replace(AXES["the lab's axis"][0], load_torque=load_torque)
    states = coast(parameters, 1.0, 2.0, 0.0, 8000, 250e-6)
    velocity, distance, _ = closed_form(parameters, 1.0, 2.0, states.time)
    worst = np.abs(states.velocity - velocity).max()
    print(f"constant torque against load {load_torque} N*m: worst velocity deviation {worst:.2e} rad/s")
    assert worst < 1e-6
    assert np.abs(states.position - distance).max() < 1e-7 * distance[-1]


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_load_torque_is_held_by_friction_or_not(sign):
    parameters = dataclasses.replace(AXES["the lab's axis"][0], load_torque=sign * 0.08)
    assert np.abs(coast(parameters, 0.0, 0.0, 0.0, 2000, 250e-6).velocity).max() < 1e-4
    parameters = dataclasses.replace(parameters, load_torque=sign * 0.09)
    assert coast(parameters, 0.0, 0.0, 0.0, 2000, 250e-6).velocity[-1] * sign < -0.5


def test_error_falls_with_the_square_of_the_step():
    """Torque that varies is held over each step: second order, as of a leapfrog, not first."""
    parameters = AxisParameters(2.2e-3, 0.0, 0.0)

    def error(timestep):
        time = np.arange(round(0.5 / timestep)) * timestep
        spec = build_spec(parameters, timestep)
        spec.joint("axis").stiffness = [4.0, 0.0, 0.0]
        states = open_loop(spec, np.zeros(len(time)), position=1.0)
        return np.abs(states.position - np.cos(np.sqrt(4.0 / parameters.inertia) * time)).max()

    coarse, fine = error(500e-6), error(250e-6)
    print(f"spring: position error {coarse:.2e} rad at 500 us, {fine:.2e} rad at 250 us")
    assert coarse / fine == pytest.approx(4.0, rel=0.1)
