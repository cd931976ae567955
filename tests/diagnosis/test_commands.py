"""`bench diagnose` and `bench replay` as a user meets them: the contract's files, and one line for what is wrong."""

import csv
import json
import os
import re
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from bench.effects.catalogue import catalogue
from bench.trace.choose import GivenOptions
from bench.trace.read import read
from bench.trace.trace import Trace
from bench.trace.write import write, write_joint_states
from tests.diagnosis.command import started
from tests.fit.motions import UNITS, Truth, recording

PENDULUM = 0.12


def run_of(seed=1, **changes):
    """Two seconds that nothing is hidden in, unless changed."""
    return recording(np.random.default_rng(seed), **{"duration": 2.0, "position": True, **changes})


def with_unbalance(trace):
    """The same motion under an eccentric mass: closed form, its torque beside the current's."""
    more = PENDULUM * np.sin(trace["position"]) / 0.8
    return replace(trace, signals={**trace.signals, "current": trace["current"] + more})


def only(trace, *names):
    return Trace(trace.time, {n: trace[n] for n in names}, {n: UNITS[n] for n in names}, trace.origin)


def moving(speed, seconds=4.0):
    """A recording of any speed over time, without position."""
    time = np.arange(round(seconds * 1e3)) * 1e-3
    rng, omega = np.random.default_rng(0), speed(time)
    torque = 1.5e-3 * np.gradient(omega, 1e-3) + 8e-4 * omega + 0.06 * np.sign(omega)
    noisy = {"velocity": omega + rng.normal(scale=0.03, size=time.size)}
    noisy["current"] = (torque + rng.normal(scale=0.01, size=time.size)) / 0.8
    return Trace(time, noisy, UNITS, "closed form")


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    """Folder with two recordings of one axis, an unbalance in them, and what `bench diagnose` made of them."""
    folder, before = tmp_path_factory.mktemp("diagnosed"), Path.cwd()
    bench = started(folder)
    for k in (1, 2):
        write(with_unbalance(run_of(seed=k, duration=4.0)), folder / f"run{k}.csv")
    try:
        assert bench("diagnose", "run1.csv", "--rig", "rig.toml", "--holdout", "run2.csv", "--out", "found") == 0
    finally:
        os.chdir(before)
    return folder


def test_the_json_follows_the_contract_key_by_key(diagnosed):
    found = json.loads((diagnosed / "found" / "diagnosis.json").read_text())
    keys = "schema verdict effects where unexplained parameters gap steps next_experiment model warnings"
    assert set(keys.split()) <= set(found)
    assert (found["schema"], found["verdict"], found["warnings"]) == ("bench.diagnose/1", "explained", [])
    (effect,) = found["effects"]
    assert {"name", "parameters", "ambiguous_with", "evidence"} <= set(effect)
    assert (effect["name"], effect["ambiguous_with"]) == ("unbalance", [])
    for parameter in (*effect["parameters"].values(), *found["parameters"].values()):
        assert parameter["ci95"][0] <= parameter["value"] <= parameter["ci95"][1]
        assert parameter["unit"]
    assert {"moment_of_inertia", "viscous_friction_coefficient", "coulomb_friction_torque"} <= set(found["parameters"])
    coordinates = {"position", "velocity", "acceleration", "current", "time", "direction", "frequency", "reversal"}
    assert {entry["coordinate"] for entry in found["where"]} == coordinates
    assert found["where"][0]["coordinate"] == "position"
    for entry in found["where"]:
        assert entry["region"][0] <= entry["region"][1]
        assert 0.0 <= entry["share"] <= 1.0
        assert entry["unit"]
    assert {"share", "where"} <= set(found["unexplained"])
    for gap, unit in (("torque", "N*m"), ("velocity", "rad/s")):
        assert found["gap"][gap]["unit"] == unit
        for recording_ in ("identify", "holdout"):
            assert found["gap"][gap][recording_]["after"] < 0.5 * found["gap"][gap][recording_]["before"]
    assert found["gap"]["torque"]["holdout"]["after"] < 1.2 * found["gap"]["torque"]["noise_floor"]
    assert [step["effect"] for step in found["steps"]] == ["unbalance"]
    assert {"effect", "torque_gap", "velocity_gap"} <= set(found["steps"][0])
    assert found["next_experiment"] is None or isinstance(found["next_experiment"], dict)
    assert found["model"] == {"mjcf": "model.xml", "toml": "model.toml"}


