"""An MJCF compared with a log."""

from types import SimpleNamespace

import pytest

from bench.joints.grade import graded
from bench.parameter import Parameter
from bench.plant.robot import Robot, joint_rig
from bench.report.grade import BADGE, TABLE, grade_json, grade_section
from bench.rig.rig import Load

MJCF = """<mujoco><worldbody><body name="arm"><joint name="a|b" axis="0 1 0" armature="0.1" damping="1.8"
frictionloss="0.6" stiffness="2"/><geom type="capsule" fromto="0 0 0 0 0 1" size="0.05"/></body></worldbody></mujoco>"""


def measured(unit, value, half):
    return Parameter(value, unit, half / 1.96, (value - half, value + half))


@pytest.fixture
def grades(tmp_path):
    """Grades of one joint behind a gear of three, by parameters on the motor's side and names of effects."""
    (tmp_path / "arm.xml").write_text(MJCF)
    rig = joint_rig(None, Robot.of(tmp_path / "arm.xml", "a|b"))
    rig = rig.model_copy(update={"load": (rig.load or Load()).model_copy(update={"gear_ratio": 3.0})})

    def holding(parameters, *effects, verdict="explained"):
        named = [
            SimpleNamespace(name=name, effect=SimpleNamespace(spring=name == "torsion_spring")) for name in effects
        ]
        diagnosis = SimpleNamespace(effects=named, verdict=verdict)
        joint = SimpleNamespace(rig=rig, parameters=parameters, diagnosis=diagnosis, servo=None, verdict=verdict)
        return graded(tmp_path / "arm.xml", {"a|b": joint}, stand=False)

    return holding


def test_friction_goes_through_the_gear_once_and_viscous_friction_twice(grades):
    """Damping of the joint is 3**2 times that of the motor, dry friction 3 times; the armature is on its side."""
    joint = grades(
        {
            "armature": measured("kg*m**2", 0.105, 0.001),
            "viscous_friction_coefficient": measured("N*m*s/rad", 0.2, 0.001),
            "coulomb_friction_torque": measured("N*m", 0.2, 0.001),
        },
        "torsion_spring",
    )["a|b"]
    assert [number.found.value for number in joint.numbers.values()] == pytest.approx([0.105, 1.8, 0.6])
    assert (joint.agrees, joint.lacks) == (True, ())  # the MJCF has a spring, and armatures differ by a twentieth


@pytest.mark.parametrize(
    ("value", "half", "near"), [(0.1, 0.001, True), (0.115, 0.001, False), (0.13, 0.05, True), (0.088, 0.001, False)]
)
def test_a_number_agrees_within_its_interval_and_a_tenth(grades, value, half, near):
    joint = grades({"armature": measured("kg*m**2", value, half)})["a|b"]
    assert (joint.numbers["armature"].near, joint.agrees) == (near, near)
    assert joint.numbers["damping"].near is None


def test_missing_effects_are_listed_with_and_without_a_name(grades):
    grade = grades({"armature": measured("kg*m**2", 0.1, 0.01)}, "cogging_torque", verdict="unexplained_remainder")
    assert grade["a|b"].lacks == ("cogging_torque", "unknown effect")
    assert grade["a|b"].agrees is False
    assert grade_json(grade)["a|b"]["armature"]["agrees"] is True


def test_its_files_are_a_table_of_one_row_a_joint_and_a_badge(grades):
    section = grade_section(grades({"armature": measured("kg*m**2", 0.2, 0.001)}), "arm.xml")
    files = {file.name: file.content for block in section.blocks if block.kind == "downloads" for file in block.files}
    assert "| a&#124;b | 0.1, log: 0.2000\xa0±\xa00.0010 | 1.8, log: not determined |" in files[TABLE]
    assert "0 of 1 joints" in files[BADGE]


def test_without_a_value_there_is_no_grade(grades):
    assert grades({})["a|b"].agrees is None
    assert "no joint determined" in str(grade_section(grades({}), "arm.xml"))
