"""The document of a robot."""

from pathlib import Path

from bench.joints.identified import IdentifiedJoint
from bench.joints.robot import IdentifiedRobot
from bench.report.robot import robot


def test_a_warning_of_several_joints_is_listed_once():
    left_out = {"a": {"log": "no torque"}, "b": {"log": "no torque", "other": "too short"}, "c": {"log": "no torque"}}
    joints = {name: IdentifiedJoint(name, left_out=why) for name, why in left_out.items()}
    listed = robot(IdentifiedRobot(Path("robot.xml"), joints), "robot.xml").warnings
    assert listed == ("all joints: log is not used: no torque", "b: other is not used: too short")
    listed = robot(IdentifiedRobot(Path("robot.xml"), joints | {"d": IdentifiedJoint("d")}), "robot.xml").warnings
    assert listed == ("a, b, c: log is not used: no torque", "b: other is not used: too short")