def test_an_effects_values_and_the_inertia_are_those_of_the_closed_form(diagnosed):
    found = json.loads((diagnosed / "found" / "diagnosis.json").read_text())
    amplitude = found["effects"][0]["parameters"]["amplitude"]
    assert amplitude["ci95"][0] < PENDULUM < amplitude["ci95"][1]
    assert found["parameters"]["moment_of_inertia"]["value"] == pytest.approx(Truth().inertia, rel=2e-3)
    assert mujoco.MjModel.from_xml_path(str(diagnosed / "found" / "model.xml")).njnt >= 1


def test_replay_writes_the_contracts_columns_and_the_diagnosed_gap(bench, diagnosed):
    model, trace = diagnosed / "found" / "model.toml", diagnosed / "run2.csv"
    status, out, err = bench("replay", model, trace, "--rig", "rig.toml", "--out", "replay.csv")
    assert (status, err) == (0, "")
    assert "torque gap" in out
    with Path("replay.csv").open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    names = "time [s],velocity [rad/s],velocity_simulated [rad/s],torque [N*m],torque_simulated [N*m]"
    assert head == names.split(",")
    table = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows])
    assert len(table) == 4000
    gap = json.loads((diagnosed / "found" / "diagnosis.json").read_text())["gap"]
    known = table[np.isfinite(table).all(axis=1)]
    assert np.sqrt(np.mean((known[:, 3] - known[:, 4]) ** 2)) == pytest.approx(
        gap["torque"]["holdout"]["after"], rel=0.1
    )
    assert np.sqrt(np.mean((table[:, 1] - table[:, 2]) ** 2)) == pytest.approx(
        gap["velocity"]["holdout"]["after"], rel=0.1
    )


def joint_states(path, topic):
    """Schema, time of the log - ns - and message of each, as the format's own library reads them."""
    with Path(path).open("rb") as file:
        decoded = make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages(topics=[topic])
        return [(schema.name, message.log_time, state) for schema, _, message, state in decoded]


def test_a_replay_is_joint_states_for_who_looks_at_them_elsewhere(bench, diagnosed):
    """Each sample of the CSV beside them, under its time."""
    model, trace = diagnosed / "found" / "model.toml", diagnosed / "run2.csv"
    for out in ("replay.csv", "replay.mcap"):
        assert bench("replay", model, trace, "--rig", "rig.toml", "--out", out)[::2] == (0, "")
    with Path("replay.csv").open(encoding="utf-8") as file:
        rows = np.array([[float(cell) if cell else np.nan for cell in row] for row in list(csv.reader(file))[1:]])
    for topic, columns in (("/measured", (1, 3)), ("/simulated", (2, 4))):
        schemas, logged, states = zip(*joint_states("replay.mcap", topic), strict=True)
        assert set(schemas) == {"sensor_msgs/msg/JointState"}
        assert {tuple(state.name) for state in states} == {("axis",)}
        np.testing.assert_allclose(1e-9 * np.array(logged), rows[:, 0], atol=1e-9)
        stamps = [state.header.stamp.sec + state.header.stamp.nanosec * 1e-9 for state in states]
        np.testing.assert_allclose(stamps, rows[:, 0], atol=1e-9)
        found = np.array([[state.velocity[0], state.effort[0]] for state in states])
        np.testing.assert_allclose(found, rows[:, columns], rtol=1e-8, atol=1e-12)
        turned = np.array([state.position[0] for state in states])
        assert np.gradient(turned, 1e-3)[10:-10] == pytest.approx(found[10:-10, 0], abs=1.0)
    trace = read("replay.mcap", GivenOptions(axis="/measured/axis"))
    assert set(trace.signals) == {"position", "velocity", "torque"}


@pytest.mark.parametrize(("first", "stamp"), [(5.0, 5.0), (0.0, 0.0), (-0.25, 0.0)])
def test_stamps_of_joint_states_are_the_times_and_never_below_zero(tmp_path, first, stamp):
    """A log from 5 s on stays there, so that others of the axis lie beside it."""
    time = first + np.array([0.0, 0.5])
    write_joint_states(tmp_path / "log.mcap", "axis", time, {"/one": {"velocity": np.array([1.0, 2.0])}})
    logged = [at for _, at, _ in joint_states(tmp_path / "log.mcap", "/one")]
    np.testing.assert_allclose(1e-9 * np.array(logged), [stamp, stamp + 0.5], atol=1e-9)


