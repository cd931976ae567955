"""What a drive is told, as tables in its own units: those that its recorder speaks, as the rig's columns name them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.export.feedforward import Feedforward, TorqueTable
from bench.rig.rig import Rig
from bench.trace.channel import split_label
from bench.trace.signals import scale_in, unit_on


@dataclass(frozen=True)
class Unit:
    """How a drive counts a signal.

    Attributes:
        text: its unit, as written.
        factor: SI per one of it, negative where it counts the other way round.
    """

    text: str
    factor: float

    @classmethod
    def of(cls, rig: Rig, signal: str) -> Unit:
        """Of a signal: as the rig's `[trace.columns]` has it, else SI.

        Raises:
            InputError: the rig's column has a unit that is none of the signal's.
        """
        label = rig.trace.columns.get(signal, "")
        unit = split_label(label)[1] or unit_on(rig.axis_kind, signal)
        factor = scale_in(signal, unit, f"{rig.source}: trace.columns.{signal}").factor
        return cls(unit, -factor if label.startswith("-") else factor)


@dataclass(frozen=True)
class DriveUnits:
    """Units of a drive.

    Attributes:
        rig: of the axis, whose torque constant makes currents of torques.
        position, velocity, current: how the drive counts them.
    """

    rig: Rig
    position: Unit
    velocity: Unit
    current: Unit

    @classmethod
    def of(cls, rig: Rig) -> DriveUnits:
        """As a rig tells them; InputError where a unit is none of its signal's."""
        return cls(rig, Unit.of(rig, "position"), Unit.of(rig, "velocity"), Unit.of(rig, "current"))

    def currents(self, torque: Array) -> Array | None:
        """Currents that give torques - the drive's unit - (n,); None where the rig knows no torque constant."""
        constant = self.rig.motor.torque_per_ampere
        return None if constant is None else constant.current(torque) / self.current.factor

    def table(self, name: str, unit: Unit, table: TorqueTable) -> str:
        """A table as CSV, in the order of the drive's own count."""
        coordinate, currents = table.coordinate / unit.factor, self.currents(table.torque)
        columns = [coordinate, table.torque] + ([] if currents is None else [currents])
        head = [f"{name} [{unit.text}]", f"{self.rig.axis_kind.effort} [{self.rig.effort_unit}]"]
        head += [] if currents is None else [f"current [{self.current.text}]"]
        rows = np.column_stack(columns)[np.argsort(coordinate, kind="stable")]
        return "\n".join([",".join(head), *(",".join(f"{value:.9g}" for value in row) for row in rows.tolist())]) + "\n"

    def inertia(self, feedforward: Feedforward) -> Iterator[tuple[str, float, str]]:
        """The inertia's feed-forward: name, value and unit."""
        yield "inertia_feedforward", feedforward.inertia, self.rig.axis_kind.inertia_unit
        constant = self.rig.motor.torque_per_ampere
        if constant is not None:
            per = feedforward.inertia / constant.constant / self.current.factor * self.velocity.factor
            yield "current_per_acceleration", per, f"{self.current.text}/({self.velocity.text}/s)"

    def files(self, feedforward: Feedforward) -> dict[str, str]:
        """Names and texts of the files that hold all of it."""
        rows = [f"{name},{value:.9g},{unit}" for name, value, unit in self.inertia(feedforward)]
        return {
            "inertia.csv": "\n".join(["name,value,unit", *rows]) + "\n",
            "friction.csv": self.table("velocity", self.velocity, feedforward.friction),
            "cogging.csv": self.table("position", self.position, feedforward.cogging),
        }
