"""The armature beside links whose inertia changes with the pose, from a motion as noisy as its acceleration is large.

Noise of the joint's speed is in the acceleration and, by the links' inertia less that in the configuration of the MJCF,
in the known torque, too. The covariance of both moves an estimate that does not count it by

    -(M - M_0)*N/(G - N),  N/G - share of noise in the power of the acceleration, G what of it is the inertia's own

here 0.008 kg*m**2 of 0.02: the elbow is bent, and the shoulder's inertia is largest where the arm is straight.
"""

import numpy as np
import pytest

import bench
from bench.plant.robot import Robot, joint_rig, read_log
from tests.export.two_links import MJCF, motion, shoulder_torque, write_log

ARMATURE, VISCOUS, COULOMB, BENT, SEEDS = 0.02, 0.3, 0.4, 1.5, 5
#: Noise of a speed - rad/s -, and of angles where speed is recorded and where it is not - rad.
LOUD, ROUGH = 0.1, {"velocity": 1e-3, "position": 4e-4}


def armature(folder, seed, recorded):
    """Of the shoulder - kg*m**2 -, at a cut-off that lets noise of the motion pass."""
    rng = np.random.default_rng(seed)
    time, (q1, w1, a1), (q2, w2, a2) = motion(period=2e-3)
    torque = shoulder_torque(q1, w1, a1, q2 + BENT, w2, a2) + ARMATURE * a1 + VISCOUS * w1 + COULOMB * np.sign(w1)
    columns = {"time [s]": time, "shoulder.torque [N*m]": torque + 1e-2 * rng.standard_normal(time.size)}
    for name, position, velocity in (("shoulder", q1, w1), ("elbow", q2 + BENT, w2)):
        columns[f"{name}.position [rad]"] = position + ROUGH[recorded] * rng.standard_normal(time.size)
        if recorded == "velocity":
            columns[f"{name}.velocity [rad/s]"] = velocity + LOUD * rng.standard_normal(time.size)
    (folder / "arm.xml").write_text(MJCF)
    robot = Robot.of(folder / "arm.xml", "shoulder")
    rig = joint_rig(None, robot)
    trace = read_log(write_log(folder / "log.csv", columns), rig, robot, {})
    return bench.identify(trace, rig, 12.0).parameters["armature"].value


@pytest.mark.parametrize("recorded", ["velocity", "position"])
def test_noise_of_the_motion_does_not_move_the_armature(tmp_path, recorded):
    found = np.array([armature(tmp_path, seed, recorded) for seed in range(SEEDS)])
    assert abs(found.mean() - ARMATURE) < 3.0 * found.std(ddof=1) / np.sqrt(SEEDS)
