"""Presliding: friction builds up over a small displacement after each reversal (Dahl's bristles, LuGre's at low speed).

    dz/dt = omega*(1 - sigma*z*sgn(omega)/K_0), M = sigma*z + sigma_1*dz/dt

so between reversals f = sigma*z/K_0 approaches sgn(omega) as exp(-sigma*|x|/K_0) over the displacement x.
sigma, sigma_1 - bristle stiffness - N*m/rad (N/m) - and damping - N*m*s/rad (N*s/m); K_0 - Coulomb friction - N*m (N).
Source: P. R. Dahl, AIAA Journal 14(12), 1976, 1675-1682; C. Canudas de Wit et al., IEEE TAC 40(3), 1995, eqs. 1-4.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from bench.effects.kinds import Axis, Friction
from bench.effects.mjcf import AXIS, BRISTLES, passive_motor
from bench.effects.signals import Base, Shape, Signals
from bench.trace.filter import Column
from bench.units import Quantity

if TYPE_CHECKING:  # 0.2 s, which nobody pays who does not simulate
    import mujoco

#: Share of critical damping, of the axis against its bristles, below which a negative damping may be noise.
UNDAMPED = 0.1


class PreslidingFriction(Friction):
    """See the module."""

    name = "presliding_friction"
    summary = "bristle-like hysteresis before breakaway and after reversal (Dahl, LuGre)"
    quantities = (
        Quantity("bristle_stiffness", "sigma", "N*m/rad", lower=0.0, null=np.inf),
        Quantity("bristle_damping", "sigma_1", "N*m*s/rad", lower=0.0, preset=0.0),
    )
    shapes = (Shape(Quantity("bristle_rate", "sigma/K_0", "1/rad", lower=0.0), (3.0, 8.0, 20.0, 50.0, 130.0, 350.0)),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """What the bristles lack of full friction, f - sgn(omega), and their bending, omega - |omega|*f."""
        share = bristles(signals.position, signals.sign, shape[0])
        bending = signals.velocity - np.abs(signals.velocity) * share
        return [[(share - signals.sign, 0)], [(bending, 0)]]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """sigma is its rate over displacement times Coulomb friction, sigma_1 the strength of the bending."""
        return {"bristle_stiffness": shape[0] * base.coulomb, "bristle_damping": strengths[1]}

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> bool:
        """The bristles carry Coulomb friction within a factor of two, and damp as far as noise lets that be seen."""
        if base.coulomb <= 0.0 or base.inertia <= 0.0:
            return False
        critical = 2.0 * np.sqrt(shape[0] * base.coulomb * base.inertia)
        return 0.5 * base.coulomb < strengths[0] < 2.0 * base.coulomb and strengths[1] > -UNDAMPED * critical

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """LuGre friction of a passive DC motor in place of the joint's."""
        joint = spec.joint(AXIS)
        level, joint.frictionloss = joint.frictionloss, 0.0
        # MuJoCo takes the bend of the bristles at the start of a step; their rate carries it on to the middle
        damping = values["bristle_damping"] + 0.5 * spec.option.timestep * values["bristle_stiffness"]
        passive_motor(spec, BRISTLES, lugre=(values["bristle_stiffness"], damping, level, level, 1.0))


def bristles(position: np.ndarray, sign: np.ndarray, rate: float) -> np.ndarray:
    """Share f of full friction that the bristles carry, -1 to 1, along a motion.

    Args:
        position: (n,) - rad (m).
        sign: (n,) of speed, 0 where unknown: the last known one holds.
        rate: sigma/K_0 - 1/rad (1/m).
    """
    known = np.flatnonzero(sign)
    if known.size == 0:
        return np.zeros_like(position)
    held = sign[known[np.maximum(np.searchsorted(known, np.arange(sign.size), side="right") - 1, 0)]]
    turns = np.concatenate([[0], np.flatnonzero(np.diff(held)) + 1, [sign.size]])
    share, carried = np.empty_like(position), 0.0
    for start, stop in pairwise(turns):
        travel = np.abs(position[start:stop] - position[start])
        share[start:stop] = held[start] + (carried - held[start]) * np.exp(-rate * np.maximum.accumulate(travel))
        carried = share[stop - 1]
    return share


EFFECT = PreslidingFriction()
