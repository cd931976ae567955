"""`bench robot` of logs with goals and no effort: known gains, what the MJCF gets, and what is refused or doubted."""

import json

import mujoco
import numpy as np
import pytest

from bench.errors import InputError
from bench.joints.goals import by_goals, drive_of, with_gains, with_one_delay
from bench.joints.identified import JointLogs
from bench.joints.robot import robot
from bench.report.robot import robot as document_of
from bench.servos.commanded import Delay, Gains, shared
from tests.command import bench as command
from tests.studies.quadruped import KD, KP, hidden, joints_of, mjcf, moved, write_log

LEG = ("FL",)
HIP, THIGH, CALF = joints_of(LEG)
#: Reached for a part of the log - N*m.
LIMIT = 2.2


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    """The folder with logs and MJCFs of a leg, and what its joints have."""
    folder, rng = tmp_path_factory.mktemp("leg"), np.random.default_rng(11)
    of = hidden(3, rng)
    write_log(folder / "log.csv", moved(of, rng, 12.0, LEG), LEG)
    write_log(folder / "limited.csv", moved(of, rng, 6.0, LEG, limit=1.2), LEG)
    write_log(folder / "some.csv", moved(of, np.random.default_rng(5), 12.0, LEG, limit=LIMIT), LEG)
    (folder / "robot.xml").write_text(mjcf(LEG), encoding="utf-8")
    (folder / "bare.xml").write_text(mjcf(LEG, actuators=False), encoding="utf-8")
    return folder, of


def thigh(folder, gains, log="log.csv"):
    """The thigh by a log with these gains."""
    asked = JointLogs(THIGH, folder / "robot.xml", (folder / log,), goals=True, gains=gains)
    return with_one_delay({THIGH: by_goals(asked)})[THIGH]


@pytest.fixture(scope="module")
def found(leg):
    """The folder that the command writes for a joint whose gains the MJCF states."""
    folder, _ = leg
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = command("robot", "log.csv", "--mjcf", "robot.xml", "--joint", THIGH, "--out", "found")
    assert done.status == 0, done.err
    return folder / "found"


def test_all_parameters_of_a_joint_are_found(leg, found):
    _, of = leg
    joint = json.loads((found / "robot.json").read_text(encoding="utf-8"))["joints"][THIGH]
    assert "force_limit" not in joint["parameters"]
    for name, truth in of.items():
        low, high = joint["parameters"][name]["ci95"]
        assert abs(joint["parameters"][name]["value"] - truth[1]) < high - low, name
    assert joint["parameters"]["dead_time"]["value"] == pytest.approx(of["dead_time"][1], abs=0.3e-3)
    assert joint["parameters"]["armature"]["value"] == pytest.approx(of["armature"][1], rel=0.04)
    assert joint["verdict"] == "nothing_missing"
    assert "misalignment" not in joint["parameters"]


def test_the_mjcf_has_the_delay_and_the_friction(leg, found):
    _, of = leg
    text = (found / "robot_id.xml").read_text(encoding="utf-8")
    model = mujoco.MjModel.from_xml_string(text)
    (drive,) = (k for k in range(model.nu) if model.actuator_trnid[k, 0] == model.joint(THIGH).id)
    assert model.actuator_gainprm[drive, 0] == pytest.approx(KP)
    assert model.actuator_biasprm[drive, :3] == pytest.approx([0.0, -KP, -KD])
    assert model.actuator_delay[drive] == pytest.approx(of["dead_time"][1], abs=0.3e-3)
    assert model.joint(THIGH).frictionloss[0] == pytest.approx(of["coulomb_friction_torque"][1], rel=0.03)
    assert "not carried: joint bias" in text
    assert "not carried: static friction" in text


def test_gains_that_are_given_replace_those_of_the_mjcf(leg):
    folder, of = leg
    work = [JointLogs(CALF, folder / "bare.xml", (folder / "log.csv",))]
    (asked,) = with_gains(work, KP, {CALF: KD})
    one = with_one_delay({CALF: by_goals(asked)})[CALF]
    assert one.parameters["armature"].value == pytest.approx(of["armature"][2], rel=0.04)
    assert one.parameters["joint_bias"].value == pytest.approx(of["joint_bias"][2], abs=1e-4)


def test_gains_that_are_too_large_are_doubted_by_the_weight_of_the_links(leg):
    one = thigh(leg[0], Gains(1.2 * KP, KD))
    (doubt,) = (text for text in one.warnings if "with these gains the links weigh" in text)
    assert float(doubt.split("kp is ")[1].split()[0]) == pytest.approx(KP, rel=0.03)


def test_friction_below_zero_is_refused(leg):
    one = thigh(leg[0], Gains(KP, KD + 0.4))
    assert "another robot's" in one.refused["viscous_friction_coefficient"]
    assert "viscous_friction_coefficient" not in one.parameters


def test_a_limit_that_nobody_stated_is_found_with_what_it_disturbs(leg):
    folder, of = leg
    asked = JointLogs(HIP, folder / "robot.xml", (folder / "some.csv",), goals=True, gains=Gains(KP, KD))
    one = with_one_delay({HIP: by_goals(asked)})[HIP]
    limit = one.parameters["force_limit"]
    assert limit.unit == "N*m" and abs(limit.value - LIMIT) < limit.half_width < 0.15 * LIMIT
    for name in ("armature", "viscous_friction_coefficient", "coulomb_friction_torque"):
        assert abs(one.parameters[name].value - of[name][0]) < 2.0 * one.parameters[name].half_width, name
    assert drive_of(one).limit == limit.value


