"""A recording in closed form, its model as a file, and the same file with values that are wrong."""

from pathlib import Path

import numpy as np

INERTIA, VISCOUS, COULOMB = 0.002, 0.001, 0.05
MODEL = """schema = "bench.model/1"
kind = "rotary"
name = "axis"
[parameters]
moment_of_inertia = "0.002 kg*m**2"
viscous_friction_coefficient = "0.001 N*m*s/rad"
coulomb_friction_torque = "0.05 N*m"
load_torque = "0.0 N*m"
motor_moment_of_inertia = "0.0002 kg*m**2"
[torque_balance]
recording = "log.csv"
filter_width = 0.002
mains = []
effort_step = 0.0
coefficients = [0.002, 0.001, 0.05, 0.0]
effects = []
"""
WRONG = {
    "huge.toml": ('"0.002 kg', '"1e300 kg'),
    "viscous.toml": ('"0.001 N', '"1e12 N'),
    "contrary.toml": ('"0.002 kg', '"0.01 kg'),
}


def write(folder: Path) -> None:
    time = np.arange(3000) * 1e-3
    velocity = 60.0 * np.sin(7.0 * time) + 20.0 * np.sin(31.0 * time)
    acceleration = 420.0 * np.cos(7.0 * time) + 620.0 * np.cos(31.0 * time)
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity)
    head = "time [s],velocity [rad/s],torque [N*m]"
    columns = np.column_stack([time, velocity, torque])
    np.savetxt(folder / "log.csv", columns, fmt="%.9g", delimiter=",", header=head, comments="")
    (folder / "rig.toml").write_text('name = "axis"\nkind = "rotary"\n', encoding="utf-8")
    (folder / "sound.toml").write_text(MODEL, encoding="utf-8")
    for name, (old, new) in WRONG.items():
        (folder / name).write_text(MODEL.replace(old, new), encoding="utf-8")
