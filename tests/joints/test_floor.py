"""The noise floor beside an MJCF: noise of the joint's own speed is in the known momentum, too, and counts once."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

import bench
from bench.effects.elastic_coupling import EFFECT as ELASTIC
from bench.fit.fit import fit
from bench.fit.hypothesis import Term, plain
from bench.fit.rows import Rows
from bench.fit.solution import Floor
from bench.plant.robot import Robot, joint_rig, read_log
from tests.export.two_links import HIDDEN, MJCF, log, motion, sensed, write_log
from tests.studies.whole_robots import ROBOTS, hidden
from tests.studies.whole_robots import write_log as write_robot_log


@pytest.mark.parametrize("joint", ["shoulder", "elbow"])
def test_what_is_left_of_a_joint_that_is_explained_wholly_is_the_floor(tmp_path, joint):
    """The shoulder's inertia is largest where the MJCF stands: counted twice, its floor was a tenth too high."""
    (tmp_path / "arm.xml").write_text(MJCF)
    logged = write_log(tmp_path / "log.csv", log(replace(HIDDEN, cogging=0.0)))
    robot = Robot.of(tmp_path / "arm.xml", joint)
    rig = joint_rig(None, robot)
    left = bench.identify(read_log(logged, rig, robot, {}), rig).residual
    assert left.rms / left.noise_floor == pytest.approx(1.0, abs=0.03)


def test_noise_of_the_known_torque_stays_on_a_link_that_hangs_loose(tmp_path):
    """The motor feels none of it where the spring is so soft that the link does not follow."""
    (tmp_path / "arm.xml").write_text(MJCF)
    logged = write_log(tmp_path / "log.csv", log(replace(HIDDEN, cogging=0.0)))
    robot = Robot.of(tmp_path / "arm.xml", "shoulder")
    rig = joint_rig(None, robot)
    rows = Rows.of(read_log(logged, rig, robot, {}), rig)
    found = fit(rows, plain(rows).plus(Term(ELASTIC, (1e-2, 0.1))))
    theta = found.theta.copy()
    theta[found.owners == 0] = rows.stretches[0].signals.link_inertia
    loud = replace(rows, conditioning=replace(rows.conditioning, known_noise=100.0 * rows.conditioning.known_noise))
    white = [Floor(one, found.hypothesis, found.layout, theta, found.left).white for one in (rows, loud)]
    assert rows.conditioning.known_noise > 0.0
    assert white[1] == pytest.approx(white[0], rel=1e-3)


def test_noise_of_the_known_torque_that_changes_with_the_pose_is_in_the_floor(tmp_path):
    """A forearm that unfolds: of the inertia by which it has the shoulder's speed the RMS is 1.6 times the median."""
    (tmp_path / "arm.xml").write_text(MJCF)
    time, shoulder, (angle, speed, acceleration) = motion()
    unfolds = angle + np.pi * (1.0 - time / time[-1]), speed - np.pi / time[-1], acceleration
    logged = write_log(tmp_path / "log.csv", sensed(time, shoulder, unfolds, replace(HIDDEN, cogging=0.0)))
    robot = Robot.of(tmp_path / "arm.xml", "elbow")
    rig = joint_rig(None, robot)
    left = bench.identify(read_log(logged, rig, robot, {}), rig).residual
    assert left.rms / left.noise_floor == pytest.approx(1.0, abs=0.03)


def test_a_coupling_that_damps_noise_of_a_coarse_encoder_is_not_named(tmp_path):
    """12 bit at 200 Hz: half of the elbow's noise is that of its link's acceleration, which a soft gear filters."""
    robot, rng = ROBOTS["desktop_arm"], np.random.default_rng([2, 6])
    of = hidden(robot, rng, 6)
    (tmp_path / "arm.xml").write_text(robot.mjcf(6))
    write_robot_log(tmp_path / "log.csv", robot, mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml")), of, rng, 6000)
    (joint,) = bench.robot(tmp_path / "log.csv", tmp_path / "arm.xml", joints="joint_2").joints.values()
    assert joint.diagnosis is not None
    assert joint.diagnosis.names == ["cogging_torque"]
