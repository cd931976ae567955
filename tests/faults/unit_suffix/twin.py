"""An axis of 2.0e-3 A*s**2/rad whose columns carry their units as suffixes."""

import numpy as np

from tests.faults.drive import drive


def write(folder):
    time, position, velocity, current = drive(2e-4, 3e-4, 0.02, 0.1)
    table = np.column_stack([1e3 * time, np.degrees(position), 30.0 / np.pi * velocity, 1e3 * current])
    np.savetxt(
        folder / "log.csv", table, "%.6f", ",", header="time_ms,position_deg,velocity_rpm,current_ma", comments=""
    )
