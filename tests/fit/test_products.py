"""Intervals where dry frictions multiply: a strength changes the columns of others, too."""

from functools import partial

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.fit import fit, together
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.quantities import strengths_are_sure, uncertain
from bench.fit.rows import Rows
from tests.diagnosis.constructed import COULOMB, RIG, moved, recorded

RISE, SPEED, AMPLITUDE = 0.06, 6.0, 1.5
MOTION = moved(4.0)


def frictions(duration, motion):
    """Coulomb friction with a Stribeck rise, which decays as the axis warms up; less the Coulomb friction alone."""
    level = COULOMB * motion.sign + RISE * motion.sign * np.exp(-((motion.velocity / SPEED) ** 2))
    return level * (1.0 + AMPLITUDE * np.exp(-motion.time / duration)) - COULOMB * motion.sign


def fitted(duration, seed):
    effects = [Term(catalogue()["stribeck_friction"], (SPEED,)), Term(catalogue()["friction_warmup"], (duration,))]
    trace = recorded(MOTION, partial(frictions, duration), seed=seed, noise=0.3)
    return fit(Rows.of(trace, RIG), Hypothesis((*effects,)))


def test_scatter_of_the_levels_is_what_their_intervals_say():
    found = [uncertain(together(fitted(2.0, seed))) for seed in range(16)]
    places = [int(np.flatnonzero(found[0].fitted.owners == name)[0]) for name in ("coulomb", 0, 1)]
    scatter = np.std([each.values[places] for each in found], axis=0, ddof=1)
    said = np.sqrt(np.mean([np.diag(each.covariance)[places] for each in found], axis=0))
    assert scatter / said == pytest.approx(np.ones(3), abs=0.42)


def test_friction_that_decays_longer_than_the_recording_lasts_is_sure_without_its_size():
    """Of a decay over 40 s, 6 s show the beginning: not to what friction it decays, which its amplitude counts in."""
    slow = fitted(40.0, 0)
    (amplitude, *_), numbers = slow.strengths(1), uncertain(slow)
    size = numbers.quantities(1, lambda *_: "")["relative_amplitude"]
    assert amplitude > 0.0
    assert size.ci95[0] < 0.0
    assert strengths_are_sure(slow)[slow.owners == 1][0]


def test_damping_of_bristles_at_its_bound_of_zero_has_an_interval():
    """Bristles without damping: noise may take it to the bound, where no other bound says how large it is at most."""
    bristles = catalogue()["presliding_friction"]
    held = next(
        one
        for seed in range(12)
        if (one := fit(Rows.of(recorded(MOTION, seed=seed), RIG), Hypothesis((Term(bristles, (60.0,)),)))).held
        if one.held[-1] == one.theta.size - 1
    )
    assert held.theta[-1] == 0.0
    assert uncertain(held).covariance[held.theta.size - 1, held.theta.size - 1] > 0.0
