"""The noise floor beside an MJCF: noise of the joint's own speed is in the known momentum, too, and counts once."""

from dataclasses import replace

import pytest

import bench
from bench.plant.robot import Robot, joint_rig, read_log
from tests.export.two_links import HIDDEN, MJCF, log, write_log


@pytest.mark.parametrize("joint", ["shoulder", "elbow"])
def test_what_is_left_of_a_joint_that_is_explained_wholly_is_the_floor(tmp_path, joint):
    """The shoulder's inertia is largest where the MJCF stands: counted twice, its floor was a tenth too high."""
    (tmp_path / "arm.xml").write_text(MJCF)
    logged = write_log(tmp_path / "log.csv", log(replace(HIDDEN, cogging=0.0)))
    robot = Robot.of(tmp_path / "arm.xml", joint)
    rig = joint_rig(None, robot)
    left = bench.identify(read_log(logged, rig, robot, {}), rig).residual
    assert left.rms / left.noise_floor == pytest.approx(1.0, abs=0.03)
