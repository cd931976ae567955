"""Recordings at one steady speed each, with position and reported speed, as a map of friction asks for."""

from pathlib import Path

import numpy as np

VISCOUS, COULOMB, OFFSET = 0.5, 0.57, 0.02


def write(folder: Path) -> None:
    time, rng = np.arange(0.0, 2.0, 0.002), np.random.default_rng(2)
    (folder / "rig.toml").write_text('name = "joint"\nkind = "rotary"\n', encoding="utf-8")
    for speed in np.arange(0.2, 2.01, 0.2):
        for way in (1.0, -1.0):
            columns = (
                time,
                way * (VISCOUS * speed + COULOMB) + OFFSET + 0.02 * rng.normal(size=time.size),
                0.4 + way * speed * time,
                way * speed + 0.005 * rng.normal(size=time.size),
            )
            head = "time [s],torque [N*m],position [rad],velocity [rad/s]"
            path = folder / f"v{way * speed:+.1f}.csv"
            np.savetxt(path, np.column_stack(columns), "%.8g", ",", header=head, comments="")
