"""Behind soft or loose gears a link lags behind its motor; behind the gear a torque sensor has no rotor in it."""

from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.diagnosis.policy import POLICY
from bench.effects.catalogue import catalogue
from bench.errors import UndeterminedError
from bench.fit.fit import fit
from bench.fit.hypothesis import Term, plain
from bench.fit.rows import Rows
from bench.joints.identified import JointLogs, identified
from bench.plant.robot import Robot, joint_rig, read_along
from bench.trace.signals import KNOWN_INERTIA, KNOWN_MOMENTUM, KNOWN_SLOPE, KNOWN_TORQUE
from tests.export.two_links import HIDDEN, MJCF, log, write_log
from tests.joints import ur5e

SOFT = 3


@pytest.fixture(scope="module")
def soft(tmp_path_factory):
    """MJCF, log of the motors, motion of the links, and by how much the soft one is ahead of its motor."""
    folder = tmp_path_factory.mktemp("soft")
    (folder / "arm.xml").write_text(ur5e.mjcf())
    time, q, w, a = ur5e.motion(6.0)
    ahead, omega = 0.02, 2.0 * np.pi * 8.0
    twist = ahead * np.sin(omega * time), ahead * omega * np.cos(omega * time)
    q[:, SOFT], w[:, SOFT], a[:, SOFT] = q[:, SOFT] + twist[0], w[:, SOFT] + twist[1], a[:, SOFT] - omega**2 * twist[0]
    columns = {"time [s]": time}
    for k, name in enumerate(ur5e.NAMES):
        own = (q[:, k] - twist[0], w[:, k] - twist[1]) if k == SOFT else (q[:, k], w[:, k])
        signals = ("position [rad]", "velocity [rad/s]", "torque [N*m]")
        columns |= {f"{name}.{signal}": values for signal, values in zip(signals, (*own, q[:, k]), strict=True)}
    write_log(folder / "log.csv", columns)
    return folder, (time, q, w, a), twist


def read(folder, name, twists):
    robot = replace(Robot.of(folder / "arm.xml", name), twists=twists)
    trace, _ = read_along(folder / "log.csv", joint_rig(None, robot), robot, {})
    return robot, trace


@pytest.mark.parametrize("joint", [1, 2, 4])
def test_neighbours_feel_the_link_where_it_is(soft, joint):
    folder, (time, q, w, a), twist = soft
    name, own = ur5e.NAMES[joint], ur5e.NAMES[SOFT]
    true = ur5e.asked(q, w, a)[:, joint]

    def wrong(twists):
        robot, trace = read(folder, name, twists)
        known = trace[KNOWN_TORQUE] + np.gradient(trace[KNOWN_MOMENTUM], time) + robot.inertia * a[:, joint]
        return np.abs(known - true)[5:-5].max() / np.abs(true).max()

    assert wrong({own: (time, *twist)}) < 2e-3 < 5e-3 < wrong({})


def test_a_soft_joint_feels_its_own_link_where_it_is(soft):
    """Known torque as its motor has it, and what the coupling's column has of the twist."""
    folder, (time, q, w, a), (angle, rate) = soft
    true, omega = ur5e.asked(q, w, a)[:, SOFT], 2.0 * np.pi * 8.0
    robot, trace = read(folder, ur5e.NAMES[SOFT], {ur5e.NAMES[SOFT]: (time, angle, rate)})
    known = trace[KNOWN_TORQUE] + np.gradient(trace[KNOWN_MOMENTUM], time) + trace[KNOWN_SLOPE] * angle
    own = robot.inertia * a[:, SOFT] + np.gradient(trace[KNOWN_INERTIA] * rate, time)
    assert np.abs(known + own - true)[5:-5].max() < 2e-3 * np.abs(true).max()
    assert np.abs(robot.inertia * omega**2 * angle).max() > 0.1 * np.abs(true).max()


def test_what_is_behind_a_soft_gear_is_the_links(soft):
    folder, _, _ = soft
    robot, trace = read(folder, ur5e.NAMES[SOFT], {})
    rows = Rows.of(trace, joint_rig(None, robot))
    found = fit(rows, plain(rows).plus(Term(catalogue()["elastic_coupling"], (50.0, 0.1))))
    assert found.strengths(0) == pytest.approx([robot.inertia])


