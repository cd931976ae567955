"""The drive: MuJoCo's actuator, the ticked cascade and the written law are one."""

import dataclasses

import numpy as np
import pytest

from bench.effects.present import Present
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.drive import Cascade, CascadeDrive, References
from bench.plant.plant import Plant
from bench.plant.run import run, run_native, run_ticked


def reversals(period=250e-6, duration=2.0, speed=80.0, frequency=1.5):
    t = np.arange(round(duration / period)) * period
    w = 2.0 * np.pi * frequency
    return References(
        t,
        speed / 2.0 * (t - np.sin(w * t) / w + (1.0 - np.cos(2 * w * t)) / (2 * w) * 1.5),
        speed / 2.0 * (1.0 - np.cos(w * t) + 1.5 * np.sin(2 * w * t)),
        speed / 2.0 * (w * np.sin(w * t) + 3.0 * w * np.cos(2 * w * t)),
    )


def standstill(period, duration):
    t = np.arange(round(duration / period)) * period
    return References(t, 0.0 * t, 0.0 * t, 0.0 * t)


def exact_step(w, q, torque, p, h):
    """Velocity and position after h under constant torque, with viscous and dry friction, stopping inside the step."""
    k = p.viscous_friction_coefficient / p.inertia
    left = h
    while left > 0.0:
        if w == 0.0 and abs(torque) <= p.coulomb_friction:
            return 0.0, q
        direction = np.sign(w) or np.sign(torque)
        a = (torque - direction * p.coulomb_friction) / p.inertia
        final = a / k
        end = final + (w - final) * np.exp(-k * left)
        part = left
        if end * direction < 0.0:
            part = np.log((w - final) / -final) / k
            end = 0.0
        q += final * part + (w - final) * -np.expm1(-k * part) / k
        w, left = end, left - part
    return w, q


def written_law(plant, r):
    """The contract's cascade on an exactly integrated axis, integrals by the rectangle rule, one tick after another."""
    c, h = plant.cascade, plant.cascade.control_period
    w, q, integral, out = r.velocity[0], r.position[0], 0.0, []
    for k in range(len(r.time)):
        error = r.velocity[k] + c.position_gain * (r.position[k] - q) - w
        wanted = c.velocity_gain * error + c.integral_gain * integral + c.inertia_feedforward * r.acceleration[k]
        torque = np.clip(wanted, -c.torque_limit, c.torque_limit)
        if torque == wanted:
            integral += error * h
        out.append((q, w, torque))
        w, q = exact_step(w, q, torque, plant.axis.parameters, h)
    return np.array(out).T


def worst(a, b):
    return {name: float(np.abs(getattr(a, name) - getattr(b, name)).max()) for name in ("velocity", "torque")}


@pytest.mark.parametrize(("integral_gain", "within"), [(55.0, 1e-4), (0.0, 1e-9)])
def test_mujoco_actuator_is_the_ticked_cascade(plant, integral_gain, within):
    """With an integral gain, and as a plain PD."""
    cascade = dataclasses.replace(plant.cascade, integral_gain=integral_gain)
    axis, references = dataclasses.replace(plant, cascade=cascade), reversals()
    off = worst(run_native(axis.native_loop(references)), run_ticked(axis.ticked_loop(references)))
    print(f"pid against ticked cascade: {off['velocity']:.1e} rad/s, {off['torque']:.1e} N*m")
    assert off["velocity"] < within
    assert off["torque"] < 1e-4


@pytest.mark.parametrize("speed", [60.0, 95.0])
def test_plant_moves_as_the_written_law_on_an_exact_axis(plant, speed):
    """The higher speed limits the torque now and then, so that the integrator holds."""
    references = reversals(speed=speed)
    states, (position, velocity, torque) = run(plant, references), written_law(plant, references)
    limited = np.abs(torque) >= plant.cascade.torque_limit
    off = np.abs(states.velocity - velocity)
    print(f"plant against written law, {limited.mean():.0%} limited: worst {off.max():.1e}, rms {off.std():.1e} rad/s")
    assert limited.any() == (speed > 90.0)
    assert off.max() < reversal_error(plant)
    assert np.sqrt((off**2).mean()) < 0.2 * reversal_error(plant)
    assert np.abs(states.position - position).max() < 2e-3


def reversal_error(plant):
    """A step in which the axis reverses has friction against the new direction all along: up to 2*K_0*h/J - rad/s."""
    return 2.0 * plant.axis.parameters.coulomb_friction * plant.timestep / plant.axis.parameters.inertia


def test_torque_never_exceeds_the_limit_and_integrator_holds(plant):
    """A step of the speed demand: with the integrator held, speed overshoots less than without."""
    t = np.arange(2000) * 250e-6
    step = References(t, 150.0 * t, np.full_like(t, 150.0), 0.0 * t)
    step = References(t, step.position, step.velocity * (t > 0.0), step.acceleration)
    plain = dataclasses.replace(plant, cascade=dataclasses.replace(plant.cascade, position_gain=0.0))
    held, wound_up = run(plain, step), run_native(plain.native_loop(step))
    assert np.abs(held.torque).max() == plant.cascade.torque_limit
    assert held.velocity.max() - 150.0 < 0.5 * (wound_up.velocity.max() - 150.0)


