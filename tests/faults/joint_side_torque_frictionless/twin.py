"""A torque that is measured between gear and link: the link's alone, the drive's own inertia and friction not in it."""

from __future__ import annotations

from pathlib import Path

from tests.faults.pendulum import swung, write_log


def write(folder: Path) -> None:
    """`log.csv`, `robot.xml` and `rig.toml`."""
    motion = swung()
    write_log(folder, motion, motion.link)
    rig = 'name = "arm"\nkind = "rotary"\n[joints.j]\ntorque = "joint side"\n'
    (folder / "rig.toml").write_text(rig, encoding="utf-8")
