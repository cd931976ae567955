"""A joint whose recorded torque has nothing to do with its motion."""

from pathlib import Path

import numpy as np

ROBOT = """<mujoco><option gravity="0 0 -9.81"/><worldbody><body name="arm">
<joint name="J4" type="hinge" axis="0 1 0" armature="0.005" frictionloss="0.1"/>
<inertial pos="0 0 -0.15" mass="0.79" diaginertia="0.0105 0.006 0.016"/>
</body></worldbody></mujoco>
"""


def write(folder: Path) -> None:
    time = np.arange(0.0, 12.0, 0.003)
    rng = np.random.default_rng(5)
    position = 0.3 * np.sin(2.0 * np.pi * 0.7 * time) + 0.1 * np.sin(2.0 * np.pi * 1.9 * time)
    velocity = np.gradient(position, time)
    torque = 2.0 * np.cumsum(rng.normal(size=time.size)) / np.sqrt(time.size) + np.where(
        abs(time - 8.0) < 1.2, 3.0, 0.0
    )
    noise = 0.02 * rng.normal(size=time.size)
    columns = time, position, velocity + noise, torque + 0.05 * rng.normal(size=time.size)
    head = "time [s],J4.position [rad],J4.velocity [rad/s],J4.torque [N*m]"
    np.savetxt(folder / "log.csv.gz", np.column_stack(columns), "%.8g", ",", header=head, comments="")
    (folder / "robot.xml").write_text(ROBOT, encoding="utf-8")
