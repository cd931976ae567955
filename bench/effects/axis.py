"""What effects are given of a simulated axis: its constants, its state within a step, and values of quantities.

All are numbers, or arrays (k,) of axes side by side, of any library that follows the array API standard.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

#: A number, or an array (k,): those of the array API standard have no static type in common.
Number = Any
#: Values of an effect's quantities by their names - SI.
Values = Mapping[str, Number]


@dataclass(frozen=True)
class Winding:
    """Motor winding: k_T - N*m/A (N/A), R - ohm, L - H, K_e - V*s/rad (V*s/m)."""

    torque_constant: Number
    resistance: Number
    inductance: Number
    back_emf_constant: Number


@dataclass(frozen=True)
class Axis:
    """The axis, as far as effects need it; numbers, or arrays (k,).

    Attributes:
        inertia: total inertia J - kg*m**2 (kg).
        motor_inertia: its part on the motor's side of a coupling - kg*m**2 (kg).
        viscous: K_w - N*m*s/rad (N*s/m).
        coulomb: K_0 - N*m (N).
        peak_effort: motor torque at peak current - N*m (N).
        winding: None if the rig does not give it.
    """

    inertia: Number
    motor_inertia: Number
    viscous: Number
    coulomb: Number
    peak_effort: Number
    winding: Winding | None = None


@dataclass(frozen=True)
class Moment:
    """State of axes at the middle of a step.

    Attributes:
        time: since the recording's start - s -; a number, or (k,).
        position: rad (m) - (k,).
        velocity: rad/s (m/s) - (k,).
        effort: of the motor - N*m (N) - (k,).
        began: start of the recording, counted from that of the first where several are joined - s -; a number, or (k,).
        load: resisting torque of the load, as the transmission carries it, where friction follows it - N*m (N) - (k,).
    """

    time: Number
    position: Number
    velocity: Number
    effort: Number
    began: Number = 0.0
    load: Number = 0.0
