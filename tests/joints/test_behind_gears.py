"""A link that a soft or loose gear lets lag behind its motor: what it asks of its neighbours is that of its own motion.

The truth is the Newton-Euler equations of `tests/joints/ur5e.py` along the links' motion; logs have the motors'.
"""

from dataclasses import replace

import numpy as np
import pytest

from bench.plant.robot import Robot, joint_rig, read_along
from bench.trace.signals import KNOWN_MOMENTUM, KNOWN_TORQUE
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
