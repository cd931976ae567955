"""A joint that swings a point of 2 kg at 0.3 m, along a motion in closed form: what its link and its drive ask for."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from tests.sines import sines

MASS, LENGTH, GRAVITY = 2.0, 0.3, 9.81
ARMATURE, VISCOUS, COULOMB = 0.25, 2.0, 1.5
PERIOD, SECONDS, NOISE = 2e-3, 6.0, (2e-5, 3e-3, 0.02)

MJCF = f"""<mujoco><option gravity="0 0 -{GRAVITY}"/><worldbody><body name="l">
<joint name="j" type="hinge" axis="0 1 0" armature="0.2" damping="1" frictionloss="0.7"/>
<inertial pos="0 0 -{LENGTH}" mass="{MASS}" diaginertia="1e-9 1e-9 1e-9"/></body></worldbody>
<actuator><motor joint="j"/></actuator></mujoco>
"""


class Swung(NamedTuple):
    """The motion, and torque of the link and of the drive's own inertia and friction - s, rad, N*m - (n,) each."""

    time: np.ndarray
    angle: np.ndarray
    speed: np.ndarray
    link: np.ndarray
    drive: np.ndarray


def swung(ahead: float = 0.0, period: float = PERIOD) -> Swung:
    """By Lagrange's equation of a pendulum, a time `ahead` - s."""
    time = period * np.arange(round(SECONDS / period)) + ahead
    angle, speed, acceleration = sines(time, [(0.9, 0.4, 0.0), (0.35, 1.1, 1.0), (0.1, 2.3, 2.0)])
    link = MASS * LENGTH**2 * acceleration + MASS * GRAVITY * LENGTH * np.sin(angle)
    return Swung(time, angle, speed, link, ARMATURE * acceleration + VISCOUS * speed + COULOMB * np.sign(speed))


def write_log(folder: Path, motion: Swung, torque: np.ndarray) -> None:
    """`log.csv` with sensor noise, and `robot.xml`."""
    rng = np.random.default_rng(4)
    table = np.column_stack([motion.angle, motion.speed, torque])
    table += rng.standard_normal(table.shape) * NOISE
    header = "time [s],j.position [rad],j.velocity [rad/s],j.torque [N*m]"
    np.savetxt(folder / "log.csv", np.column_stack([motion.time, table]), "%.8g", ",", header=header, comments="")
    (folder / "robot.xml").write_text(MJCF, encoding="utf-8")
