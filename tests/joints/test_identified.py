"""One joint among the links of an MJCF: its cut-off, its noise floor, its delay, and an armature without bias."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

import bench
from bench.diagnosis.diagnosis import diagnose
from bench.effects.catalogue import catalogue
from bench.effects.elastic_coupling import EFFECT as ELASTIC
from bench.fit.fit import fit
from bench.fit.hypothesis import Term, plain
from bench.fit.rows import Rows
from bench.fit.solution import Floor
from bench.plant.robot import Robot, joint_rig, read_log
from tests.export.two_links import HIDDEN, MJCF, log, motion, sensed, shoulder_torque, write_log
from tests.shared import SHARED, needs_shared
from tests.studies.whole_robots import ROBOTS, hidden
from tests.studies.whole_robots import write_log as write_robot_log

PLAIN = replace(HIDDEN, cogging=0.0)
#: By which signals are late in time - s.
LATE = 0.015


def trace_of(mjcf, joint, logged):
    """Trace and rig of a joint."""
    robot = Robot.of(mjcf, joint)
    rig = joint_rig(None, robot)
    return read_log(logged, rig, robot, {}), rig


@pytest.fixture
def read(tmp_path):
    """Reads columns as a log of a joint of the arm; its trace and rig."""

    def reading(columns, joint="elbow"):
        (tmp_path / "arm.xml").write_text(MJCF)
        return trace_of(tmp_path / "arm.xml", joint, write_log(tmp_path / "log.csv", columns))

    return reading


def delayed(columns, *names, by=LATE):
    time = columns["time [s]"]
    return columns | {name: np.interp(time - by, time, columns[name]) for name in names}


def test_where_other_joints_lag_identify_and_diagnose_take_the_cut_off_at_which_the_inertia_stands_still(read):
    columns = delayed(log(PLAIN), "shoulder.position [rad]", "shoulder.velocity [rad/s]")
    trace, rig = read(columns)
    by_identify = bench.identify(trace, rig)["armature"]
    by_diagnose = diagnose(trace, rig, excluded=frozenset(catalogue())).parameters["armature"]
    for found in (by_identify, by_diagnose):
        assert found.ci95[0] < PLAIN.armature < found.ci95[1]
    assert by_diagnose.value == pytest.approx(by_identify.value, abs=0.1 * by_identify.half_width)


def test_where_the_cut_off_is_lowered_gaps_before_and_after_are_of_the_same_rows(read):
    """Noise of the shoulder's speed is in the known torque: without an effect nothing is removed from the gap."""
    columns, rng = log(PLAIN), np.random.default_rng(3)
    columns["shoulder.velocity [rad/s]"] += 0.02 * rng.normal(size=columns["time [s]"].size)
    found = diagnose(*read(columns), excluded=frozenset(catalogue()))
    assert any("moves with the filter's cut-off" in warning for warning in found.warnings)
    assert found.torque.identify[0] == found.torque.identify[1]


@pytest.mark.parametrize("joint", ["shoulder", "elbow"])
def test_the_residual_of_a_joint_that_is_explained_wholly_is_the_floor(read, joint):
    """The shoulder's inertia is largest where the MJCF stands: counted twice, its floor was a tenth too high.

    The share explained is that of the measured torque, most of which the links' is.
    """
    trace, rig = read(log(PLAIN), joint)
    found = bench.identify(trace, rig)
    assert found.residual.rms / found.residual.noise_floor == pytest.approx(1.0, abs=0.03)
    assert found.explained == pytest.approx(1.0 - found.residual.rms**2 / np.var(trace["torque"]), abs=2e-4)


def test_noise_of_the_known_torque_that_changes_with_the_pose_is_in_the_floor(read):
    """A forearm that unfolds: of the inertia by which it has the shoulder's speed the RMS is 1.6 times the median."""
    time, shoulder, (angle, speed, acceleration) = motion()
    unfolds = angle + np.pi * (1.0 - time / time[-1]), speed - np.pi / time[-1], acceleration
    left = bench.identify(*read(sensed(time, shoulder, unfolds, PLAIN))).residual
    assert left.rms / left.noise_floor == pytest.approx(1.0, abs=0.03)


