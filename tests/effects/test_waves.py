"""Waves of position along motion that outruns the samples."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.waves import followed
from bench.trace.filter import GaussianFilter
from tests.effects.recording import signals

PERIOD, WIDTH, NUMBER = 2e-3, 3e-3, 12.0


@pytest.mark.parametrize("acceleration", [180.0, 1000.0])
def test_a_wave_that_the_samples_cease_to_follow_passes_the_filter_as_little_as_a_whole_one(acceleration):
    """A sine of w passes with exp(-(w*width)**2/2); one that broke off passed with a hundred times as much."""
    time = np.arange(0.0, 360.0 / acceleration, PERIOD)
    position, velocity = 0.5 * acceleration * time**2, acceleration * time
    seen = followed(replace(signals(), velocity=velocity, sample_period=PERIOD), NUMBER)
    smooth = GaussianFilter(WIDTH, PERIOD)
    (passed,) = smooth.columns([[(seen * np.sin(NUMBER * position), 0)]])
    frequency = NUMBER * velocity[smooth.margin : time.size - smooth.margin]
    assert frequency[-1] > 2.0 * np.pi / PERIOD
    fast = frequency > 2.5 / WIDTH
    assert np.abs(passed[fast]).max() < np.exp(-0.5 * 2.5**2)
    assert np.abs(passed[frequency > 4.0 / WIDTH]).max() < 5e-3
