"""Names that later ones explain are let go, and the shapes of those that stay settle."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.policy import Policy
from bench.diagnosis.search import backward_elimination, settled, settled_elimination
from bench.effects.catalogue import catalogue
from bench.effects.rivals import RIVALS
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from tests.diagnosis.constructed import bare, moved, recorded

ECCENTRICITY, PHASE = 0.03, 0.8
#: sine and cosine of the error over angle - rad.
TRUE = ECCENTRICITY * np.cos(PHASE), ECCENTRICITY * np.sin(PHASE)


@pytest.fixture(scope="module")
def eccentric():
    """The bare axis where the encoder errs by e*sin(q + phi)."""
    motion = moved()
    trace = recorded(motion)
    error = ECCENTRICITY * np.sin(motion.position + PHASE)
    rate = ECCENTRICITY * np.cos(motion.position + PHASE) * motion.velocity
    signals = {
        **trace.signals,
        "position": trace.signals["position"] + error,
        "velocity": trace.signals["velocity"] + rate,
    }
    return bare(replace(trace, signals=signals))


def bent(bare, share, *beside):
    """An eccentricity of so much of the true one, and other effects."""
    shape = tuple(share * each for each in TRUE)
    return fit(bare.rows, Hypothesis((*beside, Term(catalogue()["encoder_eccentricity"], shape))))


def test_a_name_that_makes_up_for_the_shape_of_another_is_let_go(eccentric):
    """An inertia over position takes what an eccentric encoder leaves whose shape is bent to it."""
    found = bent(eccentric, 0.7, Term(catalogue()["position_dependent_inertia"], (1.0,)))
    assert backward_elimination(found, Policy()).hypothesis.names == found.hypothesis.names
    alone, _ = settled_elimination(found, Policy())
    assert alone.hypothesis.names == ("encoder_eccentricity",)
    assert alone.terms[0].shape == pytest.approx(TRUE, rel=0.02)


def test_what_stays_settles(eccentric):
    found = backward_elimination(bent(eccentric, 0.9, Term(catalogue()["torque_offset"])), Policy())
    assert found.hypothesis.names == ("encoder_eccentricity",)
    assert found.terms[0].shape == pytest.approx(TRUE, rel=0.02)


def test_what_no_catalogue_holds_stays_as_it_was_searched(eccentric):
    """A memory of milliseconds, none of those that are tried, leaves nothing and takes J along."""
    memory = Term(next(each for each in RIVALS if each.name == "outside_slow_memory"), (0.05,))
    found = fit(eccentric.rows, Hypothesis((memory,)))
    assert settled(found, Policy()) is found
