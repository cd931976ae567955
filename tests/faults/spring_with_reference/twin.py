"""Axes of a spring that rests at 0.3 rad, of an eccentric mass and of a constant torque, along sines in closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.sines import sines

INERTIA, VISCOUS, COULOMB = 0.4, 1.2, 1.5
SINES = (0.6, 0.23, 0.3), (0.3, 0.61, 1.1), (0.12, 1.3, 2.0)
TORQUES = {
    "spring": lambda position: 15.0 * (position - 0.3),
    "unbalance": lambda position: 6.0 * np.sin(position + 0.4),
    "offset": lambda position: 2.0 + 0.0 * position,
}


def write(folder: Path) -> None:
    """`spring.csv`, `unbalance.csv`, `offset.csv` and `rig.toml`."""
    time, rng = np.arange(0.0, 10.0, 2e-3), np.random.default_rng(5)
    position, speed, acceleration = sines(time, SINES)
    bare = INERTIA * acceleration + VISCOUS * speed + COULOMB * np.sign(speed)
    header = "time [s],position [rad],velocity [rad/s],torque [N*m]"
    for name, torque_of in TORQUES.items():
        noise = rng.standard_normal((3, time.size)) * np.array([[2e-5], [4e-3], [0.12]])
        table = np.column_stack([time, *(np.array([position, speed, bare + torque_of(position)]) + noise)])
        np.savetxt(folder / f"{name}.csv", table, "%.8g", ",", header=header, comments="")
    rig = 'name = "joint"\nkind = "rotary"\n[motor]\npeak_current = "1 A"\n'
    (folder / "rig.toml").write_text(rig, encoding="utf-8")
