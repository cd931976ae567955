import math

import numpy as np
import pytest

from bench.trace.noise import resolution, varying_noise, white_noise


def test_white_noise_is_found_under_a_servo_motion():
    time = np.arange(20_000) * 1e-3
    motion = 100.0 * np.clip(3.0 * np.sin(2.0 * time), -1.0, 1.0)
    noise = np.random.default_rng(0).normal(scale=0.03, size=time.size)
    assert white_noise(motion + noise) == pytest.approx(0.03, rel=0.07)


def test_events_do_not_pass_for_noise():
    values = np.random.default_rng(1).normal(size=50_000)
    values[::1000] += 100.0
    assert white_noise(values) == pytest.approx(1.0, rel=0.05)


def test_quantisation_counts_as_white_noise():
    dither = np.random.default_rng(2).normal(scale=0.3, size=50_000)
    motion = 2000.0 * np.sin(np.arange(50_000) * 1.7e-3) + dither
    assert white_noise(np.round(motion)) == pytest.approx(math.hypot(1.0 / math.sqrt(12.0), 0.3), rel=0.05)


def test_shorter_windows_are_taken_where_stretches_are_short():
    """Stretches of 40 samples hold a window of 32 and none of 64; two more samples go into the second differences."""
    rng = np.random.default_rng(4)
    assert white_noise(*rng.normal(scale=0.2, size=(400, 40))) == pytest.approx(0.2, rel=0.05)
    assert white_noise(rng.normal(size=33)) == white_noise(np.zeros(100)) == 0.0 < white_noise(rng.normal(size=34))


def test_noise_of_a_ramp_is_that_of_its_samples_and_scales_with_them():
    noise = np.random.default_rng(5).normal(size=20_000)
    alone = white_noise(noise)
    assert alone == pytest.approx(1.0, rel=0.03)
    assert white_noise(3.0 * noise + 1e3 * np.arange(20_000)) == pytest.approx(3.0 * alone, rel=1e-9)


def test_windows_that_stand_still_hide_their_noise():
    values = np.random.default_rng(6).normal(size=20_000)
    values[:15_000] = 0.0
    assert white_noise(values) == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize(("levels", "step"), [(25, 0.5), (26, 0.0)])
def test_a_step_is_found_where_each_value_occurs_four_times_on_average(levels, step):
    values = 0.5 * (np.arange(100) % levels)
    assert resolution(values) == step


def test_a_missing_level_does_not_double_the_step():
    assert resolution(np.repeat([0.0, 0.5, 1.0, 2.5, 3.0], 4)) == 0.5


def test_the_median_of_a_mean_of_few_values_is_put_right():
    """Of windows of 32 the top holds five values, correlated: without that their median would seem 3.4 % higher."""
    stretches = np.random.default_rng(7).normal(size=(20_000, 34))
    assert white_noise(*stretches) == pytest.approx(1.0, rel=0.012)


def test_noise_that_grows_with_the_motion_counts_by_its_mean_square():
    """Of a deviation that rises from 1 to 3 the mean square is 13/3, the median of squares 4; jerks do not count."""
    rng, size = np.random.default_rng(5), np.linspace(1.0, 3.0, 60_000)
    values = size * rng.standard_normal(size.size)
    assert varying_noise(values) == pytest.approx(math.sqrt(13.0 / 3.0), rel=0.02)
    jerky = values + np.cumsum(300.0 * (np.arange(size.size) % 10_000 == 5_000))
    assert varying_noise(jerky) == pytest.approx(varying_noise(values), rel=0.02)
    assert varying_noise(np.zeros(5)) == 0.0
