"""Laws of the filter: exact on sines, even, known gain for noise, nothing beyond its reach."""

import math

import numpy as np
import pytest

from bench.trace.filter import GaussianFilter

PERIOD = 1e-3


@pytest.mark.parametrize("stride", [1, 2, 3])
@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_sine_comes_out_in_phase_and_with_the_gaussian_gain(stride, order):
    smooth, omega = GaussianFilter(5e-3, PERIOD, stride), 30.0
    time = np.arange(3001) * PERIOD
    (found,) = smooth(np.sin(omega * time), order)
    kept = time[smooth.margin : time.size - smooth.margin : stride]
    gain = omega**order * math.exp(-0.5 * (omega * smooth.width) ** 2)
    expected = gain * np.sin(omega * kept + order * math.pi / 2.0)
    assert found == pytest.approx(expected, abs=2e-5 * omega**order)


def test_a_ramp_keeps_its_slope_and_a_constant_stays():
    smooth = GaussianFilter(4e-3, PERIOD)
    level, slope = smooth(3.0 + 7.0 * np.arange(2000) * PERIOD, 0, 1)
    kept = np.arange(smooth.margin, 2000 - smooth.margin) * PERIOD
    assert level == pytest.approx(3.0 + 7.0 * kept, abs=1e-6)
    assert slope == pytest.approx(np.full(kept.size, 7.0), abs=1e-3)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_noise_gain_is_what_white_noise_shows(order):
    smooth = GaussianFilter(3e-3, PERIOD)
    (found,) = smooth(np.random.default_rng(1).normal(size=200_000), order)
    assert np.std(found) == pytest.approx(smooth.noise_gain(order), rel=0.02)


def test_smoothed_noise_and_its_derivative_are_uncorrelated():
    level, slope = GaussianFilter(3e-3, PERIOD)(np.random.default_rng(2).normal(size=200_000), 0, 1)
    assert abs(np.corrcoef(level, slope)[0, 1]) < 0.01


def test_thinning_drops_rows_and_changes_none():
    values = np.cumsum(np.random.default_rng(3).normal(size=4000))
    full = GaussianFilter(9e-3, PERIOD)
    thin = GaussianFilter(9e-3, PERIOD, stride=3)
    (every,), (third,) = full(values, 0), thin(values, 0)
    first = thin.margin - full.margin
    assert third == pytest.approx(every[first::3][: third.size], abs=1e-4 * np.ptp(values))


def test_from_cutoff_halves_the_power_there():
    smooth = GaussianFilter.from_cutoff(40.0, PERIOD)
    gain = math.exp(-0.5 * (2.0 * math.pi * 40.0 * smooth.width) ** 2)
    assert gain**2 == pytest.approx(0.5)
    assert smooth.cutoff == pytest.approx(40.0)


def test_a_cutoff_beyond_the_sampling_is_bounded():
    smooth = GaussianFilter.from_cutoff(1e6, PERIOD)
    assert smooth.width == pytest.approx(1.5 * PERIOD)
    assert smooth.stride == 1
