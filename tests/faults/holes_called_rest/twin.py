"""A sound motion of which a third of the samples is lost in holes."""

from pathlib import Path

import numpy as np

from tests.sines import sines


def write(folder: Path) -> None:
    time, rng = np.arange(0.0, 8.0, 0.005), np.random.default_rng(1)
    position, velocity, acceleration = sines(time, [(1.0, 0.3, 0.0), (0.6, 1.1, 0.7), (0.3, 2.3, 2.1)])
    torque = 0.005 * acceleration + 0.01 * velocity + 0.05 * np.sign(velocity) + 0.003 * rng.normal(size=time.size)
    columns = np.column_stack([time, position, velocity + 0.02 * rng.normal(size=time.size), torque])
    head = "time [s],position [rad],velocity [rad/s],torque [N*m]"
    np.savetxt(folder / "whole.csv", columns, "%.6f", ",", header=head, comments="")
    kept = np.arange(time.size) % 120 < 75
    np.savetxt(folder / "holes.csv", columns[kept], "%.6f", ",", header=head, comments="")
    (folder / "rig.toml").write_text('name = "x"\nkind = "rotary"\n', encoding="utf-8")
