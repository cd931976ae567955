"""A torque that is reported 1.4 times too large, of a joint whose link the MJCF has right."""

from __future__ import annotations

from pathlib import Path

from tests.faults.pendulum import swung, write_log

SCALE = 1.4


def write(folder: Path) -> None:
    """`log.csv` and `robot.xml`."""
    motion = swung()
    write_log(folder, motion, SCALE * (motion.link + motion.drive))
