"""Ranges hold what a recording leaves open, and what recordings differ by."""

import json
from dataclasses import replace

import pytest

from bench.errors import InputError
from bench.export.mjcf import ranges_json
from tests.export.arms import PARAMETERS, stored

FOUND = {
    "schema": "bench.diagnose/1",
    "parameters": {
        "moment_of_inertia": {"value": 1e-3, "unit": "kg*m**2", "std_error": 1e-6, "ci95": [0.99e-3, 1.01e-3]},
        "viscous_friction_coefficient": {"value": 1e-3, "unit": "N*m*s/rad", "ci95": [-1e-4, 2.1e-3]},
        "coulomb_friction_torque": {"value": 0.08, "unit": "N*m", "ci95": [0.07, 0.09]},
        "misalignment": {"value": 0.0, "unit": "s", "ci95": None},
    },
    "between": {"coulomb_friction_torque": {"std_dev": 0.01, "predictive95": [0.05, 0.085]}},
    "effects": [
        {
            "name": "cogging_torque",
            "parameters": {"amplitude": {"value": 0.01, "unit": "N*m", "ci95": [-0.01, 0.03]}},
        }
    ],
}


@pytest.fixture
def ranges(tmp_path):
    """What `export --ranges` writes of a model behind a gear of 10 and a result's content."""

    def read(content=FOUND, **model):
        path = tmp_path / "diagnosis.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return json.loads(ranges_json(stored(gear_ratio=10.0, **model), path))

    return read


def test_a_range_is_the_interval_or_what_the_next_recording_may_tell_and_a_joint_has_it_behind_its_gear(ranges):
    """Never below zero where physics has none."""
    found = ranges()
    inertia, coulomb = (found["parameters"][name] for name in ("moment_of_inertia", "coulomb_friction_torque"))
    assert (inertia["low"], inertia["high"], inertia["from"]) == (0.99e-3, 1.01e-3, "interval of 95 %")
    assert (coulomb["low"], coulomb["high"]) == (0.05, 0.09)
    assert "misalignment" not in found["parameters"]
    (cogging,) = found["effects"]
    assert cogging["parameters"]["amplitude"]["low"] == 0.0
    assert found["joint"]["frictionloss"] == pytest.approx({"value": 0.8, "low": 0.5, "high": 0.9})
    assert found["joint"]["damping"] == pytest.approx({"value": 0.1, "low": 0.0, "high": 0.21})
    assert found["joint"]["armature"] == pytest.approx({"value": 1e-2, "low": 1e-2, "high": 1e-2})


@pytest.mark.parametrize(
    ("motor", "links", "name", "expected"),
    [
        (0.0, 0.0, "moment_of_inertia", (1e-1, 0.99e-1, 1.01e-1)),
        (1e-4, 0.02, "armature", (1e-3, 0.99e-3, 1.01e-3)),
        (0.0, 0.0, "other", (0.0, 0.0, 0.0)),
    ],
)
def test_a_joints_armature_is_the_range_of_what_it_is_made_of(ranges, motor, links, name, expected):
    """All that moves, on the joint's side; an armature that was found beside the links stands there already."""
    content = {**FOUND, "parameters": {name: FOUND["parameters"]["moment_of_inertia"]}}
    joint = ranges(content, parameters=replace(PARAMETERS, motor_inertia=motor), link_inertia=links)["joint"]
    assert joint["armature"] == pytest.approx(dict(zip(("value", "low", "high"), expected, strict=True)))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("{", "truncated or damaged"),
        ("[]", "found 'list'"),
        ({"schema": "bench.fleet/1"}, "found 'bench.fleet/1'"),
        ({**FOUND, "parameters": {"moment_of_inertia": {"ci95": [0, 1]}}}, "damaged"),
        ({**FOUND, "effects": [{"name": "coging_torque", "parameters": {}}]}, "did you mean 'cogging_torque'"),
    ],
)
def test_what_is_no_result_is_reported_in_one_line(ranges, content, says):
    with pytest.raises(InputError, match=says) as error:
        ranges(content)
    assert "\n" not in str(error.value)