def test_amperes_are_no_effort_of_a_joint_state(bench, diagnosed):
    (diagnosed / "in_a.toml").write_text('name = "axis"\nkind = "rotary"\n')
    run = diagnosed / "run2.csv"
    others = [word for name in catalogue() if name != "unbalance" for word in ("--without", name)]
    assert bench("diagnose", run, "--rig", diagnosed / "in_a.toml", *others, "--out", "amperes")[0] == 0
    status, _, err = bench("replay", "amperes/model.toml", run, "--rig", diagnosed / "in_a.toml", "--out", "x.mcap")
    assert status == 0
    assert "x.mcap has no effort: joint states hold no A" in err
    lengths = {(len(state.velocity), len(state.effort)) for _, _, state in joint_states("x.mcap", "/simulated")}
    assert lengths == {(1, 0)}
    model, mjcf = (Path("amperes", name).read_text() for name in ("model.toml", "model.xml"))
    assert "1 N*m here is 1 A" in model and "1 N*m here is 1 A" in mjcf
    status, _, err = bench("export", "amperes/model.toml", "--snippet", "--out", "joint.xml")
    assert (status, "effort_unit: found 'A'; allowed: N*m" in err) == (2, True), err
    of_model = {"amperes/model.toml": ("rig.toml", "N*m"), diagnosed / "found/model.toml": ("in_a.toml", "A")}
    for other, (rig, gives) in of_model.items():
        status, _, err = bench("replay", other, run, "--rig", diagnosed / rig, "--out", "y.csv")
        assert (status, f"gives the effort in {gives}" in err) == (2, True), err


def test_nothing_hidden_is_nothing_missing(bench):
    write(run_of(), "run.csv")
    status, out, err = bench("diagnose", "run.csv", "--rig", "rig.toml", "--json", "-")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert (found["verdict"], found["effects"], found["unexplained"]["where"]) == ("nothing_missing", [], [])


@pytest.mark.parametrize("seed", range(2))
def test_slow_motion_under_noisy_torque_is_given_no_name(bench, seed):
    """What copies the measured torque, or filters speed, takes up noise and so explains less than it saves."""
    write(only(run_of(seed, speed=0.06, duration=4.0), "velocity", "current"), "run.csv")
    status, out, _ = bench("diagnose", "run.csv", "--rig", "rig.toml", "--json", "-")
    assert status == 0
    assert json.loads(out)["effects"] == []


def turned(trace, name, factor):
    return replace(trace, signals={**trace.signals, name: factor * trace[name]})


UNDECIDED = {
    "0.05 s": (run_of(duration=0.05), ["run.csv contains 50 samples", "0.53 s at least"]),
    "0.3 s": (run_of(duration=0.3), ["run.csv contains 300 samples", "0.53 s at least"]),
    "standing": (moving(lambda t: 0.02 * np.sin(9.0 * t)), ["no filtered sample", "speeds well above 0.1"]),
    "slow": (
        moving(lambda t: 0.5 * np.sin(9.0 * t) * np.cos(2.0 * t)),
        ["noise of the velocity", "or a finer velocity"],
    ),
    "torque quiet": (run_of(torque_noise=3.0), ["torque varies", "its noise", "more than"]),
    "speed quiet": (run_of(velocity_noise=80.0, position=False), ["no filtered sample", "speeds well above"]),
    "one speed": (moving(lambda t: 50.0 + 0.0 * t), ["record instead: a motion that accelerates"]),
    "two speeds": (
        moving(lambda t: np.where(t < 2.0, 50.0, -50.0)),
        ["record instead: a motion that accelerates"],
    ),
    "20 ms": (run_of(period=0.02, duration=12.0), ["keep one direction well over"]),
}
CONTRADICTORY = {
    "no current": (only(run_of(), "position", "velocity"), ["run.csv", "current"]),
    "no motion": (only(run_of(), "current"), ["run.csv", "velocity"]),
    "deg as rad": (turned(run_of(), "velocity", 180.0 / np.pi), ["57.29 times", "units"]),
    "position turned": (turned(run_of(), "position", -1.0), ["-1 times", "position"]),
    "current turned": (turned(run_of(), "current", -1.0), ["opposite signs", "[trace.columns]"]),
}
ARGUMENTS = {
    ("--without", "coging_torque"): ["--without", "cogging_torque"],
    ("--holdout", "nowhere.csv"): ["nowhere.csv", "no such file"],
    ("--holdout", "rig.toml"): ["rig.toml"],
    ("--holdout", "run.csv"): ["holdout", "the recording itself"],
    ("--out", "rig.toml"): ["rig.toml", "is an input"],
    ("--json", "."): ["found a folder", "name a file"],
}
REFUSED = [
    *((name, (), trace, 1, [*words, "record instead"]) for name, (trace, words) in UNDECIDED.items()),
    *((name, (), trace, 2, words) for name, (trace, words) in CONTRADICTORY.items()),
    *((" ".join(given), given, run_of(), 2, words) for given, words in ARGUMENTS.items()),
]


