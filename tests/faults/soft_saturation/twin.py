"""Three sines of speed in closed form; the sensor reports a current i as L*tanh(i/L)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

INERTIA, VISCOUS, COULOMB, TORQUE_CONSTANT = 1.5e-3, 8e-4, 0.06, 0.8
#: Frequency - Hz -, amplitude - rad/s - and phase - rad - of the speed's sines.
SINES = (0.37, 40.0, 0.3), (0.91, 25.0, 1.1), (1.7, 12.0, 2.0)
LIMIT = 1.5
RIG = f"""name = "axis"
kind = "rotary"
[motor]
torque_constant = "{TORQUE_CONSTANT} N*m/A"
peak_current = "10 A"
"""


def motion(time):
    """Position, speed and acceleration (n,) each."""
    rates = [(2.0 * np.pi * f, a, p) for f, a, p in SINES]
    position = sum(-a / r * np.cos(r * time + p) for r, a, p in rates)
    speed = sum(a * np.sin(r * time + p) for r, a, p in rates)
    return position, speed, sum(a * r * np.cos(r * time + p) for r, a, p in rates)


def write_axis(folder: Path, current_of, torque=lambda position: 0.0, seconds=8.0) -> None:
    """`log.csv` and `rig.toml` of an axis with another torque (position); `current_of(torque, speed)` is reported."""
    rng, time = np.random.default_rng(3), np.arange(0.0, seconds, 1e-3)
    position, speed, acceleration = motion(time)
    load = INERTIA * acceleration + VISCOUS * speed + COULOMB * np.sign(speed) + torque(position)
    current = current_of(load, speed) + 0.02 * rng.standard_normal(time.size)
    speed = speed + 0.03 * rng.standard_normal(time.size)
    header = "time [s],position [rad],velocity [rad/s],current [A]"
    table = np.column_stack([time, position, speed, current])
    np.savetxt(folder / "log.csv", table, "%.9g", ",", header=header, comments="")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")


def write(folder: Path) -> None:
    """`log.csv` and `rig.toml`."""
    write_axis(folder, lambda torque, speed: LIMIT * np.tanh(torque / TORQUE_CONSTANT / LIMIT))
