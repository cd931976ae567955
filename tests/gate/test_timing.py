"""Times that are irregular, in another unit, or too far apart."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.gate import timing
from bench.gate.gate import UnanswerableError, passed
from bench.trace.trace import Trace
from tests.gate.damage import changed, keeping, with_samples


def test_times_that_jitter_are_reported_and_irregular_ones_refused(sound, rig):
    rng = np.random.default_rng(0)
    jittering = sound.time + rng.uniform(-2e-4, 2e-4, len(sound))
    read = Trace.from_arrays({"time": jittering, **sound.signals}, {"time": "s", **sound.units})
    assert timing.regular(read, rig)[1].status == "warn"
    raw = Trace(jittering, sound.signals, sound.units, sound.origin)
    assert timing.regular(raw, rig)[1].status == "fail"


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
    found = timing.rate(changed(alone, velocity=1e-3 * sound["velocity"]), rig)[1]
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
    assert timing.rate(noisy, rig)[1].status == "pass"
