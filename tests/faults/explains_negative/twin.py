"""An arm under gravity, whose holding torque is most of the torque."""

from pathlib import Path

import numpy as np

from tests.faults.noise_called_rate.twin import RIG

INERTIA, VISCOUS, COULOMB, WEIGHT = 0.07, 0.2, 0.15, 6.0


def write(folder: Path) -> None:
    time = np.arange(0.0, 14.0, 0.003)
    position, velocity, acceleration = np.full(time.size, 0.2), *np.zeros((2, time.size))
    for amplitude, frequency, phase in ((0.3, 0.13, 0.0), (0.05, 0.7, 0.7), (0.05, 1.9, 2.1)):
        omega = 2.0 * np.pi * frequency
        position += amplitude * np.sin(omega * time + phase)
        velocity += amplitude * omega * np.cos(omega * time + phase)
        acceleration -= amplitude * omega**2 * np.sin(omega * time + phase)
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity) - WEIGHT * np.sin(position)
    rng = np.random.default_rng(4)
    columns = (
        time,
        np.round(position / 4e-4) * 4e-4,
        velocity + 0.02 * rng.normal(size=time.size),
        torque + 0.1 * rng.normal(size=time.size),
    )
    head = "time,position,velocity,torque"
    np.savetxt(folder / "log.csv", np.column_stack(columns), "%.6f", ",", header=head, comments="")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
