"""Inertia of the load alone, for comparison with that of the disk's geometry."""

from __future__ import annotations

from collections.abc import Mapping

from bench.axis_kind import ARMATURE
from bench.fit.parameter import Parameter
from bench.rig.rig import Rig


def load_inertia(parameters: Mapping[str, Parameter], rig: Rig) -> dict[str, Parameter]:
    """J_load = J - J_motor, or (J - J_motor - J_gear)*i**2 behind a gear, if the rig gives J_motor and J is in kg*m**2.

    If the links of a robot are known, the armature of the joint instead, J*i**2 - J_links.
    """
    inertia = parameters.get(rig.axis_kind.inertia)
    if inertia is not None and rig.load is not None and rig.load.link_inertia is not None:
        square, links = rig.load.gear_ratio**2, rig.load.link_inertia
        low, high = (bound * square - links for bound in inertia.ci95)
        load = Parameter(inertia.value * square - links, inertia.unit, inertia.std_error * square, (low, high))
        return {ARMATURE: load}
    if inertia is None or rig.motor.rotor_inertia is None or inertia.unit != "kg*m**2":
        return {}
    value, square = _beyond(inertia.value, rig), _beyond(1.0, rig) - _beyond(0.0, rig)
    low, high = (value + (bound - inertia.value) * square for bound in inertia.ci95)
    load = Parameter(value, inertia.unit, inertia.std_error * square, (low, high))
    moved = (_beyond(inertia.value, other) - value for other in rig.within_tolerance())
    return {"load_moment_of_inertia": load.widened(*moved)}


def _beyond(inertia: float, rig: Rig) -> float:
    """An inertia without motor and gear, on the load's side - kg*m**2."""
    gear, ratio = (rig.load.gear_inertia or 0.0, rig.load.gear_ratio) if rig.load else (0.0, 1.0)
    return (inertia - (rig.motor.rotor_inertia or 0.0) - gear) * ratio**2
