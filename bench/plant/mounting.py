"""Mounting of an axis: what a model on the motor's side needs to be put onto a joint of a robot."""

from __future__ import annotations

from dataclasses import dataclass, fields

from bench.rig.load import Load
from bench.rig.rig import Rig


@dataclass(frozen=True)
class Mounting:
    """Gear and load of an axis.

    Attributes:
        gear_ratio: motor turns per turn of the joint; 1 without a gear.
        load_mass: of the disk on the joint - kg; None where the rig does not tell.
        link_inertia: part of the model's inertia that is the links' of a robot, on the joint's side - kg*m**2 (kg).
    """

    gear_ratio: float = 1.0
    load_mass: float | None = None
    link_inertia: float = 0.0

    @classmethod
    def of(cls, rig: Rig) -> Mounting:
        """As a rig describes it."""
        load = rig.load or Load()
        return cls(float(load.gear_ratio), load.disk_mass, load.link_inertia or 0.0)

    @property
    def stated(self) -> dict[str, float]:
        """Values other than those of an axis without gear and robot, by name - SI."""
        return {f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) != f.default}


#: Of an axis without gear and robot, and of an unknown load.
DIRECT = Mounting()
