"""Mains pick-up belongs to the sensors: it is in every hypothesis of a recording, whatever effects are beside it."""

import numpy as np
import pytest

from bench.arrays import rms
from bench.diagnosis.model import Extension
from bench.diagnosis.policy import Policy
from bench.diagnosis.search import search
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hum import mains
from bench.fit.hypothesis import Hypothesis, Term
from tests.diagnosis.constructed import CONSTANT, RIG, bare, moved, recorded, wave

COGGING = catalogue()["cogging_torque"]
#: Amplitudes of the current's hum - A - and of cogging - N*m.
HUM, AMPLITUDE = 0.06, 0.03


@pytest.fixture(scope="module")
def humming():
    """Cogging recorded through a current sensor that picks up the mains."""

    def hum(motion):
        return CONSTANT * HUM * np.sin(2.0 * np.pi * 50.0 * motion.time + 0.3)

    return bare(recorded(moved(), wave(AMPLITUDE, 6.0), pick_up=hum))


def test_hum_stays_when_terms_go():
    both = Hypothesis((Term(COGGING, (6.0,)), Term(COGGING, (9.0,))), (50.0,))
    assert both.first(1).hum == both.first(0).hum == both.without(0).hum == both.with_terms(()).hum == (50.0,)
    assert both.plus(Term(COGGING, (4.0,))).hum == both.reshaped(0, (5.0,)).hum == (50.0,)


def test_steps_credit_an_effect_only_with_what_the_humming_axis_leaves(humming):
    """RMS before: cogging's as the filter passes it, and noise; hum would add (HUM*k_T)**2/2 to its square."""
    found = search(humming, [COGGING], Policy())
    assert found.last.hypothesis.hum == humming.hypothesis.hum != ()
    before, after = (stage.fitted for stage in Extension(humming.rows, found.last.hypothesis, {}, RIG).stages)
    smooth = humming.rows.conditioning.filter
    wave_rms = rms(humming.rows.table(lambda s: [[(AMPLITUDE * np.sin(6.0 * s.position), 0)]]))
    assert before.rms == pytest.approx(np.hypot(wave_rms, after.floor), rel=0.03)
    assert before.rms == pytest.approx(humming.rms)
    assert after.chi < 1.12
    passed = np.exp(-0.5 * (2.0 * np.pi * 50.0 * smooth.width) ** 2)
    with_hum = fit(humming.rows, Hypothesis()).rms
    assert with_hum == pytest.approx(np.hypot(before.rms, CONSTANT * HUM * passed / np.sqrt(2.0)), rel=0.05)
    assert with_hum > 1.3 * before.rms


@pytest.mark.parametrize("line", [50.0, 60.0, 100.0, 120.0, 150.0])
def test_lines_of_the_mains_and_their_multiples_are_found(humming, line):
    """A hundredth of a hertz off, as grids are."""
    rows, rng = humming.rows, np.random.default_rng(4)
    residual = np.sin(2.0 * np.pi * (line + 0.01) * rows.time) + 0.1 * rng.standard_normal(rows.time.size)
    assert mains(rows, residual) == pytest.approx((line,), abs=0.1)
