"""A torque that acts 5 ms, which is two and a half samples, after it is reported."""

from __future__ import annotations

from pathlib import Path

from tests.faults.pendulum import swung, write_log

DELAY = 5e-3


def write(folder: Path) -> None:
    """`log.csv` and `robot.xml`."""
    acting = swung(DELAY)
    write_log(folder, swung(), acting.link + acting.drive)
