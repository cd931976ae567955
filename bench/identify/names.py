"""Names and units of what is identified, for rotary and linear axes and for any unit of effort."""

from __future__ import annotations

from bench.identify.regressors import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS

ROTARY = {
    INERTIA: "moment_of_inertia",
    VISCOUS: "viscous_friction_coefficient",
    COULOMB: "coulomb_friction_torque",
    OFFSET: "torque_offset",
    MISALIGNMENT: "misalignment",
}
LINEAR = {**ROTARY, INERTIA: "moving_mass", COULOMB: "coulomb_friction_force", OFFSET: "force_offset"}


def parameter_name(column: str, linear: bool) -> str:
    """Name of the coefficient of a regression column."""
    return (LINEAR if linear else ROTARY)[column]


def parameter_unit(column: str, linear: bool, effort_unit: str) -> str:
    """Unit of the coefficient of a regression column, e.g. kg*m**2 for inertia under N*m, A*s**2/rad under A."""
    length = "m" if linear else "rad"
    known = {("N*m", INERTIA): "kg*m**2", ("N", INERTIA): "kg"}
    units = {
        INERTIA: f"{effort_unit}*s**2/{length}",
        VISCOUS: f"{effort_unit}*s/{length}",
        COULOMB: effort_unit,
        OFFSET: effort_unit,
        MISALIGNMENT: "s",
    }
    return known.get((effort_unit, column), units[column])
