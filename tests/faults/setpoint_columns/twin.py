"""Measured signals next to set-points, limits, errors and efficiencies, in five ways to name them."""

import numpy as np

from tests.faults.drive import drive

NAMES = {
    "german.csv": "Zeit [s];v_soll [rad/s];v_ist [rad/s];M_soll [Nm];M_ist [Nm];Wirkungsgrad [%]",
    "compound.csv": "Zeit [s];Drehzahlsollwert [rad/s];Drehzahlistwert [rad/s];Sollmoment [Nm];Istmoment [Nm];eta [%]",
    "english.csv": "Time [s];Target Velocity [rad/s];Actual Velocity [rad/s];Torque Limit [Nm];Torque [Nm];Use [%]",
    "paths.csv": "time [s];target.velocity [rad/s];axis.velocity [rad/s];torque_error [Nm];torque_act [Nm];Power [W]",
    "short.csv": "t [s];cmd [rad/s];act [rad/s];M_ref [Nm];M [Nm];Torque utilization [%]",
}


def write(folder):
    time, _, velocity, torque = drive(1.5e-3, 8e-4, 0.06, 1.0)
    rows = np.column_stack([time, np.roll(velocity, -20), velocity, 2.0 * torque[::-1], torque, 80.0 + 0.0 * time])
    for name, head in NAMES.items():
        np.savetxt(folder / name, rows, "%.7g", ";", header=head, comments="")
