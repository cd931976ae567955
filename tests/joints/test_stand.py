"""Robots on a stand, with a floating base in their MJCF, and bodies whose meshes are not there."""

import mujoco
import pytest

from bench.errors import InputError
from bench.export.mjcf import robot_with
from bench.joints.robot import robot
from bench.plant.mjcf_file import read_mjcf
from bench.plant.robot import Robot
from tests.faults.robot_go2 import twin


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("legs")
    twin.write(found)
    return found


def test_a_floating_base_is_fixed_and_its_keyframes_are_left_out(folder):
    floating, fixed = (
        Robot.of(folder / f"{name}.xml", "hip", stand=name == "floating") for name in ("floating", "robot")
    )
    assert floating.names == fixed.names
    assert floating.inertia == pytest.approx(fixed.inertia, rel=1e-12)
    spec, notes = read_mjcf(folder / "floating.xml", stand=True)
    assert spec.compile().nkey == 0
    assert notes == ("'trunk' is fixed as on a stand, keyframes are omitted",)


def test_a_floating_base_is_refused_by_name_with_its_remedy(folder):
    with pytest.raises(
        InputError, match=r"body 'trunk': found a free or ball joint.*add `--stand` to bench robot or bench servo"
    ):
        Robot.of(folder / "floating.xml", "hip")


def test_a_robot_on_a_stand_is_identified_and_written(folder, tmp_path):
    found = robot(folder / "log.csv.gz", folder / "floating.xml", joints=["hip"], stand=True)
    armature, _, _, _ = twin.JOINTS["hip"]
    assert found.joints["hip"].parameters["armature"].value == pytest.approx(armature, rel=0.1)
    text, lines = found.with_joints(tmp_path / "robot_id.xml")
    model = mujoco.MjModel.from_xml_string(text)
    assert (model.njnt, model.nkey) == (2, 0)
    assert "'trunk' is fixed as on a stand, keyframes are omitted" in lines


def test_the_mjcf_keeps_a_base_that_floats_without_a_stand(folder, tmp_path):
    text, _ = robot_with(folder / "floating.xml", {}, tmp_path / "robot_id.xml")
    assert mujoco.MjModel.from_xml_string(text).njnt == 3


def test_a_mesh_that_is_not_there_matters_to_bodies_that_move_only(tmp_path):
    arm = '<body name="arm"><joint name="elbow" axis="0 1 0"/>{}</body>'
    base = f'<body name="base"><geom type="mesh" mesh="shell"/>{arm}</body>'
    text = '<mujoco><asset><mesh name="shell" file="shell.stl"/></asset><worldbody>{}</worldbody></mujoco>'
    path = tmp_path / "robot.xml"
    path.write_text(text.format(base.format('<geom size="0.1"/>')), encoding="utf-8")
    assert Robot.of(path, "elbow").inertia > 0.0
    assert "omitted from robot.xml: shell" in read_mjcf(path)[1][0]
    path.write_text(text.format(base.format('<geom type="mesh" mesh="shell"/>')), encoding="utf-8")
    with pytest.raises(InputError, match="the inertia of 'arm' is computed from it"):
        Robot.of(path, "elbow")
