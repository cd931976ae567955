"""An arm under gravity, whose holding torque is most of the torque."""

from pathlib import Path

import numpy as np

from tests.faults.noise_called_rate.twin import write_log
from tests.sines import sines

INERTIA, VISCOUS, COULOMB, WEIGHT = 0.07, 0.2, 0.15, 6.0


def write(folder: Path) -> None:
    time = np.arange(0.0, 14.0, 0.003)
    position, velocity, acceleration = sines(time, [(0.3, 0.13, 0.0), (0.05, 0.7, 0.7), (0.05, 1.9, 2.1)])
    position += 0.2
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity) - WEIGHT * np.sin(position)
    write_log(folder, time, position, velocity, torque, 4e-4, (0.02, 0.1), 4)
