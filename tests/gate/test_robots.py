"""What robots' logs are refused for, by its true reason: no sign, no sample period, a joint that stands."""

import numpy as np
import pytest

from bench.gate.gate import UnanswerableError, gate, passed
from bench.rig.rig import Rig
from bench.trace.choose import GivenOptions
from bench.trace.read import read_recording
from bench.trace.trace import Trace, assemble
from tests.shared import SHARED, needs_shared

RIG = Rig.of({"name": "joint", "kind": "rotary"})


def joint(period=0.01, duration=40.0, seed=0, torque=lambda values: values, time=None, gravity=0.0):
    """A joint along two sines: inertia, friction, and perhaps gravity, in closed form with noise of the sensors."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(duration / period)) * period if time is None else time
    q, w, a = (
        np.imag(
            sum(size * (1j * f) ** k * np.exp(1j * (f * time + p)) for size, f, p in ((0.8, 1.9, 0.0), (0.2, 7.1, 1.0)))
        )
        for k in range(3)
    )
    made = torque(0.05 * a + 0.1 * w + 0.2 * np.sign(w) + gravity * np.sin(q) + 0.01 * rng.standard_normal(time.size))
    columns = {"time [s]": time, "position [rad]": q, "velocity [rad/s]": w + 1e-3 * rng.standard_normal(time.size)}
    return Trace.from_arrays({**columns, "torque [N*m]": made})


def check(trace, name):
    return next(one for one in gate(trace, RIG).checks if one.name == name)


@pytest.mark.parametrize("fold", [np.abs, lambda values: -np.abs(values)], ids=["positive", "negative"])
def test_a_torque_without_its_sign_is_reported_as_that(fold):
    found = check(joint(torque=fold), "effort_has_a_sign")
    assert found.status == "fail" and "its sign is lost" in found.advice
    with pytest.raises(UnanswerableError, match="effort_has_a_sign: torque is never"):
        passed(joint(torque=fold), RIG)


def test_what_holds_a_load_up_has_a_sign():
    """Of one sign all the time, and near zero now and then: a load on a rope, which does not push."""
    held = joint(torque=lambda values: np.maximum(values + 0.75, 0.0))
    assert np.mean(held["torque"] < 0.03 * held["torque"].max()) > 0.01
    assert [check(one, "effort_has_a_sign").status for one in (held, joint())] == ["pass"] * 2


@needs_shared
@pytest.mark.parametrize("axis", "024")
def test_the_load_register_of_a_small_servo_without_its_sign_bit(axis):
    """Not `opposite signs`, nor a rate: no sign before the torque would help."""
    recording = read_recording(SHARED / "data" / "robots" / "so101" / "velocity_ramp.state_motor.csv.gz")
    words = {"position": ("positions", "rad"), "velocity": ("velocities", "rad/s"), "torque": ("torques", "N*m")}
    columns = {name: f"{word}[{axis}] [{unit}]" for name, (word, unit) in words.items()}
    with pytest.raises(UnanswerableError, match="effort_has_a_sign: torque is never below 0, and at 0"):
        passed(assemble(recording, GivenOptions({**columns, "time": "timestamp [us]"})), RIG)


def test_irregular_times_are_called_so_and_no_lost_samples():
    """Steps of 0.02 to 0.28 s: there is no time that runs on evenly, and nothing that was lost from it."""
    steps = np.random.default_rng(3).uniform(0.02, 0.28, 1500)
    uneven = joint(time=np.cumsum(steps))
    found = check(uneven, "time_is_regular")
    assert found.status == "fail"
    low, high = (float(word) for word in found.found.split()[2:5:2])
    assert (low, high) == pytest.approx((0.046, 0.254), rel=0.1)
    assert check(uneven, "lost_samples").status == "not_applicable"


def test_a_clock_that_jitters_a_little_still_shows_losses_and_holes_are_no_irregular_time():
    rng, time = np.random.default_rng(1), np.arange(4000) * 0.01
    jittering = joint(time=time + rng.uniform(-1e-4, 1e-4, 4000))
    assert {check(jittering, name).status for name in ("time_is_regular", "lost_samples")} == {"pass"}
    kept = np.ones(4000, dtype=bool)
    kept[rng.integers(100, 3900, 40)[:, None] + np.arange(5)] = False
    assert check(joint(time=time[kept]), "time_is_regular").status in ("pass", "warn")


def test_a_motion_sampled_too_coarsely_is_reported_as_that():
    """At 2.5 Hz position and speed do not agree, for the reason that the rate has."""
    coarse = joint(period=0.4, duration=240.0)
    assert check(coarse, "velocity_is_derivative_of_position").status == "not_applicable"
    with pytest.raises(UnanswerableError, match=r"sampling_rate_plausible: 2\.5 Hz"):
        passed(coarse, RIG)


def test_a_joint_that_creeps_is_reported_as_that():
    """Its torque follows what others ask of it, within what its friction holds."""
    rng, time = np.random.default_rng(0), np.arange(6000) * 5e-3
    slow = {"position [rad]": 0.01 * np.sin(0.4 * time), "velocity [rad/s]": 0.004 * np.cos(0.4 * time)}
    held = 0.5 * np.sin(1.7 * time) + 0.2 * np.sin(4.1 * time) + 0.01 * rng.standard_normal(time.size)
    with pytest.raises(UnanswerableError, match=r"moves at 0.0028 rad/s RMS.*the joint stands still or creeps"):
        passed(Trace.from_arrays({"time [s]": time, **slow, "torque [N*m]": held}), RIG)
