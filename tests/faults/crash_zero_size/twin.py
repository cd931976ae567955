"""A small servo that swings a weight: 12-bit position, 200 Hz, friction that follows the transmitted torque."""

from pathlib import Path

import numpy as np

from tests.sines import sines

MASS, LEVER, RADIUS = 0.17, 0.14, 0.001
ARMATURE, VISCOUS, COULOMB, FOLLOWS = 0.0018, 0.008, 0.01, 0.15
ROBOT = f"""<mujoco><option gravity="0 0 -9.81"/><worldbody><body name="l">
<joint name="j" type="hinge" axis="0 1 0"/>
<geom type="sphere" size="{RADIUS}" pos="0 0 {-LEVER}" mass="{MASS}"/>
</body></worldbody></mujoco>
"""


def write(folder: Path) -> None:
    time = np.arange(0.0, 30.0, 0.005)
    position, velocity, acceleration = sines(time, [(1.0, 0.3, 0.0), (0.62, 1.1, 0.7), (0.33, 2.3, 2.1)])
    inertia = ARMATURE + MASS * (LEVER**2 + 0.4 * RADIUS**2)
    load = inertia * acceleration + VISCOUS * velocity + MASS * 9.81 * LEVER * np.sin(position)
    transmitted = load + COULOMB * np.sign(velocity)
    torque = transmitted / (1.0 - FOLLOWS * np.sign(velocity * transmitted))
    rng = np.random.default_rng(3)
    step = 2.0 * np.pi / 4096
    columns = (
        time,
        np.round(position / step) * step,
        velocity + 0.02 * rng.normal(size=time.size),
        torque + 0.003 * rng.normal(size=time.size),
    )
    head = "time [s],j.position [rad],j.velocity [rad/s],j.torque [N*m]"
    np.savetxt(folder / "log.csv.gz", np.column_stack(columns), "%.8g", ",", header=head, comments="")
    (folder / "robot.xml").write_text(ROBOT, encoding="utf-8")
