"""Signals that stand still, are clipped, or come in coarse steps."""

import numpy as np
import pytest

from bench.gate import signals
from bench.gate.check import Seen
from bench.gate.gate import UnanswerableError, gate, passed
from bench.trace.trace import Trace
from tests.gate.damage import changed


def test_a_current_that_never_changes_is_refused(sound, rig):
    with pytest.raises(UnanswerableError, match=r"signal_moves.*current.*record instead") as refused:
        passed(changed(sound, current=np.full(len(sound), 0.3)), rig)
    assert [check.name for check in refused.value.checks] == [check.name for check in gate(sound, rig).checks]


@pytest.mark.parametrize("name", ["position", "velocity", "current"])
def test_a_sensor_that_stands_still_while_the_axis_moves_is_refused(sound, rig, name):
    moving = int(np.argmax(np.convolve(np.abs(sound["velocity"]), np.ones(200), "valid")))
    stuck = sound[name].copy()
    stuck[moving : moving + 200] = stuck[moving]
    assert signals.moves(Seen(changed(sound, **{name: stuck}), rig)).status == "fail"


def test_a_drive_switched_off_is_no_frozen_current(sound, rig):
    coasting = sound["current"].copy()
    coasting[2000:2300] = 0.0
    assert signals.moves(Seen(changed(sound, current=coasting), rig)).status == "pass"


def test_a_sample_between_two_holes_has_no_speed(sound, rig):
    """Of position alone it takes two; the axis rests around them."""
    alone = np.r_[0:1000, 2000, 3000:4000]
    rest = {"position": np.zeros(alone.size), "current": np.zeros(alone.size)}
    trace = Trace(sound.time[alone], rest, {"position": "rad", "current": "A"}, "at rest")
    assert signals.moves(Seen(trace, rig)).found == "position and current without any change"


def test_a_current_clipped_by_its_sensor_is_refused(sound, rig):
    limit = 0.4 * np.abs(sound["current"]).max()
    clipped = changed(sound, current=np.clip(sound["current"], -limit, limit))
    found = signals.clips(Seen(clipped, rig))
    assert found.status == "fail"
    assert f"exactly {limit:.4g} A" in found.found or f"exactly {-limit:.4g} A" in found.found


def test_a_current_at_the_drives_own_limit_is_true(sound, rig):
    limit = rig.motor.peak_current
    driven = np.where(np.arange(len(sound)) % 50 < 10, limit, np.minimum(sound["current"], 0.9 * limit))
    assert signals.clips(Seen(changed(sound, current=driven), rig)).status == "pass"


@pytest.mark.parametrize(("steps", "status"), [(0.5, "fail"), (4.0, "warn"), (50.0, "pass")])
def test_coarse_steps_are_reported(sound, rig, steps, status):
    step = np.std(sound["current"]) / steps
    rounded = changed(sound, current=np.round(sound["current"] / step) * step)
    assert signals.resolution(Seen(rounded, rig)).status == status


TIME = 1e-3 * np.arange(20000)


def turning(current, noise=0.0):
    """An axis that turns by sines of its speed, never at rest for long, and a current."""
    speed = 20.0 * np.sin(7.0 * TIME) + 8.0 * np.sin(1.3 * TIME)
    loud = noise * np.random.default_rng(0).normal(size=TIME.size)
    return Trace(TIME, {"velocity": speed, "current": current + loud}, {"velocity": "rad/s", "current": "A"}, "sines")


@pytest.mark.parametrize(("samples", "status"), [(45, "pass"), (95, "warn"), (105, "fail")])
def test_a_sensor_may_stand_still_for_half_a_per_cent(samples, status):
    trace = turning(np.cos(7.0 * TIME), noise=0.01)
    fast = 9000 + int(np.argmax(np.abs(np.convolve(trace["velocity"][9000:10000], np.ones(105), "valid"))))
    stuck = trace["current"].copy()
    stuck[fast : fast + samples + 1] = stuck[fast]
    found = signals.moves(Seen(changed(trace, current=stuck), None))
    assert found.status == status
    assert ("current stands still for" in found.found) == (status != "pass")


