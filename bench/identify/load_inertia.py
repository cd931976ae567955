"""Inertia of the load alone, which is what theory from the disk's geometry is compared with."""

from __future__ import annotations

from collections.abc import Mapping

from bench.balance.parameter import Parameter
from bench.rig.rig import Rig


def load_inertia(parameters: Mapping[str, Parameter], rig: Rig) -> dict[str, Parameter]:
    """J_load = J - J_motor (- J_gear, times i**2 behind a gear), where the rig knows the motor and J is in kg*m**2."""
    inertia = parameters.get("moment_of_inertia")
    rotor = rig.motor.rotor_inertia
    if inertia is None or rotor is None or inertia.unit != "kg*m**2":
        return {}
    own = rotor + ((rig.load.gear_inertia or 0.0) if rig.load else 0.0)
    square = rig.load.gear_ratio**2 if rig.load else 1.0
    low, high = ((bound - own) * square for bound in inertia.ci95)
    value = Parameter((inertia.value - own) * square, inertia.unit, inertia.std_error * square, (low, high))
    return {"load_moment_of_inertia": value}
