"""What a command reports where a check fails or warns."""

import json

import numpy as np
import pytest

from bench.trace.write import write
from tests.diagnosis.conftest import bench
from tests.gate.damage import changed, losing
from tests.independent.axes import PLAIN
from tests.shared import SHARED, needs_shared

__all__ = ["bench"]
DAMIAO = SHARED / "data/real/damiao_m4"


def checks_in(text):
    return {check["name"]: check for check in json.loads(text)["checks"]}


@pytest.mark.parametrize("command", ["identify", "diagnose"])
def test_a_recording_that_cannot_answer_is_status_one_with_its_checks(bench, sound, tmp_path, command):
    write(changed(sound, current=np.full(len(sound), 0.3)), tmp_path / "run.csv")
    done = bench(command, "run.csv", "--rig", "rig.toml", "--json", "found.json")
    assert (done.status, done.err.count("\n")) == (1, 1)
    text = (tmp_path / "found.json").read_text()
    assert json.loads(text)["schema"] == f"bench.{command}/1"
    assert checks_in(text)["signal_moves"]["status"] == "fail"


def test_a_warning_is_reported_and_is_in_the_json(bench, sound, tmp_path):
    write(losing(sound, 0.002), tmp_path / "run.csv")
    done = bench("identify", "run.csv", "--rig", "rig.toml", "--json", "found.json")
    assert done.status == 0
    assert "lost_samples" in done.err
    text = (tmp_path / "found.json").read_text()
    assert checks_in(text)["lost_samples"]["status"] == "warn"
    inertia = json.loads(text)["parameters"]["moment_of_inertia"]["value"] / 0.8 * PLAIN.torque_constant
    assert inertia == pytest.approx(PLAIN.inertia, rel=0.01)


@needs_shared
@pytest.mark.parametrize("command", ["identify", "diagnose"])
def test_a_recording_that_is_wrong_is_status_two_in_one_line(bench, command):
    done = bench(command, DAMIAO / "r1.csv.gz", "--rig", DAMIAO / "rig.toml")
    assert (done.status, done.err.count("\n")) == (2, 1)
    assert "0.5027 times the derivative of position" in done.err


@needs_shared
def test_inspect_reports_every_check(bench):
    checks = checks_in(bench("inspect", DAMIAO / "r1.csv.gz", "--json", "-").out)
    assert len(checks) == 13
    assert checks["velocity_is_derivative_of_position"]["status"] == "fail"
    assert checks["velocity_is_derivative_of_position"]["advice"]
    assert checks["position_wraps"]["status"] == "pass"
    assert set(checks["lost_samples"]) == {"name", "status", "found", "allowed", "advice"}
