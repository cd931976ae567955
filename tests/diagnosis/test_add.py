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
from bench.rig.rig import load_rig
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from bench.validation.independent.rig import Axis, write_rig
from bench.validation.independent.sensors import Noise, Sensors
from bench.validation.independent.simulate import simulate
from tests.kept import kept

AXIS = Axis(
    "axis", 1.5e-3, 8e-4, 0.08, 5e-4, 0.7, 6.0, velocity_gain=0.15, integral_gain=2.0, inertia_feedforward=1.4e-3
)
SENSORS = Sensors(velocity=Noise(white=0.03), current=Noise(white=8e-3), encoder_resolution=2e-5)
#: Of the integrator: 5e-5 rad/s off at most (test_order_of_convergence.py), a fraction of the noise - s.
SPRING = Term(catalogue()["torsion_spring"])
LAG = {catalogue()["velocity_filter_lag"]: Detected({"time_constant": 4e-3}, {"time_constant": 1e-5})}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The axis with a torsion spring, recorded twice."""
    spring = (KINDS["torsion_spring"].draw(AXIS, 0.6, np.random.default_rng(0), 4.0),)
    motions = [random_motion(AXIS, np.random.default_rng(k), 4.0) for k in range(2)]
    together = [AXIS] * 2, motions, [spring] * 2, [SENSORS] * 2
    first, second = kept(lambda: [run.trace for run in simulate(*together, seed=6)], __file__)
    path = tmp_path_factory.mktemp("rig") / "rig.toml"
    write_rig(AXIS, path)
    return load_rig(path), first, second


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
