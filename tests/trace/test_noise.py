import math

import numpy as np
import pytest

from bench.trace.noise import white_noise


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


def test_a_signal_shorter_than_a_window_has_no_known_noise():
    assert white_noise(np.zeros(100)) == 0.0
