"""Where a search looks first for a shape of an effect, on rotary and on linear axes."""

from __future__ import annotations

import numpy as np

from bench.effects.signals import Scope, Shape

#: Top speed of the rotary axes for which effects state their grids - rad/s.
TOP = 100.0
#: Angle of a cycle that the motion must cover - rad: over less, a wave is a mere curve, and a wave of torque copies it.
PERIOD = 2.0 * np.pi
#: Cycles over the travel of a linear axis between which pitches are sought: fewer than two are no repetition.
COARSEST, FINEST = 2.0, 128.0


def is_pitch(shape: Shape, scope: Scope) -> bool:
    """Whether a harmonic is the wave number of a pitch.

    A linear axis has no revolution that all share: screw, belt and magnets each have a pitch of their own, so a
    harmonic is 2*pi over the pitch there - rad/m -, varies continuously and is sought by the travel.
    """
    return shape.whole and not scope.kind.turns


def places(shape: Shape, scope: Scope) -> tuple[float, ...]:
    """Where a shape is sought first: on a linear axis as on a rotary one whose top speed is TOP.

    A rotary axis may be a motor or the joint behind its gear, so there both are tried: values as they are stated, and
    beyond them values by its own speed.
    """
    if is_pitch(shape, scope):
        return tuple((scope.spacing * np.arange(2.0 * COARSEST, 2.0 * FINEST + 1.0)).tolist())
    if shape.whole:
        return tuple(n for n in shape.grid if n * scope.travel >= PERIOD)
    power = {"rad/s": 1, "1/rad": -1}.get(shape.quantity.unit, 0)
    if not power:
        return shape.grid
    by_speed = tuple(value * (scope.top_speed / TOP) ** power for value in shape.grid)
    if not scope.kind.turns:
        return by_speed
    return tuple(sorted((*shape.grid, *(value for value in by_speed if not min(shape.grid) <= value <= max(shape.grid)))))
