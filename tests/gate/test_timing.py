"""Times that are irregular, in another unit, or too far apart."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.gate import timing
from bench.gate.check import Seen
from bench.gate.gate import UnanswerableError, passed
from bench.trace.trace import Trace
from tests.gate.damage import changed, keeping, with_samples


def test_times_that_jitter_are_reported_and_irregular_ones_refused(sound, rig):
    rng = np.random.default_rng(0)
    jittering = sound.time + rng.uniform(-2e-4, 2e-4, len(sound))
    read = Trace.from_arrays({"time": jittering, **sound.signals}, {"time": "s", **sound.units})
    assert timing.regular(Seen(read, rig)).status == "warn"
    raw = Trace(jittering, sound.signals, sound.units, sound.origin)
    assert timing.regular(Seen(raw, rig)).status == "fail"


@pytest.mark.parametrize(
    "names", [("velocity", "current"), ("position", "velocity", "current"), ("position", "current")]
)
@pytest.mark.parametrize("factor", [1e3, 1e-3, 1e6])
def test_another_unit_of_time_is_refused(sound, rig, names, factor):
    every = np.arange(len(sound))
    with pytest.raises((InputError, UnanswerableError), match=r"unit of (the )?time"):
        passed(with_samples(keeping(sound, names), every, factor * sound.sample_period), rig)


def test_an_axis_thousands_of_times_as_heavy_as_its_rotor_is_refused(sound, rig):
    alone = keeping(sound, ["velocity", "current"])
    found = timing.rate(Seen(changed(alone, velocity=1e-3 * sound["velocity"]), rig))
    assert found.status == "fail"
    assert "times the motor's own" in found.found


@pytest.mark.parametrize("names", [("velocity", "current"), ("position", "velocity", "current")])
def test_ten_hertz_are_too_slow_for_a_fast_motion(sound, rig, names):
    every = np.arange(0, len(sound), 100)
    repeated = np.tile(every, 20)  # long enough to be judged
    slow = keeping(with_samples(sound, repeated, 0.1), names)
    with pytest.raises((InputError, UnanswerableError)):
        passed(slow, rig)


def test_noise_of_the_speed_is_no_undersampling(sound, rig):
    rng = np.random.default_rng(0)
    noisy = changed(sound, velocity=sound["velocity"] + rng.normal(scale=200.0, size=len(sound)))
    assert timing.rate(Seen(noisy, rig)).status == "pass"


def stamped(jitter, resampled):
    """A sound grid of stamps one of which is off by a share of a period."""
    time = 1e-3 * np.arange(3000)
    time[1500] += jitter * 1e-3
    signals, units = {"velocity": np.sin(time)}, {"velocity": "rad/s"}
    if resampled:
        return Trace.from_arrays({"time": time, **signals}, {"time": "s", **units})
    return Trace(time, signals, units, "stamps")


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
def test_jitter_is_judged_by_its_borders(jitter, resampled, status):
    assert timing.regular(Seen(stamped(jitter, resampled), None)).status == status


def turning(hertz, turned, period=60.0):
    """A motion so slow that it is followed at any rate, at whose 95 % of speed the axis turns so far a sample."""
    time = np.arange(round(40.0 * hertz)) / hertz
    speed = np.sin(2.0 * np.pi * time / period)
    speed *= turned * hertz / np.percentile(np.abs(speed), 95.0)
    return Trace(time, {"velocity": speed}, {"velocity": "rad/s"}, "slow")


@pytest.mark.parametrize(
    ("hertz", "turned", "status"), [(10.0, 3.1, "pass"), (10.0, 3.2, "fail"), (19.0, 3.2, "fail"), (21.0, 9.0, "pass")]
)
def test_below_twenty_hertz_half_a_turn_from_sample_to_sample_is_too_fast(hertz, turned, status):
    found = timing.rate(Seen(turning(hertz, turned), None))
    assert found.status == status
    assert ("from one sample to the next" in found.found) == (status == "fail")


@pytest.mark.parametrize(("motion", "status"), [(47.0, "fail"), (2.0, "pass")])
def test_a_motion_between_the_samples_is_missed_also_where_the_axis_turns_little(motion, status):
    """Speed and effort of a motion whose frequency wanders about: at 100 Hz one of 2 Hz is followed, one of 47 not."""
    rng, time = np.random.default_rng(0), 0.01 * np.arange(4000)
    phase = 2.0 * np.pi * motion * time + np.cumsum(0.1 * rng.normal(size=time.size))
    signals = {"velocity": np.sin(phase), "current": np.cos(phase)}
    found = timing.rate(Seen(Trace(time, signals, {"velocity": "rad/s", "current": "A"}, "fast"), None))
    assert found.status == status
    if status == "fail":
        assert "of its spread" in found.found
        steady = changed(Trace(time, signals, {"velocity": "rad/s", "current": "A"}, "x"), current=np.sin(0.01 * time))
        assert timing.rate(Seen(steady, None)).status == "pass"  # noise of the speed alone
