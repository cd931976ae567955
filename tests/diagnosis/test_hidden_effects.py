"""What is hidden by the independent integrator is named, nothing hidden is not, and the foreign stays unnamed.

Every effect, on axes and electronics drawn at random: `tests/studies/blind`.
"""

import json

import numpy as np
import pytest

from bench.diagnosis.diagnosis import diagnose
from bench.report.diagnosis import diagnosis_json
from bench.rig.rig import load_rig
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from bench.validation.independent.rig import Axis, write_rig
from bench.validation.independent.sensors import Noise, Sensors
from bench.validation.independent.simulate import simulate
from tests.kept import kept
from tests.outside import OUTSIDE

AXIS = Axis(
    "axis", 1.5e-3, 8e-4, 0.08, 5e-4, 0.7, 6.0, velocity_gain=0.15, integral_gain=2.0, inertia_feedforward=1.4e-3
)
SENSORS = Sensors(velocity=Noise(white=0.03), current=Noise(white=8e-3), encoder_resolution=2e-5)
#: Of the integrator: 5e-5 rad/s off at most (test_order_of_convergence.py), a fraction of the noise - s.
NAMED = ("cogging_torque", "unbalance", "stribeck_friction")
HIDDEN = ((), *((name,) for name in NAMED), ("vibration",))


@pytest.fixture(scope="module")
def recordings():
    """Two recordings by what was hidden; all integrated together."""
    rng, seconds = np.random.default_rng(3), 6.0
    effects = [tuple((KINDS | OUTSIDE)[name].draw(AXIS, 0.6, rng, seconds) for name in names) for names in HIDDEN]
    motions = [random_motion(AXIS, np.random.default_rng(k), seconds) for k in range(2)]

    def recorded():
        runs = simulate(
            [AXIS] * (2 * len(HIDDEN)),
            [motions[k] for _ in HIDDEN for k in range(2)],
            [effect for effect in effects for _ in range(2)],
            [SENSORS] * (2 * len(HIDDEN)),
            seed=4,
        )
        return [run.trace for run in runs]

    traces = kept(recorded, __file__)
    return dict(zip(HIDDEN, zip(traces[::2], traces[1::2], strict=True), strict=True))


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    path = tmp_path_factory.mktemp("rig") / "rig.toml"
    write_rig(AXIS, path)
    return load_rig(path)


@pytest.fixture(scope="module")
def found(recordings, rig):
    """Diagnoses by what was hidden."""
    return {names: diagnose(first, rig, second) for names, (first, second) in recordings.items()}


def test_nothing_hidden_is_not_named(found):
    assert found[()].verdict == "nothing_missing"
    assert found[()].effects == []


@pytest.mark.parametrize("name", NAMED)
def test_a_hidden_effect_is_named_and_the_gap_shrinks(found, name):
    diagnosis = found[(name,)]
    assert [effect.name for effect in diagnosis.effects] == [name]
    torque = diagnosis.torque
    assert torque.identify[1] < 0.7 * torque.identify[0]
    assert diagnosis.parameters["moment_of_inertia"].value == pytest.approx(AXIS.inertia, rel=3e-3)


def test_physics_outside_the_catalogue_stays_unnamed(found):
    assert found[("vibration",)].verdict == "unexplained_remainder"
    assert found[("vibration",)].effects == []


def test_where_points_at_the_coordinate(found):
    assert found[("unbalance",)].where[0].coordinate == "position"
    assert found[("vibration",)].where[0].coordinate == "frequency"
    assert {found[("stribeck_friction",)].where[k].coordinate for k in range(2)} & {"velocity", "reversal", "direction"}


def test_json_is_the_contracts(found):
    content = json.loads(diagnosis_json(found[("cogging_torque",)]))
    assert content["schema"] == "bench.diagnose/1"
    assert content["effects"][0]["name"] == "cogging_torque"
    assert {"value", "unit", "ci95"} <= set(content["effects"][0]["parameters"]["amplitude"])
    assert set(content["gap"]) == {"torque", "velocity"}
    assert {"before", "after"} == set(content["gap"]["torque"]["holdout"])
    velocity = content["gap"]["velocity"]["holdout"]
    assert velocity["after"] < velocity["before"]


def test_the_name_left_out_of_the_catalogue_is_not_replaced_by_a_wrong_one(recordings, rig):
    first, second = recordings[("cogging_torque",)]
    diagnosis = diagnose(first, rig, second, excluded=frozenset({"cogging_torque"}))
    assert diagnosis.verdict == "unexplained_remainder"
    assert diagnosis.effects == []
