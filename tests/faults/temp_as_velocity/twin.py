"""Two axes, and two temperatures in C that never change."""

import numpy as np

from tests.faults.drive import drive


def write(folder):
    time, position, velocity, torque = drive(5e-4, 4e-3, 0.06, 1.0)
    _, other, speed, effort = drive(2e-3, 4e-3, 0.06, 1.0, turns=0.5, seed=2)
    rest = np.zeros((time.size, 2))
    names = [f"a{k} {signal}" for k in (1, 2) for signal in ("position [rad]", "velocity [rad/s]", "torque [Nm]")]
    head = ",".join(("time [s]", *names, "motor temp [C]", "housing temp [C]"))
    rows = np.column_stack([time, position, velocity, torque, other, speed, effort, rest])
    np.savetxt(folder / "log.csv", rows, "%.7g", ",", header=head, comments="")
