"""The kinds of axis, rotary and linear: names and SI units of their quantities."""

from __future__ import annotations

from dataclasses import dataclass

from bench.errors import InputError
from bench.names import words
from bench.units import Quantity

#: Terms of the equation M = J*alpha + K_w*omega + K_0*sgn(omega) + M_0 - tau*dM/dt that an identification finds.
INERTIA, VISCOUS, COULOMB, OFFSET, MISALIGNMENT = "inertia", "viscous", "coulomb", "offset", "misalignment"


@dataclass(frozen=True)
class AxisKind:
    """How an axis moves, with the names and units that depend on it; `turns`: whether its position is an angle."""

    name: str
    turns: bool
    length_unit: str
    effort: str
    effort_unit: str
    inertia: str
    inertia_unit: str

    @property
    def speed_unit(self) -> str:
        """SI unit of velocity."""
        return f"{self.length_unit}/s"

    @property
    def acceleration_unit(self) -> str:
        """SI unit of acceleration."""
        return f"{self.length_unit}/s**2"

    def parameter(self, term: str) -> str:
        """Name of the coefficient of a term of the equation of motion, e.g. `coulomb_friction_torque` of COULOMB."""
        return {
            INERTIA: self.inertia,
            VISCOUS: "viscous_friction_coefficient",
            COULOMB: f"coulomb_friction_{self.effort}",
            OFFSET: f"{self.effort}_offset",
            MISALIGNMENT: "misalignment",
        }[term]

    def in_words(self, term: str) -> str:
        """The same in words, e.g. `moment of inertia`."""
        return words(self.parameter(term))

    def base_parameters(self, effort_unit: str | None = None) -> dict[str, str]:
        """Names of J, K_w and K_0 with their units; `effort_unit` as of `unit`."""
        return {self.parameter(term): self.parameter_unit(term, effort_unit) for term in (INERTIA, VISCOUS, COULOMB)}

    def parameter_unit(self, term: str, effort_unit: str | None = None) -> str:
        """Unit of the coefficient of a term, e.g. kg*m**2 of INERTIA; `effort_unit` as of `unit`."""
        effort = effort_unit or self.effort_unit
        if term == INERTIA and effort == self.effort_unit:
            return self.inertia_unit
        return {
            INERTIA: f"{effort}*s**2/{self.length_unit}",
            VISCOUS: f"{effort}*s/{self.length_unit}",
            COULOMB: effort,
            OFFSET: effort,
            MISALIGNMENT: "s",
        }[term]

    def unit(self, quantity: Quantity, effort_unit: str | None = None) -> str:
        """Unit of a quantity on this kind of axis.

        Args:
            quantity: with the unit it has on a rotary axis; an angle is one on every axis.
            effort_unit: that recordings give, where the rig cannot turn it into torque or force.
        """
        if quantity.linear_unit is not None and not self.turns:
            return quantity.linear_unit
        return quantity.unit if quantity.angle else self.translated(quantity.unit, effort_unit)

    def translated(self, rotary: str, effort_unit: str | None = None) -> str:
        """A rotary axis' SI unit as it is on this kind: N*m*s/rad is N*s/m on a linear one."""
        unit = rotary.replace(ROTARY.inertia_unit, self.inertia_unit).replace(ROTARY.length_unit, self.length_unit)
        return unit.replace(ROTARY.effort_unit, effort_unit or self.effort_unit)


#: Inertia of a joint in addition to that of its links, on the joint's side.
ARMATURE = "armature"

ROTARY = AxisKind("rotary", True, "rad", "torque", "N*m", "moment_of_inertia", "kg*m**2")
LINEAR = AxisKind("linear", False, "m", "force", "N", "moving_mass", "kg")
#: All kinds; tables with a column for each keep this order.
KINDS = (ROTARY, LINEAR)


def axis_kind(name: object, where: object) -> AxisKind:
    """The kind of a name in a file or an argument; InputError that names `where` if there is none."""
    for kind in KINDS:
        if kind.name == name:
            return kind
    raise InputError(where, f"found {name!r}", f"allowed: {', '.join(kind.name for kind in KINDS)}")
