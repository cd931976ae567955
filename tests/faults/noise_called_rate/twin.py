"""Small motion at 333 Hz whose reported speed and torque are mostly noise, beside a fine position."""

from pathlib import Path

import numpy as np

INERTIA, VISCOUS, COULOMB = 0.06, 0.05, 0.02
RIG = """name = "joint"
kind = "rotary"
[trace.columns]
time = "time [s]"
position = "position [rad]"
velocity = "velocity [rad/s]"
torque = "torque [N*m]"
"""


def write(folder: Path) -> None:
    time = np.arange(0.0, 14.0, 0.003)
    position, velocity, acceleration = np.zeros((3, time.size))
    for amplitude, frequency, phase in ((0.1, 0.35, 0.0), (0.02, 1.4, 0.7), (0.004, 3.1, 2.1)):
        omega = 2.0 * np.pi * frequency
        position += amplitude * np.sin(omega * time + phase)
        velocity += amplitude * omega * np.cos(omega * time + phase)
        acceleration -= amplitude * omega**2 * np.sin(omega * time + phase)
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity)
    rng = np.random.default_rng(4)
    columns = (
        time,
        np.round(position / 1e-4) * 1e-4,
        velocity + 0.2 * rng.normal(size=time.size),
        torque + 0.1 * rng.normal(size=time.size),
    )
    head = "time,position,velocity,torque"
    np.savetxt(folder / "log.csv", np.column_stack(columns), "%.6f", ",", header=head, comments="")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
