"""What is hidden by the independent integrator is named, nothing hidden is not, and the foreign stays unnamed.

Every effect, on axes and electronics drawn at random: `tests/studies/blind`.
"""

import numpy as np
import pytest

from bench.diagnosis.diagnosis import diagnose
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from tests.outside import OUTSIDE
from tests.recorded import PLAIN

NAMED = ("cogging_torque", "stribeck_friction")
HIDDEN = ((), *((name,) for name in NAMED), ("vibration",))


@pytest.fixture(scope="module")
def recordings():
    """Two recordings by what was hidden."""
    rng, seconds, both = np.random.default_rng(3), 4.0, {}
    motions = [random_motion(PLAIN.axis, np.random.default_rng(k), seconds) for k in range(2)]
    for names in HIDDEN:
        effects = tuple((KINDS | OUTSIDE)[name].draw(PLAIN.axis, 0.6, rng, seconds) for name in names)
        both |= {(names, k): (effects, motion) for k, motion in enumerate(motions)}
    hidden, moving = ({case: one[k] for case, one in both.items()} for k in range(2))
    traces = PLAIN.record(hidden, moving, 4)
    return {names: (traces[names, 0], traces[names, 1]) for names in HIDDEN}


@pytest.fixture(scope="module")
def found(recordings):
    """Diagnoses by what was hidden."""
    return {names: diagnose(first, PLAIN.rig, second) for names, (first, second) in recordings.items()}


def test_nothing_hidden_is_not_named(found):
    assert found[()].verdict == "nothing_missing"
    assert found[()].effects == []


@pytest.mark.parametrize("name", NAMED)
def test_a_hidden_effect_is_named_and_the_gap_shrinks(found, name):
    diagnosis = found[(name,)]
    assert [effect.name for effect in diagnosis.effects] == [name]
    torque = diagnosis.torque
    assert torque.identify[1] < 0.7 * torque.identify[0]
    assert diagnosis.parameters["moment_of_inertia"].value == pytest.approx(PLAIN.axis.inertia, rel=3e-3)


def test_physics_outside_the_catalogue_stays_unnamed(found):
    assert found[("vibration",)].verdict == "unexplained_remainder"
    assert found[("vibration",)].effects == []


def test_where_points_at_the_coordinate(found):
    assert found[("cogging_torque",)].where[0].coordinate == "position"
    assert found[("vibration",)].where[0].coordinate == "frequency"
    assert {found[("stribeck_friction",)].where[k].coordinate for k in range(2)} & {"velocity", "reversal", "direction"}


def test_the_name_left_out_of_the_catalogue_is_not_replaced_by_a_wrong_one(recordings):
    first, second = recordings[("cogging_torque",)]
    diagnosis = diagnose(first, PLAIN.rig, second, excluded=frozenset({"cogging_torque"}))
    assert diagnosis.verdict == "unexplained_remainder"
    assert diagnosis.effects == []
