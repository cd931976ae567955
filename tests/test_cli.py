"""The commands as a user meets them: what they print and write, and one line with a status for whatever is wrong."""

import json
import subprocess
import sys

import numpy as np
import pytest

from bench.trace.read import read
from bench.trace.write import write
from tests import command
from tests.fit.motions import Truth, recording
from tests.hostile import assert_one_line, bound_by_permissions, columns, csv_of, run

RIG = 'name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\nrotor_inertia = "2 kg*cm**2"\n'


@pytest.fixture
def bench(monkeypatch, tmp_path):
    """Runs `bench` in a folder of its own, which holds a rig file."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
    return command.bench


@pytest.fixture(scope="module")
def trace(tmp_path_factory):
    path = tmp_path_factory.mktemp("trace") / "run.csv.gz"
    write(recording(np.random.default_rng(0), duration=4.0), path)
    return path


def test_simulate_writes_a_trace_and_its_truth(bench, tmp_path):
    """Of a shipped rig, by its name; the recording and the rig are found again."""
    status, out, _ = bench("simulate", "sh30701p", "--out", "run.parquet", "--profile", "fast_reversals", "--seed", 3)
    assert (status, "run.parquet.truth.json" in out) == (0, True)
    truth = json.loads((tmp_path / "run.parquet.truth.json").read_text())
    assert truth["parameters"]["coulomb_friction_torque"] == {"value": 0.085, "unit": "N*m"}
    assert "velocity" in read(tmp_path / "run.parquet")
    assert bench("identify", "run.parquet", "--rig", "sh30701p")[0] == 0


def test_identify_writes_the_contracts_json(bench, trace, tmp_path):
    status, out, _ = bench("identify", trace, "--rig", "rig.toml", "--json", "found.json", "--out", "figures")
    assert status == 0
    assert "viscous friction coefficient" in out
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["schema"] == "bench.identify/1"
    for name, unit in {
        "moment_of_inertia": "kg*m**2",
        "viscous_friction_coefficient": "N*m*s/rad",
        "coulomb_friction_torque": "N*m",
        "load_moment_of_inertia": "kg*m**2",
    }.items():
        parameter = found["parameters"][name]
        assert parameter["unit"] == unit
        assert parameter["ci95"][0] < parameter["value"] < parameter["ci95"][1]
        assert parameter["std_error"] > 0.0
    assert set(found["residual"]) == {"rms", "noise_floor", "unit", "relative", "depends_on"}
    assert found["samples"]["read"] == 4000
    assert 0 < found["samples"]["used"] <= 4000
    assert found["warnings"] == []
    assert (tmp_path / "figures" / "identification.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.parametrize("command", [("identify", "--rig", "rig.toml"), ("inspect",)])
def test_json_alone_goes_to_standard_output(bench, trace, command):
    status, out, _ = bench(command[0], trace, *command[1:], "--json", "-")
    assert (status, json.loads(out)["schema"]) == (0, f"bench.{command[0]}/1")


def test_the_labs_estimator_and_the_polish_answer_too(bench, trace):
    status, out, err = bench("identify", trace, "--rig", "rig.toml", "--estimator", "lab")
    assert (status, "moment of inertia" in out, "too narrow" in err) == (0, True, True)
    status, out, _ = bench("identify", trace, "--rig", "rig.toml", "--refine")
    assert (status, "simulation error on held-out motion" in out) == (0, True)


HEAD = "time [ms],velocity [rad/s],current [A]\n"
ROWS = [f"{k},{50 * np.sin(k / 80):.6f},{0.3 * np.cos(k / 80):.6f}" for k in range(3000)]
BODY = HEAD + "\n".join(ROWS) + "\n"


def rows(first, last=3000):
    return HEAD + "\n".join(ROWS[first:last]) + "\n"


@pytest.mark.parametrize(
    ("text", "word"),
    [(BODY.replace("current [A]", "other [K]", 1), "current"), (rows(0, 10) + "10,fast,0.1\n", "fast")],
    ids=["what identify needs is missing", "what no reader takes"],
)
def test_bad_input_is_one_line_that_names_the_file_and_status_two_and_writes_nothing(bench, tmp_path, text, word):
    """What else a file may hold is asked of the readers, in `trace/test_bad_input.py`."""
    (tmp_path / "bad.csv").write_text(text)
    ended = bench("identify", "bad.csv", "--rig", "rig.toml", "--json", "found.json", "--out", "figures")
    assert ended.out == ""
    assert_one_line(ended, "bad.csv", word)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["bad.csv", "rig.toml"]


ARM = '<mujoco><worldbody><body><joint name="elbow" type="hinge"/><geom size="0.1"/></body></worldbody></mujoco>'


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("identify nowhere.csv --rig rig.toml", ["nowhere.csv"]),
        ("identify . --rig rig.toml", ["folder"]),
        ("identify rig.toml --rig nowhere.toml", ["nowhere.toml", "no such file"]),
        ("identify rig.toml", ["rig.toml: found a TOML file", "--rig and"]),
        ("identify run.csv --rig wrong.toml", ["torque_constnt", "torque_constant"]),
        ("identify run.csv --rig emp", ["did you mean 'emps'?"]),
        ("identify run.csv --rig rig.toml --draft other.toml", ["--draft"]),
        ("identify run.csv --mjcf arm.xml", ["--joint: missing; allowed: elbow"]),
        ("diagnose bare.csv", ["bench inspect bare.csv --draft rig.toml"]),
        ("simulate rig.toml --out x.csv", ["rig.toml"]),
        ("simulate rig.toml --out x.csv --seed many", ["--seed", "integer"]),
        ("nonsense", ["nonsense"]),
    ],
)
def test_bad_arguments_are_one_line_and_status_two(bench, tmp_path, line, words):
    (tmp_path / "wrong.toml").write_text(RIG.replace("torque_constant", "torque_constnt"), encoding="utf-8")
    (tmp_path / "run.csv").write_text(BODY)
    (tmp_path / "bare.csv").write_text(BODY.replace("velocity [rad/s],current [A]", "a,b", 1))
    (tmp_path / "arm.xml").write_text(ARM)
    ended = bench(*line.split())
    assert ended.out == ""
    assert_one_line(ended, *words)


@pytest.mark.parametrize(
    ("velocity", "words", "determined"),
    [
        (lambda t: 50.0 + 0.0 * t, ["moment of inertia", "record instead"], None),
        (
            lambda t: 100.0 + 50.0 * np.sin(9.0 * t),
            ["Coulomb friction torque", "offset", "both directions"],
            {"moment_of_inertia", "viscous_friction_coefficient"},
        ),
    ],
    ids=["constant speed", "one direction"],
)
def test_what_the_data_cannot_answer_is_status_one_with_what_to_record(bench, tmp_path, velocity, words, determined):
    """What the data do answer is in the JSON all the same."""
    time = np.arange(4000) * 1e-3
    rng = np.random.default_rng(0)
    speed = velocity(time)
    torque = 1.5e-3 * np.gradient(speed, 1e-3) + 8e-4 * speed + 0.06 * np.sign(speed)
    table = np.column_stack([time * 1e3, speed + rng.normal(scale=0.03, size=4000), torque / 0.8])
    np.savetxt(tmp_path / "run.csv", table, fmt="%.6f", delimiter=",", header=HEAD.strip(), comments="")
    status, out, err = bench("identify", "run.csv", "--rig", "rig.toml", "--json", "found.json")
    assert (status, out, err.count("\n")) == (1, "", 1)
    for word in words:
        assert word in err
    path = tmp_path / "found.json"
    assert path.exists() == (determined is not None)
    if determined is not None:
        found = json.loads(path.read_text(encoding="utf-8"))["parameters"]
        assert determined <= set(found)
        assert "coulomb_friction_torque" not in found


def test_two_samples_are_too_few_and_a_hole_is_reported_and_not_bridged(bench, tmp_path):
    (tmp_path / "run.csv").write_text(rows(0, 2))
    status, _, err = bench("identify", "run.csv", "--rig", "rig.toml")
    assert (status, "at least 72 samples" in err) == (1, True)
    (tmp_path / "run.csv").write_text(rows(0, 1000) + rows(1200).removeprefix(HEAD))
    status, out, _ = bench("inspect", "run.csv")
    assert (status, "2 segments" in out) == (0, True)


@pytest.mark.skipif(bound_by_permissions() is None, reason="root, and no setpriv")
def test_a_folder_that_cannot_be_written_to_is_named(tmp_path):
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "run.csv").write_text(csv_of(*columns()))
    (tmp_path / "closed").mkdir(mode=0o500)
    line = ("identify", "run.csv", "--rig", "rig.toml", "--json", "closed/found.json")
    assert_one_line(run(*line, cwd=tmp_path, under=bound_by_permissions()), "closed")


def test_the_installed_command_answers():
    done = subprocess.run([sys.executable, "-m", "bench", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.strip()


FOREIGN = "time,pos_estimate,vel_estimate,Iq_measured\n"


def odrive(path, seconds=3.0):
    """What an ODrive exports: turns and turns/s without units, Iq in A; and the columns of the truth."""
    made = recording(np.random.default_rng(1), duration=seconds, position=True)
    turns = made["position"] / 2.0 / np.pi, made["velocity"] / 2.0 / np.pi
    rows = zip(made.time, *turns, made["current"], strict=True)
    path.write_text(FOREIGN + "\n".join(f"{t:.3f},{p:.7f},{v:.7f},{i:.6f}" for t, p, v, i in rows) + "\n")


def test_without_a_rig_one_is_drafted_said_and_kept(bench, tmp_path):
    odrive(tmp_path / "odrive.csv")
    status, out, err = bench("identify", "odrive.csv", "--draft", "own.toml", "--json", "drafted.json")
    assert status == 0
    assert "no rig was given, so one was drafted from odrive.csv: a rotary axis" in err
    assert "velocity = vel_estimate [turn/s]" in err
    assert "no torque constant is given, so torques are in A; set motor.torque_constant in the rig" in err
    assert "A·s²/rad" in out
    status, _, err = bench("identify", "odrive.csv", "--rig", "own.toml", "--json", "kept.json")
    assert status == 0
    assert "no rig was given" not in err
    drafted, kept = (json.loads((tmp_path / f"{name}.json").read_text()) for name in ("drafted", "kept"))
    assert drafted["parameters"] == kept["parameters"]
    assert drafted["provenance"]["rig_sha256"] is None
    assert drafted["parameters"]["moment_of_inertia"]["value"] * 0.8 == pytest.approx(Truth().inertia, rel=0.01)
