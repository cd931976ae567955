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


def test_a_first_order_lag_is_undone():
    """A ramp and a sine behind 1/(1 + T*s) come out as they were before it; the lagged ramp runs T behind."""
    lag, omega, smooth = 8e-3, 20.0, GaussianFilter(4e-3, PERIOD)
    time = np.arange(4000) * PERIOD
    gain, late = 1.0 / math.hypot(1.0, omega * lag), math.atan(omega * lag)
    behind = 2.0 + 5.0 * (time - lag) + gain * np.sin(omega * time - late)
    level, slope = smooth(behind, 0, 1, lag=lag)
    kept = time[smooth.margin : time.size - smooth.margin]
    held = math.exp(-0.5 * (omega * smooth.width) ** 2)
    assert level == pytest.approx(2.0 + 5.0 * kept + held * np.sin(omega * kept), abs=2e-4)
    assert slope == pytest.approx(5.0 + held * omega * np.cos(omega * kept), abs=0.02)


def test_columns_are_sums_of_their_terms():
    """q''*sin(q) = (q'*sin(q))' - q'**2*cos(q), with q = 3*t a ramp: (3*sin(3t))' - 9*cos(3t) = 0."""
    smooth, time = GaussianFilter(4e-3, PERIOD), np.arange(4000) * PERIOD
    angle, speed = 3.0 * time, np.full(time.size, 3.0)
    (found,) = smooth.columns([[(speed * np.sin(angle), 1), (-(speed**2) * np.cos(angle), 0)]])
    assert np.abs(found).max() < 2e-4


@pytest.mark.parametrize("samples", [997, 1200])
@pytest.mark.parametrize("stride", [1, 2, 4])
@pytest.mark.parametrize("order", [0, 1, 2])
def test_targets_sent_backwards_meet_raw_samples_as_they_meet_filtered_ones(samples, stride, order):
    rng, smooth, lag = np.random.default_rng(2), GaussianFilter(1.6e-3 * stride, PERIOD, stride), 4e-3
    walk = np.cumsum(rng.normal(size=samples))  # whose ends differ
    (filtered,) = smooth(walk, order, lag=lag)
    targets = rng.normal(size=(3, filtered.size))
    expected = targets @ filtered
    found = smooth.backwards(targets, samples, order, lag) @ walk
    assert found == pytest.approx(expected, rel=0.0, abs=1e-12 * np.linalg.norm(filtered) * np.sqrt(filtered.size))


def test_what_lies_six_widths_away_is_not_seen():
    smooth = GaussianFilter(10e-3, PERIOD, stride=2)
    assert smooth.margin == 60
    pulse = np.zeros(1001)
    pulse[500] = 1.0
    (found,) = smooth(pulse, 0)
    at = np.arange(smooth.margin, 1001 - smooth.margin, 2)
    assert np.abs(found[np.abs(at - 500) > 60]).max() < 1e-6 * found.max()
    assert found.max() == pytest.approx(PERIOD / (smooth.width * math.sqrt(2.0 * math.pi)), rel=1e-6)
