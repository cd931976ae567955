"""A joint that was stated to stand, and moved: by the torque of the one beside it, Lagrange's equations written out."""

import numpy as np
import pytest

from bench.gate.gate import gate
from bench.plant.robot import Robot, joint_rig, read_log
from tests.export.two_links import HIDDEN, MJCF, elbow_torque, motion, waves, write_log

STATED = 0.3


def stands(t):
    return 0.0 * t + STATED, 0.0 * t, 0.0 * t


def swings(t):
    return waves(t, (0.5, 0.12), (0.31, 1.3), (0.2, 1.1))


def is_moved_once(t):
    return STATED + 0.4 * (t > 6.0), 0.0 * t, 0.0 * t


#: What the elbow's own may be beside a shoulder that stands, of time, angle, speed, acceleration and torque - N*m.
OWN = {
    "nothing": lambda t, q, w, a, torque: 0.0,
    "cogging": lambda t, q, w, a, torque: 1.0 * np.sin(7.0 * q),
    "Stribeck": lambda t, q, w, a, torque: 0.6 * np.sign(w) * np.exp(-((w / 0.5) ** 2)),
    "a drag": lambda t, q, w, a, torque: 0.1 * w * np.abs(w),
    "friction by position": lambda t, q, w, a, torque: 0.3 * np.sign(w) * np.sin(q),
    "friction by load": lambda t, q, w, a, torque: 0.2 * np.sign(w) * np.abs(torque),
    "a stop": lambda t, q, w, a, torque: 1.5 * q**3,
    "another gain": lambda t, q, w, a, torque: 0.2 * torque,
    "a drift": lambda t, q, w, a, torque: -0.15 * torque * t / t[-1],
    "warming": lambda t, q, w, a, torque: -0.5 * np.sign(w) * t / t[-1],
    "another inertia": lambda t, q, w, a, torque: 0.03 * a,
    "a push": lambda t, q, w, a, torque: 0.8 * ((t > 5.0) & (t < 5.3)),
    "a delay": lambda t, q, w, a, torque: np.interp(t - 0.02, t, torque) - torque,
}


def checked(folder, shoulder, more=OWN["nothing"], arm=MJCF):
    """The check of a log of the elbow alone, with the noise of its sensors."""
    rng, (time, _, elbow) = np.random.default_rng(1), motion(14.0, 5e-3)
    torque = elbow_torque(*shoulder(time), *elbow) + HIDDEN.torque(*elbow)
    torque = torque + more(time, *elbow, torque) + 1e-2 * rng.standard_normal(time.size)
    seen = (
        values + noise * rng.standard_normal(time.size) for values, noise in zip(elbow[:2], (5e-5, 2e-3), strict=True)
    )
    names = ("time [s]", "elbow.position [rad]", "elbow.velocity [rad/s]", "elbow.torque [N*m]")
    (folder / "arm.xml").write_text(arm)
    log = write_log(folder / "log.csv", dict(zip(names, (time, *seen, torque), strict=True)))
    robot = Robot.of(folder / "arm.xml", "elbow")
    rig = joint_rig(None, robot)
    checks = gate(read_log(log, rig, robot, {"shoulder": STATED}), rig).checks
    return next(check for check in checks if check.name == "neighbours_stand")


@pytest.mark.parametrize("shoulder", [swings, is_moved_once])
def test_a_joint_that_moved_is_asked_about(tmp_path, shoulder):
    found = checked(tmp_path, shoulder)
    assert found.status == "warn"
    assert "next to shoulder at 0.3 rad, as stated" in found.found
    assert "one of these moved, or something else pushed" in found.advice


@pytest.mark.parametrize("own", OWN)
def test_what_is_the_joints_own_is_not_taken_for_another_that_moved(tmp_path, own):
    found = checked(tmp_path, stands, OWN[own])
    assert found.status == "pass"
    assert found.found == "stated, not seen: shoulder at 0.3 rad"


def test_a_joint_whose_motion_would_not_be_felt_is_not_asked_about(tmp_path):
    """Without weight, as about a vertical axis, where it stands does not matter to the other."""

    def pushed(t, *_):
        return 0.5 * (t > 6.0)

    assert checked(tmp_path, stands, pushed).status == "warn"
    weightless = MJCF.replace('gravity="0 0 -9.81"', 'gravity="0 0 0"')
    assert weightless != MJCF
    assert checked(tmp_path, stands, pushed, weightless).status == "pass"
