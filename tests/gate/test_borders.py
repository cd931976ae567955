"""Where a check begins to warn and to fail, on numbers and motions in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from bench.gate import effort, signals, timing, velocity
from bench.gate.check import Seen, Sums, balanced
from bench.trace.trace import Trace
from tests.gate.damage import changed


@pytest.fixture(scope="module")
def fitted(sound):
    return Seen(sound).balance()


@pytest.mark.parametrize(
    ("by_motion", "by_position", "over_noise", "status", "advice"),
    [
        (0.46, 0.46, 1.0, "pass", ""),
        (0.44, 0.44, 9.0, "warn", "bench diagnose"),
        (0.31, 0.31, 9.0, "warn", "bench diagnose"),
        (0.29, 0.29, 9.0, "fail", "another axis"),
        (0.29, 0.29, 3.1, "fail", "another axis"),
        (0.29, 0.29, 2.9, "warn", "accelerations too small"),
        (0.44, 0.44, 2.9, "warn", "accelerations too small"),
        (0.60, 0.91, 9.0, "pass", "gravity"),
        (0.60, 0.89, 9.0, "pass", ""),
        (0.10, 0.41, 9.0, "warn", "gravity"),
    ],
)
def test_shares_explained(fitted, by_motion, by_position, over_noise, status, advice):
    stated = replace(fitted, by_motion=by_motion, by_position=by_position)
    stated.__dict__["effort_over_noise"] = over_noise
    found = effort.judged(stated, "current")
    assert found.status == status
    assert (advice in found.advice) if advice else not found.advice


@pytest.mark.parametrize("kept", [None, "inertia", "friction", "power"])
def test_signs_are_opposite_where_inertia_friction_and_power_are_negative_and_not_where_one_is_not(fitted, kept):
    inertia, coulomb, power = (1.0 if kept == name else -1.0 for name in ("inertia", "friction", "power"))
    turned = replace(fitted, inertia=inertia, coulomb=coulomb, effort=power * fitted.columns[:, 1])
    found = effort.judged(turned, "current")
    assert (found.status == "fail" and "opposite signs" in found.found) == (kept is None)


@pytest.mark.parametrize("length", [20, 80])
def test_means_over_windows_of_white_noise_stand_as_high_as_it_lets_them(length):
    """Means over so many samples of white noise have its standard deviation over the root of their number."""
    rng, count = np.random.default_rng(3), 40_000
    torque, speed = rng.normal(scale=0.2, size=count), 1.0 + rng.normal(scale=0.01, size=count)
    trace = Trace(1e-3 * np.arange(count), {"velocity": speed}, {"velocity": "rad/s"}, "noise")
    found = balanced([Sums.of(trace, speed, torque, slice(0, count))], length)
    assert found is not None
    assert (found.effort_over_noise, found.speed_over_noise) == pytest.approx((1.0, 1.0), rel=0.1)


@pytest.mark.parametrize(
    ("ratio", "remainder", "status"),
    [
        (1.019, 0.0, "pass"),
        (1.021, 0.0, "warn"),
        (0.981, 0.39, "pass"),
        (0.979, 0.39, "warn"),
        (1.099, 0.0, "warn"),
        (1.101, 0.0, "fail"),
        (0.901, 0.0, "warn"),
        (0.899, 0.0, "fail"),
        (1.0, 0.41, "fail"),
        (1.5, 0.41, "fail"),
    ],
)
def test_ratio_and_remainder_of_a_speed(ratio, remainder, status):
    found = velocity.judged(ratio, 0.0, remainder)
    assert found.status == status
    assert ("not the same motion" in found.found) == (remainder > 0.4)


def test_ratio_lag_and_offset_of_a_motion_in_closed_form_are_found():
    """0.7*(v - T*dv/dt) of a sine, held against itself: (1 - j*w*T)*(1 + j*w*T) = 1 + (w*T)**2."""
    time = 1e-3 * np.arange(4000)
    position, speed, rate = np.sin(3.0 * time), 3.0 * np.cos(3.0 * time), -9.0 * np.sin(3.0 * time)
    seen = {"position": position, "velocity": 0.7 * (speed - 5e-3 * rate) + 0.4}
    trace = Trace(time, seen, {"position": "rad", "velocity": "rad/s"}, "sine")
    ratio, lag, remainder = velocity.compared(Seen(trace))
    assert ratio == pytest.approx(0.7 * (1.0 + 0.015**2), rel=1e-5)
    assert lag == pytest.approx(5e-3, rel=1e-3)
    assert remainder < 1e-4


@pytest.mark.parametrize(
    ("jitter", "resampled", "status"),
    [
        (0.045, True, "pass"),
        (0.06, True, "warn"),
        (0.095, True, "warn"),
        (0.095, False, "pass"),
        (0.105, False, "fail"),
    ],
)
def test_jitter(jitter, resampled, status):
    """A sound grid of stamps one of which is off by a share of a period."""
    time = 1e-3 * np.arange(3000)
    time[1500] += jitter * 1e-3
    trace = Trace(time, {"velocity": np.sin(time)}, {"velocity": "rad/s"}, "stamps")
    if resampled:
        trace = Trace.from_arrays({"time": time, **trace.signals}, {"time": "s", **trace.units})
    assert timing.regular(Seen(trace, None)).status == status


@pytest.mark.parametrize(
    ("hertz", "turned", "status"), [(10.0, 3.1, "pass"), (10.0, 3.2, "fail"), (19.0, 3.2, "fail"), (21.0, 9.0, "pass")]
)
def test_below_twenty_hertz_half_a_turn_from_sample_to_sample_is_too_fast(hertz, turned, status):
    """A motion so slow that it is followed at any rate, at whose 95 % of speed the axis turns so far a sample."""
    time = np.arange(round(40.0 * hertz)) / hertz
    speed = np.sin(2.0 * np.pi * time / 60.0)
    speed *= turned * hertz / np.percentile(np.abs(speed), 95.0)
    found = timing.rate(Seen(Trace(time, {"velocity": speed}, {"velocity": "rad/s"}, "slow"), None))
    assert found.status == status
    assert ("from one sample to the next" in found.found) == (status == "fail")


@pytest.mark.parametrize(("motion", "status"), [(47.0, "fail"), (2.0, "pass")])
def test_a_motion_between_the_samples_is_missed_also_where_the_axis_turns_little(motion, status):
    """Speed and effort of a motion whose frequency wanders about: at 100 Hz one of 2 Hz is followed, one of 47 not."""
    rng, time = np.random.default_rng(0), 0.01 * np.arange(4000)
    phase = 2.0 * np.pi * motion * time + np.cumsum(0.1 * rng.normal(size=time.size))
    trace = Trace(time, {"velocity": np.sin(phase), "current": np.cos(phase)}, UNITS, "fast")
    found = timing.rate(Seen(trace, None))
    assert found.status == status
    assert ("of its spread" in found.found) == (status == "fail")
    noise_alone = changed(trace, current=np.sin(0.01 * time))
    assert timing.rate(Seen(noise_alone, None)).status == "pass"


UNITS = {"velocity": "rad/s", "current": "A", "position": "rad", "torque": "N*m"}
TIME = 1e-3 * np.arange(20000)
#: Of sines, never at rest for long.
SPEED = 20.0 * np.sin(7.0 * TIME) + 8.0 * np.sin(1.3 * TIME)
#: Of inertia and friction.
TORQUE = 0.01 * (140.0 * np.cos(7.0 * TIME) + 10.4 * np.cos(1.3 * TIME)) + 0.002 * SPEED


def axis(current, speed=SPEED, time=TIME):
    return Trace(time, {"velocity": speed, "current": current}, UNITS, "closed form")


@pytest.mark.parametrize(("samples", "status"), [(45, "pass"), (95, "warn"), (105, "fail")])
def test_a_sensor_may_stand_still_for_half_a_per_cent(samples, status):
    current = np.cos(7.0 * TIME) + 0.01 * np.random.default_rng(0).normal(size=TIME.size)
    fast = 9000 + int(np.argmax(np.abs(np.convolve(SPEED[9000:10000], np.ones(105), "valid"))))
    current[fast : fast + samples + 1] = current[fast]
    found = signals.moves(Seen(axis(current), None))
    assert found.status == status
    assert ("current stands still for" in found.found) == (status != "pass")


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_current_clipped_at_either_end_is_seen(side):
    bottom, top = sorted((side * 1.2, -side * 9.0))
    found = signals.clips(Seen(axis(np.clip(TORQUE, bottom, top)), None))
    assert found.status == "fail"
    assert f"exactly {side * 1.2:.4g} A" in found.found


@pytest.mark.parametrize(("share", "passes"), [(0.004, True), (0.006, False)])
def test_half_a_per_cent_of_all_samples_may_stand_at_the_end(share, passes):
    clipped = np.minimum(TORQUE, np.quantile(TORQUE, 1.0 - share))
    assert (signals.clips(Seen(axis(clipped), None)).status == "pass") == passes


@pytest.mark.parametrize(("more", "status"), [(0.04, "warn"), (0.07, "fail")])
def test_what_is_lost_is_where_the_motion_asks_for_five_per_cent_more(more, status):
    """A current that stands at 1 A while inertia alone asks for a share more."""
    plateau = np.where(np.sin(0.5 * TIME) > 0.6, 1.0 + more, 0.8 * np.sin(11.0 * TIME))
    speed = np.cumsum(plateau / 0.01) * 1e-3
    speed -= np.linspace(0.0, speed[-1], speed.size)
    assert signals.clips(Seen(axis(np.minimum(plateau, 1.0), speed), None)).status == status


@pytest.mark.parametrize(("noise", "status"), [(0.0, "pass"), (1e-3, "fail")])
def test_a_plateau_of_a_signal_without_noise_is_no_sensor_that_stands_still(noise, status):
    """At a steady speed between two ramps friction is one number; a noisy sensor shows none fifty times in a row."""
    time = TIME[:6000]
    speed = 10.0 * np.clip(2.5 - 3.0 * np.abs(time % 2.0 - 1.0), 0.0, 1.0) * np.sign(np.sin(0.5 * np.pi * time))
    current = 0.2 * speed + 0.02 * np.sign(speed) + 0.05 * np.gradient(speed, time)
    current += noise * np.random.default_rng(1).normal(size=6000)
    current[np.abs(time - 1.0) < 0.3] = current[1000]
    assert signals.moves(Seen(axis(current, speed, time))).status == status


def test_a_joint_that_stands_still_is_told_to_move_and_not_to_be_recorded_faster():
    rng, time = np.random.default_rng(3), 0.002 * np.arange(4000)
    levels = {"position": (0.3, 1e-4), "velocity": (0.0, 0.01), "torque": (0.5, 0.05)}
    recorded = {name: level + noise * rng.normal(size=4000) for name, (level, noise) in levels.items()}
    found = signals.moves(Seen(Trace(time, recorded, UNITS, "still")))
    assert (found.status, found.found) == ("fail", "position and velocity without any change but noise")
    assert "record while the axis moves" in found.advice


def test_a_sample_between_two_holes_has_no_speed(sound, rig):
    """Of position alone it takes two; the axis rests around them."""
    alone = np.r_[0:1000, 2000, 3000:4000]
    rest = {"position": np.zeros(alone.size), "current": np.zeros(alone.size)}
    trace = Trace(sound.time[alone], rest, UNITS, "at rest")
    assert signals.moves(Seen(trace, rig)).found == "position and current without any change"
