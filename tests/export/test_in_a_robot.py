"""docs/export.md: from the log of a joint that moves among others to the robot's MJCF with the joint in it."""

import json
import re
import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.arrays import rms
from tests.command import bench
from tests.docs.pages import PAGES, run_examples
from tests.export.held import followed
from tests.export.two_links import HIDDEN, log, motion, ran, write_log
from tests.report.test_view_page import floats


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the page's commands have run."""
    return ran(tmp_path_factory.mktemp("page"), PAGES["docs/export.md"])


def test_the_page_of_a_joint_shows_the_robot_moving(folder):
    """What the joint moves as measured beside its model, which is nearer with the cogging than without."""
    page = json.loads((folder / "found" / "report.json").read_text())
    moving = next(section for section in page["sections"] if section["key"] == "moving")["blocks"][0]
    apart = {run["name"]: rms(floats(run["apart"])) for run in moving["runs"]}
    assert apart["weakly coupled"] < 0.2 * apart["weakly coupled, without the effects found"]
    assert [joint["of"] for body in moving["robot"]["bodies"] for joint in body["joints"]] == [1, 0]


def test_the_joints_hidden_physics_is_recovered(folder):
    found = json.loads((folder / "found" / "diagnosis.json").read_text())
    (cogging,) = found["effects"]
    assert (found["verdict"], cogging["name"]) == ("explained", "cogging_torque")
    assert cogging["parameters"]["amplitude"]["value"] == pytest.approx(HIDDEN.cogging, rel=0.03)
    for name, true, share in (
        ("armature", HIDDEN.armature, 0.01),
        ("viscous_friction_coefficient", HIDDEN.viscous, 0.03),
        ("coulomb_friction_torque", HIDDEN.coulomb, 0.03),
    ):
        assert found["parameters"][name]["value"] == pytest.approx(true, rel=share), name


def test_the_exported_arm_moves_as_the_log(folder, tmp_path):
    """As closely as the same MJCF with the true values, held and driven by the same noisy log."""
    exported, columns, (_, _, elbow) = (folder / "robot_id.xml").read_text(), log(), motion()
    true = f'armature="{HIDDEN.armature}" damping="{HIDDEN.viscous}" frictionloss="{HIDDEN.coulomb}"'
    truth = re.sub(r'armature="\S+" damping="\S+" frictionloss="\S+"', true, exported)
    truth = re.sub(r'biasprm="[^"]+"', f'biasprm="{-HIDDEN.cogging} {HIDDEN.harmonic} 0"', truth)
    assert truth != exported
    (tmp_path / "truth.xml").write_text(truth)
    gaps = [
        float(np.sqrt(np.mean((followed(path, columns, 0.044) - elbow[1]) ** 2)))
        for path in (folder / "robot.xml", folder / "robot_id.xml", tmp_path / "truth.xml")
    ]
    print(f"\nRMS off the true speed: as it was {gaps[0]:.3g}, exported {gaps[1]:.4g}, true values {gaps[2]:.4g} rad/s")
    assert gaps[1] < 1.05 * gaps[2]
    assert gaps[1] < 5e-3


def test_the_replay_says_what_is_left(folder):
    table = np.genfromtxt(folder / "replay.csv", delimiter=",", names=True)
    left = table["torque_Nm"] - table["torque_simulated_Nm"]
    assert np.sqrt(np.nanmean(left**2)) < 0.025


def test_the_pages_examples_run(folder, monkeypatch):
    monkeypatch.chdir(folder)
    names = run_examples("docs/export.md")
    assert names["data"].qvel[1] != 0.0
    np.testing.assert_allclose(names["batch"].qvel[:, 1], names["batch"].qvel[0, 1])


def test_a_joint_is_checked_against_what_it_was(folder, monkeypatch):
    """Of one log the baseline, of another motion's and noise's the check; then of a joint with more friction."""
    monkeypatch.chdir(folder)
    plain = replace(HIDDEN, cogging=0.0)
    worn, asked = replace(plain, coulomb=1.3 * HIDDEN.coulomb), ("--baseline", "elbow.toml")
    for hidden, seed, more, status in (
        (plain, 0, ("--update", "--without-names"), 0),
        (plain, 5, (), 0),
        (worn, 6, (), 3),
    ):
        write_log(Path("new.csv"), log(hidden, seed=seed))
        assert bench("check", "new.csv", "--mjcf", "robot.xml", "--joint", "elbow", *asked, *more).status == status


#: How several joints are refused where one is meant.
SEVERAL = "--mjcf robot.xml --joint shoulder --joint elbow --out robot_id`"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ("identify log.csv --mjcf robot.xml", "--joint: missing"),
        ("identify log.csv --rig rig.toml --joint elbow", "--joint: found without --mjcf"),
        ("identify log.csv --mjcf robot.xml --joint elbow --at shoulder", "has no ="),
        ("identify log.csv --mjcf robot.xml --joint elbow --at wrist=0", "NAME one of shoulder"),
        ("identify log.csv --mjcf robot.xml --joint shoulder --joint elbow", SEVERAL),
        ("diagnose log.csv --mjcf robot.xml --joint shoulder --joint elbow", SEVERAL),
        ("replay found/model.toml log.csv --mjcf robot.xml --joint shoulder --joint elbow --out x.csv", SEVERAL),
        ("check log.csv --mjcf robot.xml --joint shoulder --joint elbow --baseline x.toml --update", SEVERAL),
        ("export found/model.toml --mjcf robot.xml --joint shoulder --joint elbow --out x.xml", "found one model for"),
        ("check --simulated found/model.toml --joint elbow --baseline x.toml", "--simulated: found with --mjcf"),
        ("export found/model.toml --out x.xml", "one of them"),
        ("export found/model.toml --mjcf robot.xml --out x.xml", "--joint: missing; allowed: shoulder, elbow"),
        ("export found/model.toml --mjcf robot.xml --joint elbow --armature some --out x.xml", "allowed: motor, all"),
        ("export found/model.toml --mjcf robot.xml --joint elbow --armature motor --out x.xml", "without the motor's"),
        ("export found/model.toml --mjcf robot.xml --joint elbow --out robot.xml", "is an input of this command"),
        ("export robot.xml --snippet --out x.xml", "not TOML"),
    ],
)
def test_wrong_input_is_one_line(folder, monkeypatch, arguments, says):
    monkeypatch.chdir(folder)
    done = bench(*shlex.split(arguments))
    assert (done.status, says in done.err, done.err.count("\n")) == (2, True, 1), done.err
