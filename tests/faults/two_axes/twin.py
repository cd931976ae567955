"""Speed and torque of two axes in one table, in rpm and Nm, by a prefix of their names and by another."""

import numpy as np

from tests.faults.drive import drive


def write(folder):
    time, _, velocity, torque = drive(1.5e-3, 8e-4, 0.06, 1.0)
    _, _, slower, weaker = drive(3e-3, 8e-4, 0.05, 1.0, turns=0.5, seed=2)
    rpm = 30.0 / np.pi
    rows = np.column_stack([time, rpm * velocity, torque, rpm * slower, weaker])
    for name, prefixes in (("log.csv", "XY"), ("numbered.csv", ("A1", "A2"))):
        head = "Time," + ",".join(f"{one}.ActVel [rpm],{one}.ActTorque [Nm]" for one in prefixes)
        np.savetxt(folder / name, rows, "%.6f", ",", header=f"{head}\ns,rpm,Nm,rpm,Nm", comments="")
