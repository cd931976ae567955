"""Noise that rounding leaves: its step, white where a signal wanders, lines where it runs evenly."""

import numpy as np
import pytest

from bench.arrays import rms
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis
from bench.fit.rows import Rows
from bench.trace.filter import GaussianFilter
from bench.trace.noise import common_step, rounding_spectrum
from bench.trace.trace import Trace
from tests.diagnosis.constructed import COULOMB, INERTIA, RIG, VISCOUS

PERIOD = 1e-3
SMOOTH = GaussianFilter(2e-3, PERIOD)


@pytest.mark.parametrize("step", [1e-6, 2.0 * np.pi / 2**20, 360.0 / 10000, 3.0])
def test_the_step_is_found_though_no_two_samples_are_neighbours(step):
    ticks = np.random.default_rng(0).integers(0, 10**6, 2000)
    assert common_step(ticks * step, 0.0) == pytest.approx(step, rel=1e-6)


def test_a_signal_that_takes_any_value_has_no_step():
    noisy = np.random.default_rng(0).normal(size=3000)
    assert common_step(noisy, 1e-6) == 0.0
    assert common_step(np.zeros(10), 0.0) == 0.0


def test_rounding_of_a_changing_speed_is_white_a_twelfth_of_a_square_step():
    time = np.arange(0.0, 20.0, PERIOD)
    way = 40.0 * np.sin(3.0 * time) + 11.0 * np.sin(17.0 * time)
    omega, power = rounding_spectrum([0.01 * np.round(way / 0.01)], SMOOTH, 0.01)
    band = (omega > 200.0) & (omega < 3000.0)
    assert np.mean(power[band]) == pytest.approx(0.01**2 / 12.0, rel=0.1)


@pytest.mark.parametrize("fraction", [0.03, 0.21, 0.47])
def test_rounding_of_a_steady_speed_is_a_line_where_its_fraction_of_a_step_folds_to(fraction):
    """The sawtooth's fundamental holds 6/pi**2 of its power."""
    ticks = np.round((5.0 + fraction) * np.arange(20000) + 0.3)
    omega, power = rounding_spectrum([ticks], SMOOTH, 1.0)
    frequency = omega / (2.0 * np.pi) * PERIOD
    assert frequency[np.argmax(power)] == pytest.approx(fraction, abs=3e-4)
    line = np.abs(frequency - fraction) < 2e-3
    assert np.sum(power[line]) / np.sum(power) == pytest.approx(6.0 / np.pi**2, abs=0.1)


@pytest.mark.parametrize("fraction", [0.031, 0.05])
def test_the_noise_floor_counts_the_lines_of_an_even_run(fraction):
    """An even run after a short start, its encoder's steps folded into the band of the filter."""
    step, cruise = 1e-4, 20.0
    cruise = (np.round(cruise * PERIOD / step) + fraction) * step / PERIOD
    time = np.arange(0.0, 8.0, PERIOD)
    turn = np.clip(time / 0.5, 0.0, 1.0)
    speed = cruise * (turn - np.sin(2.0 * np.pi * turn) / (2.0 * np.pi))
    angle = cruise * 0.5 * (0.5 * turn**2 - (1.0 - np.cos(2.0 * np.pi * turn)) / (4.0 * np.pi**2))
    angle += cruise * np.maximum(time - 0.5, 0.0)
    acceleration = np.where(time < 0.5, cruise / 0.5 * (1.0 - np.cos(2.0 * np.pi * turn)), 0.0)
    rng = np.random.default_rng(1)
    torque = INERTIA * acceleration + VISCOUS * speed + COULOMB + 2e-3 * rng.normal(size=time.size)
    values = {"position": step * np.round(angle / step), "current": torque / 0.7}
    rows = Rows.of(Trace(time, values, {"position": "rad", "current": "A"}, "even"), RIG)
    found = fit(rows, Hypothesis())
    assert 0.85 < found.chi < 1.15
    white = INERTIA * rows.conditioning.source_noise * rows.conditioning.filter.noise_gain(2)
    assert rms(found.residual) > 1.3 * np.hypot(white, 2e-3 * rows.conditioning.filter.noise_gain(0))


@pytest.mark.parametrize(("off", "step"), [(0.9e-3, 1.0), (1.1e-3, 0.0)])
def test_a_distance_within_a_thousandth_of_a_step_is_a_multiple_of_it(off, step):
    assert common_step(np.array([0.0, 1.0, 3.0 + off]), 0.1) == pytest.approx(step, rel=1e-9)