def clipped(top, bottom):
    """Torque of inertia and friction in closed form, cut off at both ends."""
    speed = 20.0 * np.sin(7.0 * TIME) + 8.0 * np.sin(1.3 * TIME)
    rate = 140.0 * np.cos(7.0 * TIME) + 10.4 * np.cos(1.3 * TIME)
    return turning(np.clip(0.01 * rate + 0.002 * speed, bottom, top))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_current_clipped_at_either_end_is_seen(side):
    top, bottom = (1.2, -9.0) if side > 0.0 else (9.0, -1.2)
    found = signals.clips(Seen(clipped(top, bottom), None))
    assert found.status == "fail"
    assert f"exactly {side * 1.2:.4g} A" in found.found


@pytest.mark.parametrize(("share", "status"), [(0.004, "pass"), (0.006, "fail")])
def test_half_a_per_cent_of_all_samples_may_stand_at_the_end(share, status):
    whole = clipped(9.0, -9.0)["current"]
    top = np.quantile(whole, 1.0 - share)
    assert (signals.clips(Seen(clipped(top, -9.0), None)).status == "pass") == (status == "pass")


@pytest.mark.parametrize(("more", "status"), [(0.04, "warn"), (0.07, "fail")])
def test_what_is_lost_is_where_the_motion_asks_for_five_per_cent_more(more, status):
    """A current that stands at 1 A while inertia alone asks for a share more."""
    asked = 1.0 + more
    plateau = np.where(np.sin(0.5 * TIME) > 0.6, asked, 0.8 * np.sin(11.0 * TIME))
    speed = np.cumsum(plateau / 0.01) * 1e-3
    seen = {"velocity": speed - np.linspace(0.0, speed[-1], speed.size), "current": np.minimum(plateau, 1.0)}
    trace = Trace(TIME, seen, {"velocity": "rad/s", "current": "A"}, "plateaus")
    assert signals.clips(Seen(trace, None)).status == status


def test_a_joint_that_stands_still_is_told_to_move_and_not_to_be_recorded_faster():
    rng, time = np.random.default_rng(3), 0.002 * np.arange(4000)
    recorded = {
        "position": 0.3 + 1e-4 * rng.normal(size=time.size),
        "velocity": 0.01 * rng.normal(size=time.size),
        "torque": 0.5 + 0.05 * rng.normal(size=time.size),
    }
    still = Trace(time, recorded, {"position": "rad", "velocity": "rad/s", "torque": "N*m"}, "still")
    found = signals.moves(Seen(still))
    assert (found.status, found.found) == ("fail", "position and velocity without any change but noise")
    assert "record while the axis moves" in found.advice


@pytest.mark.parametrize(("noise", "status"), [(0.0, "pass"), (1e-3, "fail")])
def test_a_plateau_of_a_signal_without_noise_is_no_sensor_that_stands_still(noise, status):
    """At a steady speed between two ramps friction is one number; a noisy sensor shows none fifty times in a row."""
    time = 0.001 * np.arange(6000)
    velocity = 10.0 * np.clip(2.5 - 3.0 * np.abs(time % 2.0 - 1.0), 0.0, 1.0) * np.sign(np.sin(0.5 * np.pi * time))
    current = 0.2 * velocity + 0.02 * np.sign(velocity) + noise * np.random.default_rng(1).normal(size=6000)
    current += 0.05 * np.gradient(velocity, time)
    plateau = np.abs(time - 1.0) < 0.3
    current[plateau] = current[1000]
    recorded = {"velocity": velocity, "current": current}
    trace = Trace(time, recorded, {"velocity": "rad/s", "current": "A"}, "plateau")
    assert signals.moves(Seen(trace)).status == status