def test_noise_of_the_known_torque_stays_on_a_link_that_hangs_loose(read):
    """The motor feels none of it where the spring is so soft that the link does not follow."""
    rows = Rows.of(*read(log(PLAIN), "shoulder"))
    found = fit(rows, plain(rows).plus(Term(ELASTIC, (1e-2, 0.1))))
    theta = found.theta.copy()
    theta[found.owners == 0] = rows.stretches[0].signals.link_inertia
    loud = replace(rows, conditioning=replace(rows.conditioning, known_noise=100.0 * rows.conditioning.known_noise))
    white = [Floor(one, found.hypothesis, found.layout, theta, found.left).white for one in (rows, loud)]
    assert rows.conditioning.known_noise > 0.0
    assert white[1] == pytest.approx(white[0], rel=1e-3)


@pytest.mark.slow
def test_a_coupling_that_damps_noise_of_a_coarse_encoder_is_not_named(tmp_path):
    """12 bit at 200 Hz: half of the elbow's noise is that of its link's acceleration, which a soft gear filters."""
    robot, rng = ROBOTS["desktop_arm"], np.random.default_rng([2, 6])
    of, path = hidden(robot, rng, 6), tmp_path / "arm.xml"
    path.write_text(robot.mjcf(6))
    write_robot_log(tmp_path / "log.csv", robot, mujoco.MjModel.from_xml_path(str(path)), of, rng, 6000)
    others = frozenset(catalogue()) - {"cogging_torque", "elastic_coupling", "backlash"}
    assert diagnose(*trace_of(path, "joint_2", tmp_path / "log.csv"), excluded=others).names == ["cogging_torque"]


def shifts(trace, rig):
    """What is said of torque and motion that are not in step."""
    return [warning for warning in bench.identify(trace, rig).warnings if "the torque acts" in warning]


@needs_shared
def test_friction_that_a_model_lacks_is_no_delay():
    """A double pendulum's torque and motion are in step; a shift of -12 ms takes a sixth of what is left of it."""
    folder = SHARED / "data" / "robots" / "dfki_double_pendulum"
    assert not shifts(*trace_of(folder / "A0.xml", "Joint2", folder / "A0_20220812-061705.csv.gz"))


@pytest.mark.parametrize("late", [0.0, 0.012, -0.012])
def test_a_delay_that_is_there_is_reported(read, late):
    warnings = shifts(*read(delayed(log(PLAIN), "elbow.torque [N*m]", by=late)))
    assert bool(warnings) is (late != 0.0)
    side = "before it is reported" if late > 0.0 else "after it is reported"
    assert all(each.startswith("the torque acts 12 ± ") and side in each for each in warnings)


ARMATURE, VISCOUS, COULOMB, BENT, SEEDS = 0.02, 0.3, 0.4, 1.5, 5
#: Noise of a speed - rad/s -, and of angles where speed is recorded and where it is not - rad.
LOUD, ROUGH = 0.1, {"velocity": 1e-3, "position": 4e-4}


def noisy(seed, recorded):
    """Columns of an arm whose motion is as noisy as its acceleration is large."""
    rng = np.random.default_rng(seed)
    time, (q1, w1, a1), (q2, w2, a2) = motion(period=2e-3)
    torque = shoulder_torque(q1, w1, a1, q2 + BENT, w2, a2) + ARMATURE * a1 + VISCOUS * w1 + COULOMB * np.sign(w1)
    columns = {"time [s]": time, "shoulder.torque [N*m]": torque + 1e-2 * rng.standard_normal(time.size)}
    for name, position, velocity in (("shoulder", q1, w1), ("elbow", q2 + BENT, w2)):
        columns[f"{name}.position [rad]"] = position + ROUGH[recorded] * rng.standard_normal(time.size)
        if recorded == "velocity":
            columns[f"{name}.velocity [rad/s]"] = velocity + LOUD * rng.standard_normal(time.size)
    return columns


@pytest.mark.parametrize("recorded", ["velocity", "position"])
def test_noise_of_the_motion_does_not_move_the_armature(read, recorded):
    """Noise of the joint's speed is in the acceleration and, by the links' inertia less that of the MJCF's
    configuration, in the known torque. Their covariance moves an estimate that does not count it by
    -(M - M_0)*N/(G - N), N/G the share of noise in the power of the acceleration: here 0.008 kg*m**2 of 0.02.
    """
    found = np.array(
        [
            bench.identify(*read(noisy(seed, recorded), "shoulder"), 12.0).parameters["armature"].value
            for seed in range(SEEDS)
        ]
    )
    assert abs(found.mean() - ARMATURE) < 3.0 * found.std(ddof=1) / np.sqrt(SEEDS)