def test_a_limit_that_is_nearly_always_reached_is_refused(leg):
    one = thigh(leg[0], Gains(KP, KD), "limited.csv")
    assert not one.parameters
    assert "force limit" in one.refused["effects"]


@pytest.fixture(scope="module")
def fitted(leg):
    """The folder that the command writes for a joint of a floating robot whose gains nobody states."""
    folder, _ = leg
    text = (folder / "bare.xml").read_text(encoding="utf-8")
    floating = text.replace('<inertial pos="0 0 0" mass="6.9"', '<freejoint/><inertial pos="0 0 0" mass="6.9"')
    (folder / "floating.xml").write_text(floating, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = command(
            "robot", "log.csv", "--mjcf", "floating.xml", "--stand", "--joint", CALF, "--out", "fitted", "--grade"
        )
    assert done.status == 0, done.err
    return folder / "fitted"


def test_gains_that_are_not_known_are_fitted(leg, fitted):
    joint = json.loads((fitted / "robot.json").read_text(encoding="utf-8"))["joints"][CALF]
    truth = {"kp": KP, "dead_time": leg[1]["dead_time"][2], "armature": leg[1]["armature"][2]}
    truth["coulomb_friction_torque"] = leg[1]["coulomb_friction_torque"][2]
    for name, value in truth.items():
        low, high = joint["parameters"][name]["ci95"]
        assert low <= value <= high, name
    assert joint["parameters"]["kp"]["value"] == pytest.approx(KP, rel=0.01)
    (both,) = joint["inseparable"]
    low, high = both["ci95"]
    assert low <= KD + leg[1]["viscous_friction_coefficient"][2] <= high
    assert "viscous_friction_coefficient" in joint["refused"]


def test_the_mjcf_and_what_trains_policies_have_fitted_gains(leg, fitted):
    model = mujoco.MjModel.from_xml_string((fitted / "robot_id.xml").read_text(encoding="utf-8"))
    joint = json.loads((fitted / "robot.json").read_text(encoding="utf-8"))["joints"][CALF]
    assert model.nu == 1
    assert model.actuator_gainprm[0, 0] == pytest.approx(joint["parameters"]["kp"]["value"], rel=1e-5)
    assert -model.actuator_biasprm[0, 2] == pytest.approx(joint["parameters"]["kv"]["value"], rel=1e-5)
    assert model.joint(CALF).armature[0] == pytest.approx(leg[1]["armature"][2], rel=0.02)
    assert model.joint(CALF).frictionloss[0] == pytest.approx(leg[1]["coulomb_friction_torque"][2], rel=0.02)
    for name in ("mjlab.py", "isaaclab.py"):
        assert f"stiffness={joint['parameters']['kp']['value']:.6g}" in (fitted / name).read_text(encoding="utf-8")


def test_joints_of_known_and_of_unknown_gains_answer_together(leg):
    folder, _ = leg
    found = robot(folder / "log.csv", folder / "bare.xml", joints=[HIP, CALF], kp={HIP: KP}, kd={HIP: KD})
    assert [*found.drives] == [*found.actuators] == [HIP, CALF]
    assert found.drives[HIP].kp == KP != found.drives[CALF].kp
    answers = document_of(found, "leg").answers
    for question in ("How sure?", "Does it move like the axis now?", "What next?"):
        assert HIP in answers[question] and CALF in answers[question]
    assert f"{CALF}: kp 4" in answers["Gains?"] and HIP not in answers["Gains?"]


def test_gains_of_several_payloads_have_to_be_known(leg):
    folder, _ = leg
    both = {folder / "some.csv": folder / "bare.xml"}
    asked = JointLogs(CALF, folder / "robot.xml", (folder / "log.csv", folder / "some.csv"), goals=True, mjcfs=both)
    assert f"--kp {CALF}=40 --kd {CALF}=1 with yours, or one MJCF" in by_goals(asked).failed


@pytest.mark.parametrize(
    ("options", "says"),
    [(("--kd", "1"), "found no --kp"), (("--kp", "elbow=4"), "names no joint"), (("--kp", "-3"), "kp and the limit")],
)
def test_gains_that_no_joint_has_are_one_line(leg, monkeypatch, options, says):
    monkeypatch.chdir(leg[0])
    done = command("robot", "log.csv", "--mjcf", "bare.xml", "--out", "none", *options)
    assert (done.status, done.err.strip().count("\n")) == (2, 0)
    assert says in done.err


def test_gains_next_to_an_effort_are_bad_input(tmp_path, leg):
    text = (leg[0] / "log.csv").read_text(encoding="utf-8").replace(f"{HIP}.goal [rad]", f"{HIP}.torque [N*m]")
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    work = [JointLogs(HIP, leg[0] / "robot.xml", (tmp_path / "log.csv",))]
    with pytest.raises(InputError, match="has efforts"):
        with_gains(work, KP, None)


def test_delays_of_joints_are_weighted_and_kept_apart_where_they_differ():
    near = shared([Delay(0.010, 1e-10), Delay(0.01001, 4e-10)])
    assert near.value == pytest.approx(0.010002)
    assert near.variance == pytest.approx(0.8e-10)
    assert shared([Delay(0.010, 1e-10), Delay(0.012, 1e-10)]) is None
    assert shared([]) is None
