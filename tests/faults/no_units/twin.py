"""A log of time, speed and current without units, in SI; and the same with its speed in deg/s."""

import numpy as np

from tests.faults.drive import drive


def write(folder):
    time, _, velocity, current = drive(1.5e-3, 8e-4, 0.06, 0.8)
    for name, scale in (("log.txt", 1.0), ("degrees.txt", 180.0 / np.pi)):
        table = np.column_stack([time, scale * velocity, current])
        np.savetxt(folder / name, table, "%.4f", "\t", header="my test rig\ntime\tvelocity\tcurrent", comments="# ")
