"""What a command leaves where a check fails or warns."""

import json

import numpy as np
import pytest

from bench.trace.write import write
from tests.diagnosis.command import started
from tests.gate.damage import changed, losing
from tests.independent.axes import PLAIN


@pytest.fixture
def bench(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return started(tmp_path)


@pytest.mark.parametrize("command", ["identify", "diagnose"])
def test_a_recording_that_cannot_answer_leaves_its_checks(bench, sound, tmp_path, capsys, command):
    write(changed(sound, current=np.full(len(sound), 0.3)), tmp_path / "run.csv")
    assert bench(command, "run.csv", "--rig", "rig.toml", "--json", "found.json") == 1
    assert capsys.readouterr().err.count("\n") == 1
    left = json.loads((tmp_path / "found.json").read_text())
    assert left["schema"] == f"bench.{command}/1"
    assert {check["name"]: check["status"] for check in left["checks"]}["signal_moves"] == "fail"


def test_a_warning_is_reported_and_stands_in_the_json(bench, sound, tmp_path, capsys):
    write(losing(sound, 0.002), tmp_path / "run.csv")
    assert bench("identify", "run.csv", "--rig", "rig.toml", "--json", "found.json") == 0
    assert "lost_samples" in capsys.readouterr().err
    found = json.loads((tmp_path / "found.json").read_text())
    assert {check["name"]: check["status"] for check in found["checks"]}["lost_samples"] == "warn"
    inertia = found["parameters"]["moment_of_inertia"]["value"] / 0.8 * PLAIN.torque_constant
    assert inertia == pytest.approx(PLAIN.inertia, rel=0.01)
