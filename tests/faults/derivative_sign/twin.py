"""Position, speed and torque of two joints without a header: a speed's derivative is minus the other's position."""

import numpy as np


def write(folder):
    time = 0.005 * np.arange(4000)
    noise = np.random.default_rng(3).normal(size=(4, time.size))
    one, other = np.sin(2.0 * time) + 0.2 * np.sin(3.1 * time), np.sin(2.0 * time + 0.3) + 0.2 * np.sin(3.7 * time)
    rates = (np.gradient(values, time) for values in (one, other))
    columns = [values + 2e-3 * noise[k] for k, values in enumerate((one, other, *rates))]
    np.savetxt(folder / "log.csv", np.column_stack([*columns, np.cos(time), np.sin(5.0 * time)]), "%.5f", ",")
