"""What the last digit of a coarse current does to a torque balance, against the digit it was made with."""

from dataclasses import replace

import numpy as np
import pytest

from bench.fit.fit import fit
from bench.fit.hypothesis import DIGIT, Hypothesis, plain
from bench.fit.identify import identify
from bench.fit.rows import Rows
from bench.fit.solution import cut_beforehand, rounding
from bench.trace.noise import resolution
from bench.trace.trace import Trace
from tests.diagnosis.constructed import CONSTANT, COULOMB, INERTIA, RIG, SPEED_NOISE, UNITS, VISCOUS, moved

STEP = 0.05


def recorded(digit):
    """A plain axis whose current, with little noise of its own, passes a digit - A."""
    motion, rng = moved(6.0), np.random.default_rng(4)
    torque = INERTIA * motion.acceleration + VISCOUS * motion.velocity + COULOMB * motion.sign
    current = digit(torque / CONSTANT + 2e-3 * rng.normal(size=torque.size))
    speed = motion.velocity + SPEED_NOISE * rng.normal(size=torque.size)
    return Trace(motion.time, {"velocity": speed, "current": current}, UNITS, "coarse")


def rounded(current):
    return STEP * np.round(current / STEP)


def cut_off(current):
    return STEP * np.trunc(current / STEP)


def test_resolution_is_the_step_of_what_repeats_and_none_of_what_does_not():
    wave = 3.0 * np.sin(0.01 * np.arange(5000))
    assert resolution(rounded(wave)) == pytest.approx(STEP)
    assert resolution(rounded(wave[wave > 0.5])) == pytest.approx(STEP)
    assert resolution(wave + np.random.default_rng(0).normal(size=5000)) == 0.0
    assert resolution(np.ones(100)) == 0.0


@pytest.mark.parametrize(("digit", "missing"), [(rounded, 0.0), (cut_off, 0.5)])
def test_what_was_cut_off_is_found_and_noise_explains_the_rest(digit, missing):
    rows = Rows.of(recorded(digit), RIG)
    hypothesis = plain(rows)
    assert hypothesis.step == pytest.approx(STEP * CONSTANT)
    found = fit(rows, hypothesis)
    (cut,) = found.theta[found.owners == DIGIT]
    assert cut == pytest.approx(missing * STEP * CONSTANT, abs=0.1 * STEP * CONSTANT)
    assert 0.6 < found.chi < 1.12
    by_identify = identify(recorded(digit), RIG).parameters["moment_of_inertia"]
    assert [found.base.inertia, by_identify.value] == pytest.approx([INERTIA] * 2, rel=5e-3)


def test_without_it_a_cut_off_passes_for_something_of_the_axis():
    rows = Rows.of(recorded(cut_off), RIG)
    bare = fit(rows, Hypothesis())
    assert bare.chi > 1.12
    assert abs(bare.base.inertia / INERTIA - 1.0) > 5e-3


def test_a_fine_current_has_no_digit_that_matters():
    assert plain(Rows.of(recorded(lambda current: current), RIG)).step == 0.0


@pytest.mark.parametrize(("dither", "left"), [(0.0, 1.0), (0.25, 0.29121), (0.15, 0.64138)])
def test_noise_over_the_steps_leaves_its_characteristic_function_of_what_rounding_adds(dither, left):
    """exp(-2*(pi*s/q)**2) of it at a deviation s of the noise beside that of the rounding itself, q**2/12."""
    rows, step = Rows.of(recorded(rounded), RIG), STEP * CONSTANT
    loud = replace(rows.conditioning, effort_noise=step * np.sqrt(1.0 / 12.0 + dither**2))
    quiet = replace(rows.conditioning, effort_noise=0.5 * step / np.sqrt(12.0))
    modelled = 3.0 * step * np.sin(3.0 * rows.time)
    whole = rounding(replace(rows, conditioning=quiet), step, modelled, 0.0)
    assert whole > 0.05 * step
    assert rounding(replace(rows, conditioning=loud), step, modelled, 0.0) == pytest.approx(left * whole, rel=1e-4)


def test_what_is_cut_off_is_evenly_spread_over_half_a_step():
    assert cut_beforehand(0.4) == pytest.approx((0.1, 0.2**2 / 12.0))


@pytest.mark.parametrize(("step", "seen"), [(0.2 * 0.999, False), (0.2 * 1.001, True)])
def test_a_digit_matters_from_a_tenth_of_the_noise_on(step, seen):
    rows = Rows.of(recorded(lambda current: current), RIG)
    noise = rows.conditioning.effort_noise * rows.conditioning.filter.noise_gain(0)
    stepped = replace(rows, conditioning=replace(rows.conditioning, effort_step=step * noise))
    assert (plain(stepped).step > 0.0) == seen