def test_friction_by_the_drive_moves_as_friction_in_the_mechanics(plant):
    references = reversals()
    emulated = run(dataclasses.replace(plant, emulated=True), references)
    off = worst(emulated, run(plant, references))
    print(f"friction by the drive against mechanics: {off['velocity']:.1e} rad/s, {off['torque']:.1e} N*m")
    assert off["velocity"] < 1e-3
    assert off["torque"] < 1e-3
    friction = (emulated.torque - emulated.motor_torque)[:-1]
    middle = (emulated.velocity[1:] + emulated.velocity[:-1]) / 2.0
    moving = np.abs(middle) > 1.0
    expected = plant.axis.parameters.coulomb_friction * np.sign(middle)
    expected = expected + plant.axis.parameters.viscous_friction_coefficient * middle
    np.testing.assert_allclose(friction[moving], expected[moving], atol=1e-9)


@pytest.mark.parametrize("load_torque", [-0.06, 0.0, 0.06, -0.1])
def test_emulated_friction_holds_a_standing_axis_up_to_breakaway(plant, load_torque):
    """A drive that only holds by friction: no gains. Load and friction settle; the axis stays, or slips."""
    weak = Cascade(0.0, 0.0, 0.0, 0.0, 3.5, 250e-6)
    parameters = dataclasses.replace(plant.axis.parameters, load_torque=load_torque)
    states = run(Plant(AxisModel(parameters), weak, 250e-6, emulated=True), standstill(250e-6, 1.0))
    if abs(load_torque) < parameters.coulomb_friction:
        assert np.abs(states.velocity[100:]).max() < 1e-9
        assert states.motor_torque[-1] == pytest.approx(load_torque, abs=1e-9)
    else:
        rate = parameters.viscous_friction_coefficient / parameters.inertia
        final = (-load_torque - parameters.coulomb_friction) / parameters.viscous_friction_coefficient
        np.testing.assert_allclose(states.velocity, -final * np.expm1(-rate * states.time), atol=2e-2)


@pytest.mark.parametrize("emulated", [False, True])
def test_friction_that_stops_the_axis_within_a_tick_stops_it_dead(emulated):
    """J*w = 0.6*K_0*T, beside viscous friction that takes a tenth of the speed in that time."""
    period, inertia, coulomb = 250e-6, 1e-3, 0.1
    axis = AxisModel(AxisParameters(inertia, 0.1 * inertia / period, coulomb))
    start = standstill(period, 0.01)
    start = dataclasses.replace(start, velocity=start.velocity + 0.6 * coulomb * period / inertia)
    states = run(Plant(axis, Cascade(0.0, 0.0, 0.0, 0.0, 1.0, period), period, emulated=emulated), start)
    assert states.velocity[0] == pytest.approx(0.015)
    assert np.abs(states.velocity[1:]).max() < 0.015 * 1e-2


def test_motor_stays_within_its_limit_with_emulated_friction(plant):
    emulated = dataclasses.replace(plant, emulated=True)
    states = run(emulated, reversals(speed=200.0))
    assert np.abs(states.motor_torque).max() == pytest.approx(plant.cascade.torque_limit)


def test_cascade_terms_one_by_one():
    """First tick: proportional, feed-forward and half a tick of integral; second: all of the first error too."""
    cascade = Cascade(10.0, 2.0, 30.0, 0.5, 100.0, 1e-3)
    ones = np.ones(2)
    references = References(np.array([0.0, 1e-3]), 3.0 * ones, 4.0 * ones, 5.0 * ones)
    drive = CascadeDrive(cascade, references)
    error = 4.0 + 10.0 * (3.0 - 2.5) - 1.0
    first, second = (drive.tick(k, 2.5, 1.0)[0] for k in (0, 1))
    assert first == pytest.approx(2.0 * error + 0.5 * 5.0 + 30.0 * error * 0.5e-3)
    assert second - first == pytest.approx(30.0 * error * 1e-3)


def test_substeps_leave_the_motion_as_it_is(plant):
    """The mechanics are exact under a held torque, but for the step of a reversal."""
    references = reversals()
    fine = run(dataclasses.replace(plant, timestep=62.5e-6), references)
    off = fine.velocity - run(plant, references).velocity
    print(f"62.5 us against 250 us: worst {np.abs(off).max():.1e}, rms {off.std():.1e} rad/s")
    assert np.abs(off).max() < reversal_error(plant)
    assert off.std() < 0.1 * reversal_error(plant)


def test_substeps_act_as_often_as_they_are(plant):
    """What is reported is the mean over a tick, whose steps make one tick's motion."""
    effect = Present.of("torque_ripple", {"relative_amplitude": 0.2, "harmonic": 3.0})
    coarse = dataclasses.replace(plant, axis=plant.axis.with_effects([effect]))
    references = reversals(duration=0.5)
    whole, half = (run(dataclasses.replace(coarse, timestep=step), references) for step in (250e-6, 125e-6))
    assert worst(half, whole)["velocity"] < reversal_error(plant)
    assert np.sqrt(((half.torque - whole.torque) ** 2).mean()) < 1e-3 * np.abs(whole.torque).max()
    assert np.sqrt(((half.motor_torque - whole.motor_torque) ** 2).mean()) < 5e-3 * np.abs(whole.motor_torque).max()


def test_emulation_values_are_what_it_takes():
    emulation = AxisParameters(1e-3, 0.0, 0.3)
    cascade = Cascade(0.0, 0.0, 0.0, 0.0, np.inf, 1e-3)
    setpoint, motor = CascadeDrive(cascade, standstill(1e-3, 2e-3), emulated=emulation).tick(0, 0.0, 5.0)
    assert motor == pytest.approx(-0.3)
    assert setpoint == pytest.approx(0.0)
