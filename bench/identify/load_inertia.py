"""Inertia of the load alone, which is what theory from the disk's geometry is compared with."""

from __future__ import annotations

import math
from collections.abc import Mapping

from bench.balance.parameter import Parameter
from bench.rig.rig import Rig
from bench.statistics import NORMAL95


def load_inertia(parameters: Mapping[str, Parameter], rig: Rig) -> dict[str, Parameter]:
    """J_load = J - J_motor (- J_gear, times i**2 behind a gear), where the rig knows the motor and J is in kg*m**2."""
    inertia = parameters.get("moment_of_inertia")
    if inertia is None or rig.motor.rotor_inertia is None or inertia.unit != "kg*m**2":
        return {}
    value, square = _beyond(inertia.value, rig), _beyond(1.0, rig) - _beyond(0.0, rig)
    moved = math.hypot(*(_beyond(inertia.value, other) - value for other in rig.within_tolerance()))
    error = math.hypot(inertia.std_error * square, moved / NORMAL95)
    low, high = (math.hypot((bound - inertia.value) * square, moved) for bound in inertia.ci95)
    return {"load_moment_of_inertia": Parameter(value, inertia.unit, error, (value - low, value + high))}


def _beyond(inertia: float, rig: Rig) -> float:
    """What of an inertia is neither motor's nor gear's, on the load's side - kg*m**2."""
    gear, ratio = (rig.load.gear_inertia or 0.0, rig.load.gear_ratio) if rig.load else (0.0, 1.0)
    return (inertia - (rig.motor.rotor_inertia or 0.0) - gear) * ratio**2
