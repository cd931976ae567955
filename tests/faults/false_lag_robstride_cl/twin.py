"""A joint with a constant offset and a noisy torque: no lag and no drift have a size there."""

from pathlib import Path

import numpy as np

from tests.faults.noise_called_rate.twin import RIG

INERTIA, COULOMB, OFFSET = 0.002, 0.11, -0.147


def write(folder: Path) -> None:
    time, rng = np.arange(0.0, 16.0, 0.003), np.random.default_rng(6)
    position, velocity, acceleration = np.full(time.size, 0.9), *np.zeros((2, time.size))
    for amplitude, frequency, phase in ((0.9, 0.2, 0.0), (0.25, 0.6, 0.7), (0.12, 1.9, 2.1)):
        omega = 2.0 * np.pi * frequency
        position += amplitude * np.sin(omega * time + phase)
        velocity += amplitude * omega * np.cos(omega * time + phase)
        acceleration -= amplitude * omega**2 * np.sin(omega * time + phase)
    torque = INERTIA * acceleration + COULOMB * np.sign(velocity) + OFFSET
    columns = (
        time,
        np.round(position / 4e-4) * 4e-4,
        velocity + 0.05 * rng.normal(size=time.size),
        torque + 0.05 * rng.normal(size=time.size),
    )
    head = "time,position,velocity,torque"
    np.savetxt(folder / "log.csv", np.column_stack(columns), "%.6f", ",", header=head, comments="")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
