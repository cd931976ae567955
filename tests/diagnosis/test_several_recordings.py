"""Several recordings in one diagnosis: what belongs to each stays its own, and how they differ is reported."""

import json
from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.errors import InputError
from bench.report.diagnosis import diagnosis_json
from bench.trace.write import write
from tests.diagnosis.command import started
from tests.fit.motions import NAMES, RIG, Truth, recording

PENDULUM, WARM, SECONDS = 0.12, 0.8, 1.5


def run_of(seed, truth=Truth(), **more):  # noqa: B008 - frozen
    found = recording(np.random.default_rng(seed), truth, **{"duration": 3.0, "position": True, **more})
    return replace(found, origin=f"run{seed}")


def with_torque(trace, torque):
    return replace(trace, signals={**trace.signals, "current": trace["current"] + torque / 0.8})


def with_unbalance(trace):
    return with_torque(trace, PENDULUM * np.sin(trace["position"]))


def inside(parameter, value):
    return parameter.ci95[0] <= value <= parameter.ci95[1]


def test_an_effect_in_both_recordings_is_found_in_both_and_the_holdout():
    runs = [with_unbalance(run_of(k)) for k in (1, 2)]
    found = bench.diagnose(runs, RIG, with_unbalance(run_of(3)))
    assert (found.verdict, [effect.name for effect in found.effects]) == ("explained", ["unbalance"])
    assert inside(found.effects[0].parameters["amplitude"], PENDULUM)
    for name, value in zip(NAMES, Truth().values, strict=True):
        assert found.parameters[name].value == pytest.approx(value, rel=0.03)
        assert set(found.between) == set(NAMES)
    assert [alone.origin for alone in found.recordings] == ["run1", "run2"]
    assert found.holdout.same is True
    content = json.loads(diagnosis_json(found))
    assert [each["file"] for each in content["recordings"]] == ["run1", "run2"]
    assert set(content["between"]) == set(NAMES)
    one = json.loads(diagnosis_json(bench.diagnose(runs[:1], RIG)))
    assert (one["recordings"], one["between"]) == ([], None)


def test_what_warms_up_does_so_in_every_recording_anew():
    def warming(trace):
        cold = Truth.coulomb * np.sign(trace["velocity"]) + Truth.viscous * trace["velocity"]
        return with_torque(trace, WARM * np.exp(-trace.time / SECONDS) * cold)

    found = bench.diagnose([warming(run_of(k, duration=5.0, bias=30.0)) for k in (1, 2)], RIG)
    assert (found.verdict, [effect.name for effect in found.effects]) == ("explained", ["friction_warmup"])
    assert found.effects[0].parameters["time_constant"].value == pytest.approx(SECONDS, rel=0.15)
    assert found.velocity.identify[1] < 0.7 * found.velocity.identify[0]


def test_hum_of_another_phase_in_every_recording_is_no_remainder():
    def humming(trace, phase):
        return with_torque(trace, 0.02 * np.sin(2.0 * np.pi * 50.0 * trace.time + phase))

    found = bench.diagnose([humming(run_of(1), 0.0), humming(run_of(2), 2.0)], RIG)
    assert (found.verdict, found.effects) == ("nothing_missing", [])


def test_recordings_that_differ_widen_the_interval_and_are_reported():
    runs = [run_of(k, Truth(inertia=Truth.inertia * (1.0 + 0.004 * (k - 2)))) for k in (1, 2, 3)]
    found = bench.diagnose(runs, RIG)
    assert any("the recordings differ in moment_of_inertia" in warning for warning in found.warnings)
    low, high = found.parameters["moment_of_inertia"].ci95
    assert low < 0.997 * Truth.inertia < 1.003 * Truth.inertia < high
    assert found.between["moment_of_inertia"].std_dev == pytest.approx(0.004 * Truth.inertia, rel=0.1)


@pytest.mark.parametrize("seed", [1, 5, 7])
def test_runs_that_each_go_one_way_are_one_recording_of_both(seed):
    """Through all of one of them an event would act as the offset does: what lasts that long is none."""
    runs = [run_of(seed + k, Truth(offset=0.03), bias=300.0 * (-1.0) ** k, position=False) for k in (0, 1)]
    assert any("only" in warning for warning in bench.diagnose(runs[0], RIG).warnings)
    found = bench.diagnose(runs, RIG)
    assert [effect.name for effect in found.effects] == ["torque_offset"]
    assert inside(found.effects[0].parameters["torque"], 0.03)
    assert inside(found.parameters["coulomb_friction_torque"], Truth.coulomb)
    assert all("Coulomb friction torque and torque offset" in alone.reason for alone in found.recordings)


def test_the_command_takes_several_and_no_holdout_that_is_one_of_them(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = started(tmp_path)
    for k in (1, 2):
        write(run_of(k), tmp_path / f"run{k}.csv")
    two = ("diagnose", "run1.csv", "run2.csv", "--rig", "rig.toml")
    assert command(*two, "--json", "found.json", "--out", "out") == 0
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["verdict"] == "nothing_missing"
    assert [each["file"] for each in found["provenance"]["traces"]] == ["run1.csv", "run2.csv"]
    assert [each["sha256"] for each in found["recordings"]] == [t["sha256"] for t in found["provenance"]["traces"]]
    assert command("replay", "out/model.toml", "run2.csv", "--rig", "rig.toml", "--out", "replay.csv") == 0
    assert command(*two, "--holdout", "run2.csv") == 2
    assert "the recording itself" in capsys.readouterr().err
    with pytest.raises(InputError, match="the same recording"):
        bench.diagnose([run_of(1), run_of(1)], RIG)
