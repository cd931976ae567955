"""Presliding: friction builds up over a small displacement after each reversal (Dahl's bristles, LuGre's at low speed).

    dz/dt = omega*(1 - sigma*z*sgn(omega)/(g*K_0)), M = sigma*z + sigma_1*dz/dt

so between reversals f = sigma*z/K_0 approaches g*sgn(omega) as exp(-sigma*|x|/(g*K_0)) over the displacement x.
sigma, sigma_1 - bristle stiffness - N*m/rad (N/m) - and damping - N*m*s/rad (N*s/m); K_0 - Coulomb friction - N*m (N);
g - level of sliding friction over K_0: 1, or as changed by other effects (Stribeck's rise, a direction, warmth).
Source: P. R. Dahl, AIAA Journal 14(12), 1976, 1675-1682; C. Canudas de Wit et al., IEEE TAC 40(3), 1995, eqs. 1-4.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import ClassVar

import numpy as np

from bench.arrays import Array, recurrence
from bench.effects.effect import Bristles
from bench.effects.mjcf import AXIS, BRISTLES, Spec, passive_motor
from bench.effects.shape import ANGLE, Shape, Shapes
from bench.effects.signals import Axis, Scope, Signals
from bench.trace.filter import Column
from bench.units import Quantity

#: Level of sliding friction, as share of Coulomb's, below which a fit of others has lost its way.
LEAST = 1e-3
#: Lengths over which the bristles bend in the travel, at least.
SLIDES = 10.0


class PreslidingFriction(Bristles):
    name = "presliding_friction"
    summary = "bristle-like hysteresis before breakaway and after reversal (Dahl, LuGre)"
    quantities = (
        Quantity("bristle_stiffness", "sigma", "N*m/rad", lower=0.0, null=np.inf),
        Quantity("bristle_damping", "sigma_1", "N*m*s/rad", lower=0.0, preset=0.0),
    )
    shapes = (
        Shape(
            Quantity("bristle_rate", "sigma/K_0", "1/rad", lower=0.0),
            (3.0, 8.0, 20.0, 50.0, 130.0, 350.0),
            measure=ANGLE,
        ),
    )

    # a rise of friction towards standstill that is not named yet would else make it negative, and the name impossible
    bounded: ClassVar[Mapping[int, tuple[float, float]]] = {1: (0.0, math.inf)}

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """What the bristles lack of sliding friction, f - g*sgn(omega), and their bending, omega - |omega|*f/g."""
        level = sliding_level(signals.sign, signals.friction)
        torque = bristles(signals.position, signals.sign, level, shape[0])
        bending = signals.velocity - np.abs(signals.velocity) * torque / level
        return [[(torque - signals.friction, 0)], [(bending, 0)]]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        """sigma is its rate over displacement times Coulomb friction, sigma_1 the strength of the bending."""
        return {"bristle_stiffness": shape[0] * base.coulomb, "bristle_damping": strengths[1]}

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> bool:
        """The bristles carry Coulomb friction within a factor of two."""
        return base.inertia > 0.0 and 0.5 * base.coulomb < strengths[0] < 2.0 * base.coulomb

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        """The bristles bend over a small part of the travel: over most of it they would be a spring and a damper."""
        return all(rate * scope.travel > SLIDES for (rate,) in shapes)

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """LuGre friction of a passive DC motor in place of the joint's."""
        joint = spec.joint(AXIS)
        level, joint.frictionloss = joint.frictionloss, 0.0
        # MuJoCo takes the bend of the bristles at the start of a step; their rate carries it on to the middle
        damping = values["bristle_damping"] + 0.5 * spec.option.timestep * values["bristle_stiffness"]
        passive_motor(spec, BRISTLES, lugre=(values["bristle_stiffness"], damping, level, level, 1.0))


def sliding_level(sign: Array, friction: Array) -> Array:
    """Dry friction of sliding bristles, as share of K_0 (n,): between its values where the direction is known.

    By the sign of speed (n,), 0 where unknown, and the level with its sign, as share of K_0 (n,).
    """
    known = np.flatnonzero(sign)
    if known.size == 0:
        return np.ones_like(sign)
    return np.maximum(np.interp(np.arange(sign.size), known, np.abs(friction[known])), LEAST)


def bristles(position: Array, sign: Array, level: Array, rate: float) -> Array:
    """Torque that the bristles carry along a motion, over Coulomb friction (n,).

    Args:
        sign: (n,) of speed, 0 where unknown: the last known one is used.
        level: (n,) of sliding, as share of K_0.
        rate: sigma/K_0 - 1/rad (1/m).
    """
    known = np.flatnonzero(sign)
    if known.size == 0:
        return np.zeros_like(position)
    held = sign[known[np.maximum(np.searchsorted(known, np.arange(sign.size), side="right") - 1, 0)]]
    travel = np.empty_like(position)
    for start, stop in pairwise([0, *(np.flatnonzero(np.diff(held)) + 1), sign.size]):
        travel[start:stop] = np.maximum.accumulate(np.abs(position[start:stop] - position[start]))
    slid = rate * np.maximum(np.diff(travel, prepend=0.0), 0.0) / level
    kept, sliding = np.exp(-slid), held * level
    mean = np.divide(1.0 - kept, slid, out=np.ones_like(slid), where=slid > 0.0)  # exact for a level that runs straight
    before = np.concatenate([sliding[:1], sliding[:-1]])
    return recurrence(kept, (1.0 - mean) * sliding + (mean - kept) * before)


EFFECT = PreslidingFriction()
