"""Effects are added one by one and judged by motion that was not fitted; truth from the independent integrator."""

import numpy as np
import pytest

from bench.diagnosis.add import add
from bench.diagnosis.diagnosis import gaps_of_steps, time_series
from bench.diagnosis.name import Suspects
from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import Probabilities
from bench.diagnosis.recordings import Recordings
from bench.effects.catalogue import catalogue
from bench.effects.effect import Detected
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.report.verdict import reason as in_words
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from tests.recorded import PLAIN

SPRING = Term(catalogue()["torsion_spring"])
LAG = {catalogue()["velocity_filter_lag"]: Detected({"time_constant": 4e-3}, {"time_constant": 1e-5})}


@pytest.fixture(scope="module")
def recorded():
    """The axis with a torsion spring, recorded twice."""
    spring = (KINDS["torsion_spring"].draw(PLAIN.axis, 0.6, np.random.default_rng(0), 4.0),)
    motions = {k: random_motion(PLAIN.axis, np.random.default_rng(k), 4.0) for k in range(2)}
    first, second = PLAIN.record(dict.fromkeys(motions, spring), motions, 6).values()
    return PLAIN.rig, first, second


def added(recorded, terms, detected=None, with_holdout=True):
    rig, trace, holdout = recorded
    recordings = Recordings.of(trace, rig, holdout if with_holdout else None)
    fitted = fit(recordings.rows, Hypothesis(tuple(terms)))
    return add(recordings, Suspects(fitted, (fitted,), Probabilities({}, 1.0), detected or {}, Policy()))


@pytest.mark.parametrize("with_holdout", [True, False])
def test_a_true_effect_is_kept_and_both_gaps_shrink(recorded, with_holdout):
    result = added(recorded, [SPRING], with_holdout=with_holdout)
    assert result.rejected == ()
    before, after = gaps_of_steps(result, time_series(result))
    assert (before.effect, after.effect) == ("", "torsion_spring")
    assert len(after.torque) == len(after.velocity) == (2 if with_holdout else 1)
    assert all(late < 0.3 * early for early, late in zip(before.velocity, after.velocity, strict=True))
    assert all(late < 0.3 * early for early, late in zip(before.torque, after.torque, strict=True))


@pytest.mark.parametrize("with_holdout", [True, False])
def test_an_effect_that_makes_the_simulation_worse_is_rejected_with_the_reason(recorded, with_holdout):
    result = added(recorded, [SPRING], LAG, with_holdout)
    ((name, reason),) = result.rejected
    assert name == "velocity_filter_lag"
    assert "velocity gap" in in_words(reason)
    assert ("holdout" in in_words(reason)) is with_holdout
    assert [effect.name for effect in result.effects] == ["torsion_spring"]
