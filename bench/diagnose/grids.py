"""Where a search looks first for the shape of an effect, on rotary and on linear axes.

On a rotary axis what repeats does so in whole cycles a revolution. A linear axis has no revolution that all share:
screw, belt and magnets each have a pitch of their own, so a harmonic is a wave number there, 2*pi over the pitch -
rad/m -, varies continuously and is sought by the travel. Speeds and bristle lengths are sought on a linear axis as on a
rotary one whose top speed is TOP.
"""

from __future__ import annotations

import numpy as np

from bench.diagnose.workbench import Workbench
from bench.effects.effect import Effect, Shape

#: Cycles over the travel of a linear axis between which pitches are sought: fewer than two are no repetition.
COARSEST, FINEST = 2.0, 128.0
#: Angle of a cycle that the motion must cover - rad: over less, a wave is a mere curve, and a wave of torque copies it.
PERIOD = 2.0 * np.pi
#: Top speed of the rotary axes for which effects state their grids - rad/s.
TOP = 100.0
#: What has a meaning on a turning axis alone.
TURNING = frozenset({"unbalance", "encoder_eccentricity", "outside_notch"})


def sought(bench: Workbench, physics: Effect) -> tuple[tuple[float, ...], ...]:
    """Where a search looks first, for each shape of an effect."""
    return tuple(_grid(bench, shape) for shape in physics.shapes)


def is_pitch(bench: Workbench, shape: Shape) -> bool:
    """Whether a harmonic is the wave number of a pitch."""
    return bench.linear and shape.whole


def spacing(bench: Workbench) -> float:
    """Distance of wave numbers that the travel just tells apart: half a cycle over it - 1 (rad/m)."""
    positions = [part.signals.position for part in bench.stretches]
    travel = max(float(p.max()) for p in positions) - min(float(p.min()) for p in positions)
    return np.pi / travel


def _grid(bench: Workbench, shape: Shape) -> tuple[float, ...]:
    if shape.whole and not bench.linear:
        return tuple(n for n in shape.grid if n * np.pi / spacing(bench) >= PERIOD)
    if is_pitch(bench, shape):
        return tuple((spacing(bench) * np.arange(2.0 * COARSEST, 2.0 * FINEST + 1.0)).tolist())
    power = {"rad/s": 1, "1/rad": -1}.get(shape.quantity.unit, 0)
    if not bench.linear or not power:
        return shape.grid
    top = max(float(np.abs(part.signals.velocity).max()) for part in bench.stretches)
    return tuple(value * (top / TOP) ** power for value in shape.grid)
