"""Two motors of one make, at different speeds, whose lines alternate in one log."""

import numpy as np

from tests.faults.drive import drive


def write(folder):
    lines = ["time_ms,motor_id,pos (deg),vel (rpm),cur (mA)"]
    logs = {11: drive(0.02, 0.05, 0.15, 1.1, 30.0, 10e-3, 0.3), 12: drive(0.02, 0.05, 0.15, 1.1, 30.0, 10e-3, 0.2, 2)}
    for samples in zip(*(np.transpose(log) for log in logs.values()), strict=True):
        for motor, (time, position, velocity, current) in zip(logs, samples, strict=True):
            angle, speed = np.degrees(position), 30.0 / np.pi * velocity
            lines.append(f"{1e3 * time:.1f},{motor},{angle:.3f},{speed:.3f},{1e3 * current:.2f}")
    (folder / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