@pytest.mark.parametrize(
    ("given", "trace", "status", "words"), [row[1:] for row in REFUSED], ids=[r[0] for r in REFUSED]
)
def test_what_is_refused_is_one_line_with_its_status_and_no_file(bench, tmp_path, given, trace, status, words):
    write(trace, "run.csv")
    files = given or ("--json", "found.json", "--out", "found")
    found, out, err = bench("diagnose", "run.csv", "--rig", "rig.toml", *files)
    assert (found, out, err.count("\n")) == (status, "", 1), err
    for word in words:
        assert word in err
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["rig.toml", "run.csv"]


def test_a_holdout_too_short_is_named(bench):
    write(run_of(), "run.csv")
    write(run_of(seed=2, duration=0.2), "other.csv")
    status, _, err = bench("diagnose", "run.csv", "--rig", "rig.toml", "--holdout", "other.csv")
    assert (status, err.count("\n")) == (1, 1)
    assert "other.csv" in err


def test_a_wrong_unit_of_current_and_a_clipped_current_are_reported(bench):
    write(turned(run_of(), "current", 1e-3), "run.csv")
    status, _, err = bench("diagnose", "run.csv", "--rig", "rig.toml")
    assert status == 1
    assert "load moment of inertia" in err
    assert "comes out negative" in err
    trace = run_of()
    for limit, expected in ((2.2, 0), (0.3, 1)):  # a third of the samples lost leave no inertia
        write(replace(trace, signals={**trace.signals, "current": np.minimum(trace["current"], limit)}), "run.csv")
        status, _, err = bench("diagnose", "run.csv", "--rig", "rig.toml")
        assert status == expected
        assert f"exactly {limit} A" in err


def test_a_recording_standing_still_most_of_the_time_in_coarse_steps_is_no_traceback(bench):
    trace = moving(lambda t: 50.0 * np.sin(8.0 * t) * np.cos(3.0 * t) * (t > 1.25), 2.0)
    rounded = {"velocity": np.round(trace["velocity"], 0), "current": np.round(trace["current"], 1)}
    write(replace(trace, signals=rounded), "run.csv")
    status, _, _ = bench("diagnose", "run.csv", "--rig", "rig.toml")
    assert status in (0, 1)


DAMAGE = {
    "nothing": (r"[\s\S]*", "", ["torque_balance", "missing"]),
    "cut": (r"\]\s*$", "", ["TOML"]),
    "no coefficients": (r"coefficients = \[[^\]]*\]", "", ["torque_balance.coefficients", "missing"]),
    "few coefficients": (r"coefficients = \[[^\]]*\]", "coefficients = [1.0]", ["found 1", "allowed: 6"]),
    "not finite": (r"coefficients = \[[^,]*", "coefficients = [nan", ["coefficients", "finite"]),
    "no width": (r"filter_width = .*", "filter_width = 0.0", ["filter_width", "found 0"]),
    "unknown effect": (r'name = "unbalance", shape', 'name = "unbalanse", shape', ["unbalanse", "unbalance"]),
    "shape": (r"shape = \[\]", "shape = [1.0]", ["unbalance.shape", "allowed: 0"]),
    "unit": (r"kg\*m\*\*2", "kg", ["moment_of_inertia", "kg"]),
    "kind": (r'kind = "rotary"', 'kind = "linear"', ["kind", "linear", "rotary"]),
}  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_model_is_one_line_and_status_two(bench, diagnosed, tmp_path, damage):
    pattern, other, words = DAMAGE[damage]
    text = re.sub(pattern, other, (diagnosed / "found" / "model.toml").read_text(), count=1)
    (tmp_path / "model.toml").write_text(text)
    status, out, err = bench("replay", "model.toml", diagnosed / "run2.csv", "--rig", "rig.toml", "--out", "replay.csv")
    assert (status, out, err.count("\n")) == (2, "", 1), err
    assert "model.toml" in err
    for word in words:
        assert word in err
    assert not (tmp_path / "replay.csv").exists()


def test_replay_along_another_axis_is_reported_and_too_short_a_recording_refused(bench, diagnosed, tmp_path):
    model = diagnosed / "found" / "model.toml"
    write(run_of(seed=2, truth=Truth(inertia=3.0 * Truth.inertia)), "other.csv")
    status, _, err = bench("replay", model, "other.csv", "--rig", "rig.toml", "--out", "replay.csv")
    assert status == 0
    assert "another axis" in err
    write(run_of(seed=2, duration=0.05), "short.csv")
    status, _, err = bench("replay", model, "short.csv", "--rig", "rig.toml", "--out", "short_replay.csv")
    assert (status, err.count("\n")) == (1, 1)
    assert "short.csv" in err
    assert not (tmp_path / "short_replay.csv").exists()
