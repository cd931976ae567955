"""Recordings as drives and loggers export them, beside the project: identified, and held to their truth."""

import json

import pytest

from tests.command import bench
from tests.shared import SHARED, needs_shared

EXPORTS = SHARED / "data" / "exports"
TRUTHS = EXPORTS / "truth.json"
#: What is expected of each recording; empty where the recordings are absent.
EXPECTED = json.loads(TRUTHS.read_text(encoding="utf-8")) if TRUTHS.exists() else {}
#: Each parameter under its letter in the truth, and the relative error that an answer may have.
LIMITS = {
    "J": ("moment_of_inertia", "kg*m**2", 0.005),
    "b": ("viscous_friction_coefficient", "N*m*s/rad", 0.03),
    "c": ("coulomb_friction_torque", "N*m", 0.03),
}


@needs_shared
@pytest.mark.parametrize("name", EXPECTED)
def test_an_export_is_answered_or_refused_as_expected(name, tmp_path):
    """As the recordings' README says: a refusal asks with one of each choice of words."""
    truth, result = EXPECTED[name], tmp_path / "result.json"
    file, rig = EXPORTS / name / truth["file"], EXPORTS / name / "rig.toml"
    status, _, err = bench("identify", file, "--rig", rig, "--json", result)
    if truth["expect"] == "refuse":
        message = " ".join(err.split())
        assert status in (1, 2), message
        assert all(any(word in message for word in choice) for choice in truth["words"]), message
        return
    assert status == 0, err
    found = json.loads(result.read_text(encoding="utf-8"))["parameters"]
    for letter, (parameter, unit, limit) in LIMITS.items():
        assert found[parameter]["unit"] == unit
        assert found[parameter]["value"] == pytest.approx(truth[letter], rel=limit), letter
