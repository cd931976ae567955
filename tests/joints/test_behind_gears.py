"""A link that a soft or loose gear lets lag behind its motor: what it asks of its neighbours is that of its own motion.

The truth is the Newton-Euler equations of `tests/joints/ur5e.py` along the links' motion; logs have the motors'.
"""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.policy import POLICY
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Term, plain
from bench.fit.rows import Rows
from bench.plant.robot import Robot, joint_rig, read_along
from bench.trace.signals import KNOWN_INERTIA, KNOWN_MOMENTUM, KNOWN_SLOPE, KNOWN_TORQUE
from tests.export.two_links import write_log
from tests.joints import ur5e

SOFT = 3


@pytest.fixture(scope="module")
def log(tmp_path_factory):
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
def test_neighbours_feel_the_link_where_it_is(log, joint):
    folder, (time, q, w, a), twist = log
    name, own = ur5e.NAMES[joint], ur5e.NAMES[SOFT]
    true = ur5e.asked(q, w, a)[:, joint]

    def wrong(twists):
        robot, trace = read(folder, name, twists)
        known = trace[KNOWN_TORQUE] + np.gradient(trace[KNOWN_MOMENTUM], time) + robot.inertia * a[:, joint]
        return np.abs(known - true)[5:-5].max() / np.abs(true).max()

    assert wrong({own: (time, *twist)}) < 2e-3 < 5e-3 < wrong({})


def test_a_soft_joint_feels_its_own_link_where_it_is(log):
    """Known torque as its motor has it, and what the coupling's column has of the twist."""
    folder, (time, q, w, a), (angle, rate) = log
    true, omega = ur5e.asked(q, w, a)[:, SOFT], 2.0 * np.pi * 8.0
    robot, trace = read(folder, ur5e.NAMES[SOFT], {ur5e.NAMES[SOFT]: (time, angle, rate)})
    known = trace[KNOWN_TORQUE] + np.gradient(trace[KNOWN_MOMENTUM], time) + trace[KNOWN_SLOPE] * angle
    own = robot.inertia * a[:, SOFT] + np.gradient(trace[KNOWN_INERTIA] * rate, time)
    assert np.abs(known + own - true)[5:-5].max() < 2e-3 * np.abs(true).max()
    assert np.abs(robot.inertia * omega**2 * angle).max() > 0.1 * np.abs(true).max()


def test_what_is_behind_a_soft_gear_is_the_links(log):
    folder, _, _ = log
    robot, trace = read(folder, ur5e.NAMES[SOFT], {})
    rows = Rows.of(trace, joint_rig(None, robot))
    found = fit(rows, plain(rows).plus(Term(catalogue()["elastic_coupling"], (50.0, 0.1))))
    assert found.strengths(0) == pytest.approx([robot.inertia])


@pytest.mark.parametrize(("offset", "known"), [(0.01, False), (0.3, True)])
def test_a_weak_offset_is_not_told_from_links_off_their_encoder(log, offset, known):
    """One degree of links that weigh 1.4 N*m at the first wrist is 0.02 N*m."""
    folder, (_, q, w, a), _ = log
    robot, trace = read(folder, ur5e.NAMES[SOFT], {})
    torque = ur5e.asked(q, w, a)[:, SOFT] + 0.1 * a[:, SOFT] + w[:, SOFT] + np.sign(w[:, SOFT]) + offset
    rows = Rows.of(trace.with_signals({"torque": torque}, {}), joint_rig(None, robot))
    named = fit(rows, plain(rows).plus(Term(catalogue()["torque_offset"])))
    assert POLICY.only_misplaces(named) is not known


@pytest.mark.parametrize("joint", range(6))
def test_known_torque_and_momentum_are_those_of_newton_and_euler(log, joint):
    robot, rng, step = Robot.of(log[0] / "arm.xml", ur5e.NAMES[joint]), np.random.default_rng(1), 1e-5
    q, w, a = rng.uniform(-1.5, 1.5, (3, 50, 6))
    ahead, behind = (robot.rest(q + side * step * w, w + side * step * a)[1] for side in (1.0, -1.0))
    found = robot.rest(q, w)[0] + (ahead - behind) / (2.0 * step) + robot.inertia * a[:, joint]
    assert found == pytest.approx(ur5e.asked(q, w, a)[:, joint], abs=1e-7)


def test_the_slope_of_the_known_torque_is_that_of_the_links(log):
    folder, (_, q, w, _), _ = log
    step, still = 1e-5 * (np.arange(6) == 1), np.zeros_like(w)
    ahead, behind = (ur5e.asked(q + side * step, still, still)[:, 1] for side in (1.0, -1.0))
    expected = (ahead - behind) / 2e-5
    slope = Robot.of(folder / "arm.xml", ur5e.NAMES[1]).slope(q, still)
    assert slope == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())
