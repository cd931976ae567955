"""The axis of `soft_saturation`, with a torque per ampere k_T*(1 - 0.05*(omega/70)**2)."""

from __future__ import annotations

from pathlib import Path

from tests.faults.soft_saturation.twin import TORQUE_CONSTANT, write_axis


def write(folder: Path) -> None:
    """`log.csv` and `rig.toml`."""
    write_axis(folder, lambda torque, speed: torque / TORQUE_CONSTANT / (1.0 - 0.05 * (speed / 70.0) ** 2))
