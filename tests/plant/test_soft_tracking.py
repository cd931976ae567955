"""A model weakly coupled to a recording, against the closed form of its linear loop."""

import numpy as np
import pytest
from scipy.linalg import expm

from bench.effects.present import Present
from bench.errors import SimulationError
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.tracking import SoftTracking, track, track_all
from bench.trace.trace import Trace, join

INERTIA, VISCOUS, PERIOD, BANDWIDTH = 2e-3, 3e-3, 1e-3, 12.0
TIME = PERIOD * np.arange(2000)
FREE = AxisModel(AxisParameters(INERTIA, VISCOUS))


def at_rest(position=0.0):
    still = np.zeros_like(TIME)
    return Trace(TIME, {"position": still + position, "velocity": still}, {"position": "rad", "velocity": "rad/s"}, "")


def answer(torque, inertia=INERTIA):
    """Motion - (n,) each - of J*alpha = M - K_w*w + K_v*e + K_i*integral(e), e = -K_p*q - w, from rest, M constant."""
    stiff, damping, slow = BANDWIDTH / 5.0, inertia * BANDWIDTH, inertia * BANDWIDTH**2 / 6.0
    # states: q, w, integral of e, and 1 for the torque
    a = np.zeros((4, 4))
    a[0, 1] = 1.0
    a[1] = np.array([-damping * stiff, -damping - VISCOUS, slow, torque]) / INERTIA
    a[2, :2] = -stiff, -1.0
    one, state = expm(a * PERIOD), np.array([0.0, 0.0, 0.0, 1.0])
    found = np.empty((2, TIME.size))
    for k in range(TIME.size):
        found[:, k] = state[:2]
        state = one @ state
    return found


@pytest.mark.parametrize("inertia", [None, 5e-3])
def test_a_torque_that_is_too_large_moves_it_as_its_cascade_lets_it(inertia):
    """K_v = J*w, K_i = J*w**2/6, K_p = w/5 of the inertia that the cascade is laid out for, the model's or another."""
    held = SoftTracking(FREE, at_rest(), np.full(TIME.size, 0.02), inertia=inertia)
    expected = answer(0.02, inertia or INERTIA)
    tracked = track(held, BANDWIDTH)
    for found, exact in zip((tracked.position, tracked.velocity), expected, strict=True):
        # its integral is summed by rectangles of half a millisecond, and so is its damping
        assert np.abs(found - exact).max() < 5e-3 * np.abs(exact).max()


def test_the_measured_position_is_where_it_is_held():
    found = track(SoftTracking(FREE, at_rest(0.7), np.zeros(TIME.size)), BANDWIDTH)
    np.testing.assert_allclose(found.position, 0.7, atol=1e-12)
    np.testing.assert_allclose(found.velocity, 0.0, atol=1e-12)


@pytest.mark.parametrize("late", [3e-3, -3e-3])
def test_an_effort_that_is_reported_late_is_read_ahead(late):
    """A torque of t**2 that the recording has `late`, and the same in time, move it alike."""

    def velocity(delay, misalignment):
        effort = 0.1 * (np.maximum(TIME, 0.05) - delay - 0.05) ** 2
        return track(SoftTracking(FREE, at_rest(), effort, misalignment), BANDWIDTH).velocity

    in_time, read_ahead = velocity(0.0, 0.0), velocity(late, late)
    inside = slice(100, -10)
    assert np.abs(read_ahead - in_time)[inside].max() < 0.02 * np.abs(velocity(late, 0.0) - in_time)[inside].max()


def model(*effects):
    """The axis with effects that act in every step."""
    return FREE.with_effects([Present.of(name, values) for name, values in effects])


def moving(trace, *effects, friction=0.0):
    parameters = AxisParameters(INERTIA, VISCOUS, friction)
    held = SoftTracking(AxisModel(parameters, model(*effects).effects), trace, np.zeros(len(trace)))
    return track(held, BANDWIDTH).velocity


