"""An eccentric encoder: velocity is the derivative of position, and both can be undone."""

import numpy as np
import pytest

from bench.effects.encoder_eccentricity import EFFECT
from bench.fit.fit import fit
from bench.fit.hypothesis import Term
from tests.diagnosis.constructed import bare, moved, recorded

VALUES = {"amplitude": 0.05, "phase": 0.9}


def proposed(stiffness):
    """The bare fit of an eccentric axis on a spring - N*m/rad -, and what is proposed beside it."""
    motion = moved(5.0, drift=3.0)
    trace = recorded(motion, lambda motion: stiffness * motion.position)
    position, velocity = EFFECT.measured(VALUES, motion.position, motion.velocity)
    wrong = {
        "position": trace["position"] + position - motion.position,
        "velocity": trace["velocity"] + velocity - motion.velocity,
    }
    fitted = bare(trace.with_signals(wrong, {"position": "rad", "velocity": "rad/s"}))
    return fitted, EFFECT.propose(fitted)


def test_it_is_proposed_as_it_is():
    _, (found,) = proposed(0.0)
    sine, cosine = found.shape
    assert np.hypot(sine, cosine) == pytest.approx(VALUES["amplitude"], rel=0.02)
    assert np.arctan2(cosine, sine) == pytest.approx(VALUES["phase"], abs=0.02)


def test_an_inertia_that_another_effect_takes_makes_no_eccentricity():
    """A spring of 0.2 N*m/rad turns the sign of a bare J, by which the encoder would err by 3 rad."""
    fitted, found = proposed(0.2)
    assert fitted.base.inertia < 0.0
    assert max(np.hypot(*each.shape) for each in found) <= EFFECT.quantities[0].upper
    for each in found:
        saved = fitted.squares - fit(fitted.rows, fitted.hypothesis.plus(Term(EFFECT, each.shape))).squares
        assert each.gain == pytest.approx(saved)
