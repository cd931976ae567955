"""A delay between torque and motion is reported where there is one, and not where something else is missing."""

from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.plant.robot import Robot, joint_rig, read_log
from tests.export.two_links import HIDDEN, MJCF, log, write_log
from tests.shared import SHARED, needs_shared


def apart(mjcf, joint, logged):
    """What is said of torque and motion that are apart."""
    robot = Robot.of(mjcf, joint)
    rig = joint_rig(None, robot)
    return [
        warning
        for warning in bench.identify(read_log(logged, rig, robot, {}), rig).warnings
        if "the torque acts" in warning
    ]


@needs_shared
def test_friction_that_a_model_lacks_is_no_delay():
    """A double pendulum's torque and motion are in step; a shift of -12 ms takes a sixth of what is left of it."""
    folder = SHARED / "data" / "robots" / "dfki_double_pendulum"
    assert not apart(folder / "A0.xml", "Joint2", folder / "A0_20220812-061705.csv.gz")


@pytest.mark.parametrize("late", [0.0, 0.012, -0.012])
def test_a_delay_that_is_there_is_reported(tmp_path, late):
    (tmp_path / "arm.xml").write_text(MJCF)
    columns = log(replace(HIDDEN, cogging=0.0))
    time, torque = columns["time [s]"], columns["elbow.torque [N*m]"]
    columns["elbow.torque [N*m]"] = np.interp(time - late, time, torque)
    warnings = apart(tmp_path / "arm.xml", "elbow", write_log(tmp_path / "log.csv", columns))
    assert bool(warnings) is (late != 0.0)
    side = "before it is reported" if late > 0.0 else "after it is reported"
    assert all(each.startswith("the torque acts 12 ± ") and side in each for each in warnings)
