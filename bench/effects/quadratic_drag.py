"""Quadratic drag: resisting torque grows with velocity times its magnitude (a fan, a fluid).

    M = k_q*omega*|omega|

k_q - N*m*s**2/rad**2 (N*s**2/m**2), not negative.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.acting import AXIS, Native, Spec
from bench.effects.effect import Columns
from bench.effects.signals import Axis, Signals
from bench.trace.filter import Column
from bench.units import Quantity


class QuadraticDrag(Columns, Native):
    name = "quadratic_drag"
    summary = "resisting torque grows with velocity*|velocity|"
    of_speed = True
    external = True
    quantities = (Quantity("quadratic_drag", "k_q", "N*m*s**2/rad**2", lower=0.0, null=0.0),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return [[(signals.velocity * np.abs(signals.velocity), 0)]]

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Second coefficient of the joint's damping, which grows with speed."""
        spec.joint(AXIS).damping[1] += values["quadratic_drag"]


EFFECT = QuadraticDrag()
