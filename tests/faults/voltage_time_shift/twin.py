"""A DC gearmotor driven by a voltage that is held from one sample to the next, integrated with fine steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

INERTIA, VISCOUS, COULOMB = 0.031, 0.02, 0.12
TORQUE_CONSTANT, RESISTANCE = 1.6, 6.5
PERIOD, STEPS, SECONDS = 20e-3, 80, 40.0
COUNT = 2.0 * np.pi / 64.0

RIG = f"""name = "gearmotor"
kind = "rotary"
[motor]
torque_constant = "{TORQUE_CONSTANT} N*m/A"
resistance = "{RESISTANCE} ohm"
back_emf_constant = "{TORQUE_CONSTANT} V*s/rad"
"""


def recorded(seed: int) -> np.ndarray:
    """Time, voltage, position and velocity - s, V, rad, rad/s - at each sample (n, 4)."""
    rng = np.random.default_rng(seed)
    time = PERIOD * np.arange(round(SECONDS / PERIOD))
    levels = rng.uniform(-9.0, 9.0, time.size // 40)  # a new one every 0.8 s
    voltage = np.convolve(np.repeat(levels, 40), np.full(8, 0.125), "same")
    step, angle, speed, rows = PERIOD / STEPS, 0.0, 0.0, []
    for volts in voltage.tolist():
        rows.append((angle, speed))
        for _ in range(STEPS):
            torque = TORQUE_CONSTANT * (volts - TORQUE_CONSTANT * speed) / RESISTANCE - VISCOUS * speed
            free = speed + step * torque / INERTIA
            grip = step * COULOMB / INERTIA
            speed = free - min(max(free, -grip), grip)  # dry friction stops the axis at most
            angle += step * speed
    angle, speed = np.array(rows).T
    angle = COUNT * np.round(angle / COUNT)
    return np.column_stack([time, voltage, angle, speed + 0.05 * rng.standard_normal(time.size)])


def write(folder: Path) -> None:
    """`log.csv` and `rig.toml`."""
    header = "time [s],voltage [V],position [rad],velocity [rad/s]"
    np.savetxt(folder / "log.csv", recorded(3), "%.8g", ",", header=header, comments="")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