def first_moved(velocity, time):
    return time[np.flatnonzero(np.abs(np.nan_to_num(velocity)) > 1e-9)[0]]


EVENT = {"torque": 0.02, "start": 0.6, "end": 5.0}


def test_time_of_effects_counts_from_the_start_of_the_recording_over_its_holes():
    whole = at_rest()
    kept = np.r_[0:200, 300:2000]
    holed = Trace(TIME[kept], {name: whole[name][kept] for name in whole.signals}, dict(whole.units), "")
    moved = first_moved(moving(holed, ("load_torque_event", EVENT)), holed.time)
    assert moved == pytest.approx(0.6, abs=2.0 * PERIOD)


def test_an_event_of_joined_recordings_is_where_it_was_in_all_of_them():
    both = join([at_rest(), at_rest(0.5)])
    second = float(both.joined[1][0])
    event = {"torque": 0.02, "start": second + 0.6, "end": second + 5.0}
    moved = first_moved(moving(both, ("load_torque_event", event)), both.time)
    assert moved == pytest.approx(second + 0.6, abs=2.0 * PERIOD)


def test_a_motion_that_needs_no_torque_is_kept_to_the_last_digit():
    """Set-points lead by half a step as MuJoCo's position does: nothing pulls on a model that goes along."""
    speed = np.full_like(TIME, 3.0)
    trace = Trace(TIME, {"position": 3.0 * TIME, "velocity": speed}, {"position": "rad", "velocity": "rad/s"}, "")
    free = SoftTracking(AxisModel(AxisParameters(INERTIA)), trace, np.zeros(TIME.size))
    np.testing.assert_allclose(track(free, BANDWIDTH).velocity, 3.0, atol=1e-10)


RIPPLE = ("torque_ripple", {"relative_amplitude": 0.3, "harmonic": 3.0})


def test_models_side_by_side_move_as_each_alone():
    """Two of them as long as the others or shorter, on one batch; native ones beside them."""
    long, short = at_rest(), at_rest().between(0.0, 1.7)
    models = [(model(RIPPLE), long), (FREE, long), (model(RIPPLE), short), (model(RIPPLE), long)]
    tracked = [SoftTracking(one, trace, 0.02 * np.cos(9.0 * trace.time)) for one, trace in models]
    for one, together in zip(tracked, track_all(tracked, BANDWIDTH), strict=True):
        np.testing.assert_array_equal(together.velocity, track(one, BANDWIDTH).velocity)


def test_a_model_that_diverges_is_none_and_leaves_the_others():
    """A Stribeck velocity of nothing divides by it."""
    bad = model(("stribeck_friction", {"static_friction": 0.2, "stribeck_velocity": 0.0}))
    good = model(("stribeck_friction", {"static_friction": 0.2, "stribeck_velocity": 1.0}))
    tracked = [SoftTracking(one, at_rest(), np.full(TIME.size, 0.3)) for one in (good, bad)]
    with np.errstate(all="ignore"):
        one, other = track_all(tracked, BANDWIDTH)
        assert one is not None
        assert other is None
        with pytest.raises(SimulationError, match="diverged"):
            track(tracked[1], BANDWIDTH)


def test_a_contact_that_outruns_half_a_millisecond_carries_its_load_along():
    """A torque gives motor and load J*w = M*t once the gap has closed, however hard the contact damps.

    In steps of 0.5 ms its damping, 5500/s, would overshoot further with each.
    """
    contact = {"gap": 0.019, "contact_stiffness": 674.0, "contact_damping": 1.02}
    parameters = AxisParameters(7.56e-4, motor_inertia=4.19e-4)
    held = AxisModel(parameters, (Present.of("backlash", contact),))
    torque = np.full(TIME.size, 0.01)
    velocity = track(SoftTracking(held, at_rest(), torque), 1e-9).velocity
    settled = TIME > 1.0
    np.testing.assert_allclose(velocity[settled], 0.01 * TIME[settled] / 7.56e-4, rtol=1e-3)
