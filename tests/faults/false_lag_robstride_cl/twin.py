"""A joint with a constant offset and a noisy torque: no lag and no drift have a size there."""

from pathlib import Path

import numpy as np

from tests.faults.noise_called_rate.twin import write_log
from tests.sines import sines

INERTIA, COULOMB, OFFSET = 0.002, 0.11, -0.147


def write(folder: Path) -> None:
    time = np.arange(0.0, 16.0, 0.003)
    position, velocity, acceleration = sines(time, [(0.9, 0.2, 0.0), (0.25, 0.6, 0.7), (0.12, 1.9, 2.1)])
    torque = INERTIA * acceleration + COULOMB * np.sign(velocity) + OFFSET
    write_log(folder, time, position + 0.9, velocity, torque, 4e-4, (0.05, 0.05), 6)
