"""The torque of the rest of a robot, against the Newton-Euler equations of `tests/joints/ur5e.py`."""

import numpy as np
import pytest

from bench.plant.robot import Robot
from tests.joints import ur5e


@pytest.mark.parametrize("joint", range(6))
def test_known_torque_and_momentum_are_those_of_newton_and_euler(tmp_path, joint):
    (tmp_path / "arm.xml").write_text(ur5e.mjcf())
    robot, rng, step = Robot.of(tmp_path / "arm.xml", ur5e.NAMES[joint]), np.random.default_rng(1), 1e-5
    q, w, a = rng.uniform(-1.5, 1.5, (3, 50, 6))
    ahead, behind = (robot.rest(q + side * step * w, w + side * step * a)[1] for side in (1.0, -1.0))
    found = robot.rest(q, w)[0] + (ahead - behind) / (2.0 * step) + robot.inertia * a[:, joint]
    assert found == pytest.approx(ur5e.asked(q, w, a)[:, joint], abs=1e-7)
