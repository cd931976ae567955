"""What is put into a recording is what the independent integrator makes of an axis that has the effect."""

from dataclasses import replace

import numpy as np
import pytest

from bench.arrays import rms
from bench.errors import InputError
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from bench.validation.independent.effects import (
    KINDS,
    Backlash,
    CoggingTorque,
    CurrentGainAsymmetry,
    DirectionalLoadFriction,
    ElasticCoupling,
    LoadDependentFriction,
    PreslidingFriction,
    TorqueOffset,
    Unbalance,
    VelocityFilterLag,
    VoltageLimit,
)
from bench.validation.independent.references import Motion, Multisine
from bench.validation.independent.rig import Axis
from bench.validation.independent.sensors import Sensors
from bench.validation.independent.simulate import simulate
from bench.validation.injection import INJECTABLE, Host, behind, disturbance, drawn, injected, modelled
from tests.kept import kept

PERIOD = 250e-6
AXIS = Axis(
    name="axis",
    inertia=1.5e-3,
    viscous=4e-4,
    coulomb=0.06,
    rotor_inertia=5e-4,
    torque_constant=0.8,
    peak_current=2.5,
    velocity_gain=0.15,
    control_period=125e-6,
    top_speed=60.0,
)
RIG = Rig.of({"name": "axis", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A", "peak_current": "2.5 A"}})
MOTION = Motion((Multisine(1.6, np.array([40.0, 12.0, 5.0]), np.array([0.7, 2.3, 5.1]), np.array([0.3, 1.9, 0.7])),))
#: A coupling's truth is in closed form: the motion that contacts make is too fast for the cubic.
RIGID = tuple(name for name in INJECTABLE if not hasattr(KINDS[name], "transmitted_torque"))
#: By which currents differ since a drive's current is held over its tick - A.
SKEW = 5e-4
WEIGHT = Unbalance(0.2, 0.4)


def effect_of(name):
    return KINDS[name].draw(AXIS, 0.5, np.random.default_rng(3), 1.6)


def beside(name):
    """What the axis has anyway: a load, where the effect is a friction by it."""
    return (WEIGHT,) if name == "directional_load_friction" else ()


def simulated():
    effects = [(*beside(name), effect_of(name)) for name in RIGID]
    count, sensors = len(effects), Sensors(sample_period=PERIOD, encoder_resolution=0.0)
    return simulate([AXIS] * count, [MOTION] * count, effects, [sensors] * count, longest_step=AXIS.control_period)


@pytest.fixture(scope="module")
def recorded():
    return dict(zip(RIGID, kept(simulated, __file__), strict=True))


def plain_host(run, name):
    """The same motion of the axis without the effect, its torque from the equation of motion."""
    position, speed = run.true["position"], run.true["velocity"]
    load = sum((each.amplitude * np.sin(position + each.phase) for each in beside(name)), np.zeros(position.size))
    torque = AXIS.inertia * np.gradient(speed, PERIOD) + AXIS.viscous * speed + AXIS.coulomb * np.sign(speed) + load
    signals = {"position": position, "velocity": speed, "current": torque / AXIS.torque_constant}
    return Host(Trace(run.trace.time, signals, run.trace.units, "plain"), RIG, AXIS, load if beside(name) else None)


@pytest.mark.parametrize("name", RIGID)
def test_it_is_what_an_axis_with_the_effect_records(recorded, name):
    run = recorded[name]
    host = plain_host(run, name)
    made = injected(host, effect_of(name))
    settled = (np.abs(run.true["velocity"]) > 2.0) & (run.trace.time > 0.1)
    changed = 0
    for signal in ("position", "velocity", "current"):
        change, error = (rms((run.trace[signal] - one[signal])[settled]) for one in (host.trace, made))
        assert error < 0.05 * change + SKEW
        changed += change > 3.0 * SKEW
    assert changed


def uniform(acceleration, time):
    """Position and speed of a motion whose acceleration is given at even times, by the trapezoidal rule."""
    speed = np.concatenate([[0.0], np.cumsum(0.5 * PERIOD * (acceleration[1:] + acceleration[:-1]))])
    return np.concatenate([[0.0], np.cumsum(0.5 * PERIOD * (speed[1:] + speed[:-1]))]), speed


def host_of(position, torque, axis=AXIS, rig=RIG):
    time = PERIOD * np.arange(position.size)
    signals = {"position": position, "current": torque / axis.torque_constant}
    return Host(Trace(time, signals, {"position": "rad", "current": "A"}, "made"), rig, axis)


def added(host, effect):
    """Torque that the effect adds - N*m."""
    return (injected(host, effect)["current"] - host.trace["current"]) * host.axis.torque_constant


TIME = PERIOD * np.arange(8000)
SWING = 6.0 * np.sin(2.0 * np.pi * 0.8 * TIME)


def test_cogging_is_a_sine_of_the_position():
    noisy = SWING + 1e-4 * np.random.default_rng(1).normal(size=TIME.size)
    torque = added(host_of(noisy, np.zeros(TIME.size)), CoggingTorque(0.05, 8.0, 0.3))
    assert torque == pytest.approx(0.05 * np.sin(8.0 * SWING + 0.3), abs=1e-3)


def test_an_axis_whose_torque_acts_late_is_given_it_early():
    late = replace(host_of(20.0 * TIME, np.zeros(TIME.size)), lag=2e-3)  # T*dM/dt + M of a sine at n*w = 80 rad/s
    torque = added(late, CoggingTorque(0.05, 4.0, 0.3))[50:-50]
    angle = (80.0 * TIME + 0.3)[50:-50]
    assert torque == pytest.approx(0.05 * (np.sin(angle) + 0.16 * np.cos(angle)), abs=2e-4)


def test_what_acts_on_the_reported_current_comes_behind_the_lag_that_the_axis_has():
    host = host_of(SWING, 0.3 * np.sin(2.0 * np.pi * 3.0 * TIME))
    assert added(replace(host, lag=2e-3), CurrentGainAsymmetry(0.02)) == pytest.approx(
        added(host, CurrentGainAsymmetry(0.02))
    )


def test_torque_is_put_where_the_axis_is_and_not_where_its_sensor_errs():
    host = host_of(SWING + 0.02 * np.sin(SWING), np.zeros(TIME.size))
    true = replace(host, moved=host_of(SWING, np.zeros(TIME.size)).trace)
    torque = added(true, CoggingTorque(0.05, 8.0, 0.3))
    assert torque == pytest.approx(0.05 * np.sin(8.0 * SWING + 0.3), abs=1e-4)
    assert rms(torque - added(host, CoggingTorque(0.05, 8.0, 0.3))) > 2e-3


def test_a_motor_overcomes_the_friction_that_its_own_torque_makes():
    torque = np.full(TIME.size, 0.4)
    changed = added(host_of(20.0 * TIME, torque), LoadDependentFriction(0.2))  # M = 0.4 + 0.2*|M|
    assert changed == pytest.approx(np.full(TIME.size, 0.4 / 0.8 - 0.4))


def test_friction_takes_at_rest_what_it_is_given():
    position = np.where(TIME < 1.0, 1.0, 1.0 + 5.0 * (TIME - 1.0) ** 2)
    changed = added(host_of(position, np.full(TIME.size, 0.4)), LoadDependentFriction(0.2))
    assert not changed[TIME < 0.98].any()


def test_a_spring_carries_the_load_as_its_transfer_function_says():
    """(w_n**2 + 2*z*w_n*s)/(s**2 + 2*z*w_n*s + w_n**2) of the load's torque, once the start has died away."""
    rate, load = 2.0 * np.pi * 9.0, AXIS.inertia - AXIS.rotor_inertia
    natural, damping = 2.0 * np.pi * 40.0, 0.1
    coupling = ElasticCoupling(load * natural**2, 2.0 * damping * natural * load)
    torque = added(host_of(0.05 * np.sin(rate * TIME), np.zeros(TIME.size)), coupling)
    s = 1j * rate
    over = (natural**2 + 2.0 * damping * natural * s) / (s**2 + 2.0 * damping * natural * s + natural**2) - 1.0
    expected = load * (over * 0.05 * s**2 * np.exp(s * TIME)).imag
    late = TIME > 0.5
    assert rms((torque - expected)[late]) < 0.03 * rms(expected[late])


def test_a_load_flies_through_a_gap_as_long_as_it_takes():
    """The motor slows down, the load runs on: sqrt(2*gap/deceleration) in which the motor moves itself alone."""
    gap, slowing, load = 0.04, 60.0, AXIS.inertia - AXIS.rotor_inertia
    position, _ = uniform(np.where(TIME < 0.5, slowing, -slowing), TIME)
    stiff = Backlash(gap, load * (2.0 * np.pi * 100.0) ** 2, 0.6 * load * 2.0 * np.pi * 100.0)
    free = added(host_of(position, np.zeros(TIME.size)), stiff)[TIME > 0.5] > 0.95 * load * slowing
    start = int(np.argmax(free))
    flies = PERIOD * int(np.argmin(free[start:]))  # the first time, before it bounces
    assert flies == pytest.approx(np.sqrt(2.0 * gap / slowing), rel=0.1)


def test_a_lag_of_a_sine_is_its_transfer_function():
    rate, constant, period = 2.0 * np.pi * 3.0, 4e-3, 5e-3
    time = period * np.arange(400)
    expected = (np.exp(1j * rate * time) / (1.0 + 1j * rate * constant)).imag
    assert behind(np.sin(rate * time), period, constant)[100:] == pytest.approx(expected[100:], abs=2e-3)


def test_a_hole_ends_what_an_effect_remembers():
    whole = host_of(SWING, np.zeros(TIME.size))
    late = TIME + 1.0 * (TIME > 1.0)
    holed = replace(whole, trace=replace(whole.trace, time=late))
    bristles, after = PreslidingFriction(2.0), int(1.0 / PERIOD) + 1
    alone = replace(whole, trace=whole.trace.between(TIME[after], 9.0))
    assert added(holed, bristles)[after:] == pytest.approx(added(alone, bristles), abs=1e-6)


@pytest.mark.parametrize("signal", ["torque", "current", "voltage"])
def test_the_effort_is_put_into_the_signal_that_tells_it(signal):
    motor = {"torque_constant": "0.8 N*m/A", "peak_current": "8 A", "resistance": "2 ohm"}
    rig = Rig.of({"name": "axis", "kind": "rotary", "motor": motor})
    unit, per = {"torque": ("N*m", 1.0), "current": ("A", 1.25), "voltage": ("V", 2.5)}[signal]
    signals = {"position": SWING, "velocity": np.gradient(SWING, PERIOD), signal: 0.1 * np.cos(TIME)}
    trace = Trace(TIME, signals, {"position": "rad", "velocity": "rad/s", signal: unit}, "made")
    made = injected(Host(trace, rig, AXIS), TorqueOffset(0.02))
    assert made[signal] - trace[signal] == pytest.approx(np.full(TIME.size, 0.02 * per))


def test_what_j_and_friction_take_up_is_not_left():
    torque = 0.3 * np.cos(2.0 * np.pi * 0.8 * TIME)
    host = host_of(SWING, torque)
    whole, beyond = disturbance(host, injected(host, TorqueOffset(0.02)))
    assert (whole, beyond) == pytest.approx((0.02, 0.02), rel=0.05)
    more = 0.001 * np.gradient(SWING, PERIOD)
    current = host.trace["current"] + more / AXIS.torque_constant
    whole, beyond = disturbance(host, host.trace.with_signals({"current": current}, {}))
    assert whole == pytest.approx(np.sqrt(np.mean(more**2)), rel=0.05)
    assert beyond < 1e-3 * whole


@pytest.mark.parametrize("name", ["cogging_torque", "stribeck_friction", "load_dependent_friction"])
@pytest.mark.parametrize("size", [0.002, 0.01])
def test_one_is_drawn_of_the_size_that_is_wanted(name, size):
    """On the axis alone, whatever else its torque holds: friction by load scales that, too."""
    host = host_of(SWING, 2.0 * np.cos(2.0 * np.pi * 0.8 * TIME))
    effect, alone = drawn(host, name, size, 4), modelled(host)
    assert disturbance(alone, injected(alone, effect))[1] == pytest.approx(size, rel=0.1)
    assert effect == drawn(host, name, size, 4)


def test_none_is_drawn_that_the_axis_cannot_have():
    host = host_of(SWING, np.zeros(TIME.size))
    assert drawn(replace(host, axis=replace(AXIS, linear=True)), "cogging_torque", 0.01, 1) is None
    assert drawn(host, "velocity_filter_lag", 0.01, 1) is None  # no speed is recorded
    assert drawn(host, "directional_load_friction", 0.01, 1) is None  # no load is known
    assert drawn(host, "torque_constant_saturation", 1.0, 1) is None  # there is no torque to lose


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        (VoltageLimit(12.0), "voltage_limit: acts by driven_current"),
        (LoadDependentFriction(1.2), "so strong"),
        (VelocityFilterLag(2e-3), "contains no velocity"),
        (DirectionalLoadFriction(0.2, 2.0), "load torque: found none"),
    ],
)
def test_what_cannot_be_put_into_a_recording_is_refused_in_one_line(effect, expected):
    host = host_of(20.0 * TIME, np.full(TIME.size, 0.4))
    with pytest.raises(InputError, match=expected):
        injected(host, effect)