@pytest.mark.parametrize(("offset", "known"), [(0.01, False), (0.3, True)])
def test_a_weak_offset_is_not_told_from_links_off_their_encoder(soft, offset, known):
    """One degree of links that weigh 1.4 N*m at the first wrist is 0.02 N*m."""
    folder, (_, q, w, a), _ = soft
    robot, trace = read(folder, ur5e.NAMES[SOFT], {})
    torque = ur5e.asked(q, w, a)[:, SOFT] + 0.1 * a[:, SOFT] + w[:, SOFT] + np.sign(w[:, SOFT]) + offset
    rows = Rows.of(trace.with_signals({"torque": torque}, {}), joint_rig(None, robot))
    named = fit(rows, plain(rows).plus(Term(catalogue()["torque_offset"])))
    assert POLICY.only_misplaces(named) is not known


@pytest.mark.parametrize("joint", range(6))
def test_known_torque_and_momentum_are_those_of_newton_and_euler(soft, joint):
    robot, rng, step = Robot.of(soft[0] / "arm.xml", ur5e.NAMES[joint]), np.random.default_rng(1), 1e-5
    q, w, a = rng.uniform(-1.5, 1.5, (3, 50, 6))
    ahead, behind = (robot.rest(q + side * step * w, w + side * step * a)[1] for side in (1.0, -1.0))
    found = robot.rest(q, w)[0] + (ahead - behind) / (2.0 * step) + robot.inertia * a[:, joint]
    assert found == pytest.approx(ur5e.asked(q, w, a)[:, joint], abs=1e-7)


def test_the_slope_of_the_known_torque_is_that_of_the_links(soft):
    folder, (_, q, w, _), _ = soft
    step, still = 1e-5 * (np.arange(6) == 1), np.zeros_like(w)
    ahead, behind = (ur5e.asked(q + side * step, still, still)[:, 1] for side in (1.0, -1.0))
    expected = (ahead - behind) / 2e-5
    slope = Robot.of(folder / "arm.xml", ur5e.NAMES[1]).slope(q, still)
    assert slope == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())


VISCOUS, COULOMB, RATIO = 0.06, 0.4, 50.0
RIG = {"name": "arm", "kind": "rotary", "joints": {"elbow": {"torque": "joint side", "gear_ratio": RATIO}}}


def light(behind_rotor):
    """A recording of a joint whose links weigh next to nothing, and its rig."""
    rng, time = np.random.default_rng(0), 2e-3 * np.arange(6000)
    phase = 2.0 * np.pi * np.array([0.2, 0.53, 0.9])[:, None] * time
    speed = (np.array([1.0, 0.6, 0.3])[:, None] * np.sin(phase)).sum(axis=0)
    torque = VISCOUS * speed + COULOMB * np.sign(speed)
    noisy = {"velocity [rad/s]": speed, "torque [N*m]": torque}
    noisy = {name: values + 0.01 * rng.standard_normal(time.size) for name, values in noisy.items()}
    rig = bench.Rig.of({"name": "wrist", "kind": "rotary", "load": {}})
    load = rig.load.model_copy(update={"link_inertia": 1e-6, "behind_rotor": behind_rotor})
    return bench.Trace.from_arrays({"time [s]": time, **noisy}), rig.model_copy(update={"load": load})


def test_friction_stands_where_the_inertia_may_be_nothing():
    with pytest.raises(UndeterminedError, match="inertia cannot be determined"):
        bench.identify(*light(behind_rotor=False))
    found = bench.identify(*light(behind_rotor=True))
    assert found["coulomb_friction_torque"].value == pytest.approx(COULOMB, rel=0.01)
    assert found["viscous_friction_coefficient"].value == pytest.approx(VISCOUS, rel=0.03)
    assert "armature" not in found.parameters


def test_the_joints_torque_stands_beside_the_motors_angle(tmp_path):
    """Of a drive that counts turns of the motor and has a torque sensor behind the gear."""
    columns = log(replace(HIDDEN, armature=0.0, cogging=0.0))
    for signal in ("position [rad]", "velocity [rad/s]"):
        columns[f"elbow.{signal}"] = RATIO * columns[f"elbow.{signal}"]
    (tmp_path / "arm.xml").write_text(MJCF)
    logged = write_log(tmp_path / "log.csv", columns)
    found = identified(JointLogs("elbow", tmp_path / "arm.xml", (logged,), rig=bench.Rig.of(RIG)))
    beyond = found.diagnosis.parameters  # friction of the link's own bearing, which is in such a torque
    assert beyond["coulomb_friction_torque"].value * RATIO == pytest.approx(HIDDEN.coulomb, rel=0.02)
    assert beyond["viscous_friction_coefficient"].value * RATIO**2 == pytest.approx(HIDDEN.viscous, rel=0.02)
    for name in ("armature", "viscous_friction_coefficient", "coulomb_friction_torque"):
        assert "on the joint's side" in found.refused[name]
        assert name not in found.parameters
    assert found.model is None
