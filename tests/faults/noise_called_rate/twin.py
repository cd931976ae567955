"""Small motion at 333 Hz whose reported speed and torque are mostly noise, beside a fine position."""

from pathlib import Path

import numpy as np

from tests.sines import sines

INERTIA, VISCOUS, COULOMB = 0.06, 0.05, 0.02
RIG = """name = "joint"
kind = "rotary"
[trace.columns]
time = "time [s]"
position = "position [rad]"
velocity = "velocity [rad/s]"
torque = "torque [N*m]"
"""


def write_log(folder: Path, time, position, velocity, torque, count: float, noise: tuple, seed: int) -> None:
    """`log.csv` with noise of velocity and torque - rad/s, N*m - and a position in counts - rad -, and `rig.toml`."""
    rng = np.random.default_rng(seed)
    noisy = (values + size * rng.normal(size=time.size) for values, size in zip((velocity, torque), noise, strict=True))
    table = np.column_stack([time, np.round(position / count) * count, *noisy])
    np.savetxt(folder / "log.csv", table, "%.6f", ",", header="time,position,velocity,torque", comments="")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")


def write(folder: Path) -> None:
    time = np.arange(0.0, 14.0, 0.003)
    position, velocity, acceleration = sines(time, [(0.1, 0.35, 0.0), (0.02, 1.4, 0.7), (0.004, 3.1, 2.1)])
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity)
    write_log(folder, time, position, velocity, torque, 1e-4, (0.2, 0.1), 4)
