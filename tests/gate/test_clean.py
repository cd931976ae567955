"""No check fails on a recording that is sound, whatever sensors and effects it holds; a wrong scale does."""

import json

import pytest

from bench.gate.gate import gate
from tests.diagnosis.command import started
from tests.gate.clean import independent, public, real, shared_cases
from tests.shared import SHARED, needs_shared


def failing(trace, rig):
    return {check.name for check in gate(trace, rig).checks if check.status == "fail"}


@pytest.mark.parametrize("recordings", [shared_cases, real, public])
@needs_shared
def test_nothing_fails_on_recordings_of_others(recordings):
    failed = {name: found for name, trace, rig in recordings() if (found := failing(trace, rig))}
    assert failed == {}


@pytest.mark.parametrize("each", [2, pytest.param(6, marks=pytest.mark.slow)])
def test_nothing_fails_on_axes_drawn_at_random(tmp_path, each):
    drawn = list(independent(each, tmp_path, duration=3.0))
    assert {name: found for name, trace, rig in drawn if (found := failing(trace, rig))} == {}


@needs_shared
def test_a_speed_of_another_scale_fails_on_real_recordings():
    found = {name: failing(trace, rig) for name, trace, rig in real(wrong=True)}
    assert len(found) == 7
    assert set.union(*found.values()) == {"velocity_is_derivative_of_position"}
    assert all(found.values())


@needs_shared
@pytest.mark.parametrize("command", ["identify", "diagnose"])
def test_a_command_ends_with_one_line(tmp_path, monkeypatch, capsys, command):
    monkeypatch.chdir(tmp_path)
    folder = SHARED / "data/real/damiao_m4"
    bench = started(tmp_path)
    assert bench(command, str(folder / "r1.csv.gz"), "--rig", str(folder / "rig.toml")) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "0.5027 times the derivative of position" in error


@needs_shared
def test_inspect_tells_every_check(tmp_path, capsys):
    path = SHARED / "data/real/damiao_m4/r1.csv.gz"
    assert started(tmp_path)("inspect", str(path), "--json", "-") == 0
    checks = {check["name"]: check for check in json.loads(capsys.readouterr().out)["checks"]}
    assert len(checks) == 13
    assert checks["velocity_is_derivative_of_position"]["status"] == "fail"
    assert checks["velocity_is_derivative_of_position"]["advice"]
    assert checks["position_wraps"]["status"] == "pass"
    assert set(checks["lost_samples"]) == {"name", "status", "found", "allowed", "advice"}
