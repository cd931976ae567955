"""The holdout says whose recording it is, and in what it differs; a result says what it came from."""

import hashlib
import json

import numpy as np
import pytest

import bench
from bench.diagnosis.add.same_axis import same_axis
from bench.report.diagnosis import diagnosis_json
from bench.trace.write import write
from tests.diagnosis.command import started
from tests.fit.motions import RIG, Truth, recording


def run_of(seed, truth=Truth()):  # noqa: B008 - frozen
    return recording(np.random.default_rng(seed), truth, duration=2.0, position=True)


@pytest.mark.parametrize(
    ("truth", "same", "quantities"),
    [
        (Truth(), True, []),
        (Truth(coulomb=1.49 * Truth.coulomb), None, ["coulomb_friction_torque"]),
        (
            Truth(coulomb=0.8 * Truth.coulomb, viscous=0.6 * Truth.viscous),
            None,
            ["viscous_friction_coefficient", "coulomb_friction_torque"],
        ),
        (Truth(inertia=1.02 * Truth.inertia), None, ["moment_of_inertia"]),
        (Truth(inertia=1.2 * Truth.inertia), False, ["moment_of_inertia"]),
        (Truth(coulomb=2.5 * Truth.coulomb), False, ["coulomb_friction_torque"]),
    ],
    ids=["the same", "49 % more friction", "warm", "2 % more inertia", "20 % more inertia", "other friction"],
)
def test_a_holdout_that_differs_says_in_what(truth, same, quantities):
    found = bench.diagnose(run_of(1), RIG, run_of(2, truth))
    content = json.loads(diagnosis_json(found))["holdout"]
    assert (content["same_axis"], [each["quantity"] for each in content["differs"]]) == (same, quantities)
    values = {"moment_of_inertia": "inertia", "viscous_friction_coefficient": "viscous"}
    for each in content["differs"]:
        name = values.get(each["quantity"], "coulomb")
        for which, true in (("recording", Truth()), ("holdout", truth)):
            low, high = each[f"{which}_ci95"]
            assert low < each[which] < high
            assert each[which] == pytest.approx(getattr(true, name), rel=0.05)
    if quantities:
        assert found.verdict == "unexplained_remainder"
        assert any("holdout" in said for said in found.because)
    assert bool(found.warnings) == (same is False)


def test_without_a_holdout_nobody_can_tell():
    found = bench.diagnose(run_of(1), RIG)
    assert json.loads(diagnosis_json(found))["holdout"] == {"same_axis": None, "differs": []}
    units = {"moment_of_inertia": "kg*m**2", "viscous_friction_coefficient": "", "coulomb_friction_torque": ""}
    assert same_axis(None, None, units).same is None


def test_the_json_says_what_it_came_from(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = started(tmp_path)
    for k in (1, 2):
        write(run_of(k, Truth(coulomb=Truth.coulomb * (1.0 + 0.5 * (k == 2)))), tmp_path / f"run{k}.csv")
    arguments = ("diagnose", "run1.csv", "--rig", "rig.toml", "--without", "backlash", "--json", "found.json")
    assert command(*arguments, "--holdout", "run2.csv", "--out", "out") == 0

    def digest(name):
        return hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()

    found = json.loads((tmp_path / "found.json").read_text())
    assert found["provenance"] == {
        "version": bench.__version__,
        "rig_sha256": digest("rig.toml"),
        "traces": [{"file": "run1.csv", "sha256": digest("run1.csv")}],
        "options": {"without": ["backlash"]},
        "holdout": {"file": "run2.csv", "sha256": digest("run2.csv")},
    }
    assert json.loads((tmp_path / "out" / "diagnosis.json").read_text())["provenance"] == found["provenance"]
    assert "the holdout differs: coulomb friction torque" in capsys.readouterr().out
