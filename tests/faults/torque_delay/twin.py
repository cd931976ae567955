"""A torque that acts 10 ms, which is two and a half samples, after it is reported."""

from __future__ import annotations

from pathlib import Path

from tests.faults.pendulum import swung, write_log

PERIOD, DELAY = 4e-3, 1e-2


def write(folder: Path) -> None:
    """`log.csv` and `robot.xml`."""
    acting = swung(DELAY, PERIOD)
    write_log(folder, swung(period=PERIOD), acting.link + acting.drive)
