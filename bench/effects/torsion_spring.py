"""Torsion spring: a torque proportional to position, beyond a rest position (a hose, a cable).

    M = c*(q - q_0)

c - stiffness - N*m/rad (N/m), not negative; q - position - rad (m); q_0 - position at rest - rad (m). A constant torque
moves the rest position: no recording distinguishes a spring with an offset from one with another rest position. So
with a spring no `torque_offset` is needed, and both numbers of the spring are counted as fitted.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.effect import Fitted, Proposal
from bench.effects.mjcf import AXIS, Spec
from bench.effects.signals import Axis, AxisState, Number, Values
from bench.effects.torque import Torque
from bench.units import Quantity


class TorsionSpring(Torque):
    name = "torsion_spring"
    summary = "a torque proportional to position"
    external = True
    transmitted = True
    spring = True
    quantities = (
        Quantity("stiffness", "c", "N*m/rad", lower=0.0, null=0.0),
        Quantity("reference", "q_0", "rad", preset=0.0, minor=True),
    )

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return values["stiffness"] * (at.position - values["reference"])

    def propose(self, fitted: Fitted) -> list[Proposal]:
        """None where a constant torque explains as much."""
        constant = fitted.seen(lambda signals: [[(np.ones_like(signals.time), 0)]], False)
        (least,) = fitted.gains(constant, 1) + fitted.chance
        return [proposal for proposal in super().propose(fitted) if proposal.gain > least]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        stiffness, torque = (*strengths, 0.0)[:2]
        return {"stiffness": stiffness, "reference": torque / stiffness if stiffness else 0.0}

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        joint = spec.joint(AXIS)
        joint.stiffness[0] += values["stiffness"]
        joint.springref = values["reference"]


EFFECT = TorsionSpring()
