"""A joint with Stribeck friction over 0.05 rad/s, which it passes within 25 ms of each reversal."""

import numpy as np

LINK, ARMATURE, DAMPING, FRICTION, RISE, SPEED = 0.54, 0.6, 4.0, 4.0, 3.0, 0.05
MJCF = """<mujoco><worldbody><body><joint name="elbow" axis="0 0 1"/>
<inertial pos="0 0 0" mass="2" diaginertia=".54 .54 .54"/></body></worldbody></mujoco>"""


def write(folder):
    rng, time = np.random.default_rng(2), 2e-3 * np.arange(10000)
    omega, amplitude, phase = np.array([[1.9, 3.1, 5.3], [0.6, 0.4, 0.2], [0.4, 1.3, 2.2]])[:, :, None]
    angle = omega * time + phase
    speed, acceleration = (amplitude * np.sin(angle)).sum(axis=0), (amplitude * omega * np.cos(angle)).sum(axis=0)
    position = (-amplitude / omega * np.cos(angle)).sum(axis=0)
    friction = FRICTION + RISE * np.exp(-((speed / SPEED) ** 2))
    torque = (LINK + ARMATURE) * acceleration + DAMPING * speed + friction * np.sign(speed)
    torque += 0.07 * rng.normal(size=time.size)
    table = np.column_stack([time, position, speed + 0.002 * rng.normal(size=time.size), torque])
    header = "time,elbow.position [rad],elbow.velocity [rad/s],elbow.torque [N*m]"
    np.savetxt(folder / "log.csv.gz", table, "%.7g", ",", header=header, comments="")
    (folder / "robot.xml").write_text(MJCF)
