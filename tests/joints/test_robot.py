"""docs/robot.md: every joint of an arm from its log, and what one that fails leaves of the others."""

import json

import mujoco
import numpy as np
import pytest

import bench
from bench.arrays import rms
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.joints.identified import JointLogs, identified
from bench.plant.model_file import load_joints
from tests.diagnosis.command import started
from tests.docs.pages import PAGES
from tests.export.two_links import HIDDEN, MJCF, log, motion, ran, write_log
from tests.report.test_view_page import floats

#: All effects but that of the elbow.
OTHERS = frozenset(catalogue()) - {"cogging_torque"}
HAND = '<body name="hand" pos="0 0 -.3"><joint name="wrist" axis="0 1 0"/><geom size=".01" mass="1e-6"/></body>'


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """Where the page's commands have run: an arm, its log, and what came of them."""
    return ran(tmp_path_factory.mktemp("robot"), PAGES["docs/robot.md"])


def test_every_joint_has_its_physics(arm):
    found = json.loads((arm / "robot_id" / "robot.json").read_text())
    assert found["schema"] == "bench.robot/1"
    shoulder, elbow = found["joints"]["shoulder"], found["joints"]["elbow"]
    assert [effect["name"] for effect in elbow["effects"]] == ["cogging_torque"]
    assert elbow["verdict"] == "explained"
    for name, true in (("armature", HIDDEN.armature), ("coulomb_friction_torque", HIDDEN.coulomb)):
        assert elbow["parameters"][name]["value"] == pytest.approx(true, rel=0.01)
    low, high = shoulder["parameters"]["armature"]["ci95"]
    assert low < 0.0 < high, "the shoulder has nothing but its links"
    assert not shoulder["effects"]


def test_its_files_have_all_of_it(arm):
    joints = load_joints(arm / "robot_id" / "effects.toml")
    assert list(joints) == ["shoulder", "elbow"]
    assert [present.name for present in joints["elbow"].model.effects] == ["cogging_torque"]
    rows = json.loads((arm / "robot_id" / "report.json").read_text())["sections"][0]["blocks"][0]["rows"]
    assert [row[0] for row in rows] == ["shoulder", "elbow"]
    assert rows[1][-1].startswith("Cogging torque: > 9")
    model = mujoco.MjModel.from_xml_path(str(arm / "robot_id" / "robot_id.xml"))
    elbow = model.joint("elbow")
    assert elbow.armature[0] == pytest.approx(HIDDEN.armature, rel=0.01)
    assert elbow.frictionloss[0] == pytest.approx(HIDDEN.coulomb, rel=0.01)
    assert model.actuator("elbow cogging_torque 0").biasprm[1] == pytest.approx(HIDDEN.harmonic, rel=0.01)
    assert model.joint("shoulder").armature[0] < 1e-3


def test_the_page_shows_the_arm_moving_with_its_models(arm):
    """The ghost is the log; weakly coupled models stay near it, free-running ones drift."""
    page = json.loads((arm / "robot_id" / "report.json").read_text())
    moving, free = next(section for section in page["sections"] if section["key"] == "moving")["blocks"]
    time, shoulder, elbow = motion()
    at = moving["start"] + moving["step"] * np.arange(moving["count"])
    np.testing.assert_allclose(floats(moving["position"]), np.interp(at, time, shoulder[0]), atol=1e-3)
    (poses,) = moving["robot"]["poses"]
    np.testing.assert_allclose(floats(poses), np.interp(at, time, elbow[0]), atol=1e-3)
    runs = {run["name"]: floats(run["others"][0]) for run in moving["runs"]}
    assert list(runs) == [
        "weakly coupled",
        "weakly coupled, without the effects found",
        "restarted every 0.5 s",
        "restarted every 5 s",
    ]
    held, bare, often, seldom = (rms(one) for one in runs.values())
    assert held < 0.2 * bare
    assert held < 2e-3
    assert often < seldom < 0.05
    curves = {one["name"]: one for one in free["panels"][0]["series"]}
    assert list(curves) == ["shoulder", "elbow"]
    assert curves["elbow"]["x"][-1] == pytest.approx(5.0, abs=0.01)
    assert curves["elbow"]["y"][0] < 1e-6 < 1e-4 < curves["elbow"]["y"][-1]
    windows = at < 10.0  # two of them, whole
    assert rms(np.array(curves["elbow"]["y"])) == pytest.approx(rms(runs["restarted every 5 s"][windows]), rel=0.1)


@pytest.mark.usefixtures("worker_processes")
def test_a_joint_of_which_there_is_no_log_leaves_the_rest(arm, tmp_path):
    """A hand that nobody logged stands as stated; the elbow is as before, and of the wrist it is said what lacks."""
    ends = "</body></body></worldbody>"
    (tmp_path / "robot.xml").write_text(MJCF.replace(ends, HAND + ends))
    found = bench.robot(
        arm / "log.csv", tmp_path / "robot.xml", joints=["elbow", "wrist"], stated={"wrist": 0.0}, excluded=OTHERS
    )
    assert found.answered == ("elbow",)
    assert "joint 'wrist': has no column of its own" in found.joints["wrist"].failed
    assert found.joints["elbow"].parameters["armature"].value == pytest.approx(HIDDEN.armature, rel=0.01)


def test_a_log_in_which_the_joint_stands_is_left_out(arm, tmp_path):
    columns = log(seed=3)
    standing = columns["elbow.position [rad]"]
    columns["elbow.position [rad]"] = np.full_like(standing, 0.3)
    columns["elbow.velocity [rad/s]"] = np.zeros_like(standing)
    still = write_log(tmp_path / "still.csv", columns)
    found = identified(JointLogs("elbow", arm / "robot.xml", (still, arm / "log.csv"), excluded=OTHERS))
    assert list(found.left_out) == ["still.csv"]
    assert found.parameters["armature"].value == pytest.approx(HIDDEN.armature, rel=0.01)


def test_where_no_joint_can_be_answered_the_command_says_why(arm, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    columns = log()
    write_log(tmp_path / "torqueless.csv", {name: values for name, values in columns.items() if "torque" not in name})
    line = ("robot", "torqueless.csv", "--mjcf", str(arm / "robot.xml"), "--out", "none", "--json", "found.json")
    assert started(tmp_path)(*line) == 2
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert "none of the joints could be answered" in last
    assert not (tmp_path / "none").exists()
    assert json.loads((tmp_path / "found.json").read_text())["joints"]["elbow"]["failed"]


def test_a_joint_that_the_mjcf_does_not_have_is_named(arm):
    with pytest.raises(InputError, match="--joint elbov: found no hinge or slide of that name, did you mean 'elbow'"):
        bench.robot(arm / "log.csv", arm / "robot.xml", joints=["elbov"])
