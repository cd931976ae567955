"""Positions that wrap: a drive counts to the end of a turn, or of its range, and starts over."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.trace.clock import Sampled

#: Samples from which on a jump is told from motion.
LEAST = 10
#: Sample periods beyond which a step is a hole in time.
LONGEST_STEP = 2.5
#: A step beyond this share of all travel is a jump, if it is also this many times the longest of the other steps.
FAR, ISOLATED = 0.5, 3.0
#: Jumps of one period differ by what the axis moves meanwhile, which the steps beside them tell, to this share of it.
ALIKE = 0.02
#: A period this close to whole revolutions is one - share.
WHOLE = 1e-3


@dataclass(frozen=True)
class Wraps:
    """Wraps of a position that were undone.

    Attributes:
        period: by which it jumps - rad (m).
        count: of the jumps.
    """

    period: float
    count: int


def jumps(position: Array, time: Array) -> NDArray[np.intp]:
    """Places k (m,) of steps from sample k to the next that no motion makes, in a position (n,) at times - s - (n,).

    Steps over a hole in time are none of them: the axis may be anywhere after it.
    """
    if position.size < LEAST:
        return np.empty(0, dtype=np.intp)
    step, passed = np.abs(np.diff(position)), np.diff(time)
    near = passed <= LONGEST_STEP * float(np.median(passed))
    far = near & (step > FAR * float(np.ptp(position)))
    others = step[near & ~far]
    if not far.any() or not others.any() or step[far].min() < ISOLATED * others.max():
        return np.empty(0, dtype=np.intp)
    return np.flatnonzero(far)


def period_of(position: Array, places: NDArray[np.intp]) -> float | None:
    """Period by which a position (n,) jumps at `places` - rad (m); None where the jumps are not of one period."""
    step = np.diff(position)
    usual = step.copy()
    usual[places] = np.nan
    beside = np.stack([usual[np.clip(places + side, 0, step.size - 1)] for side in (-1, 1)])
    known = np.isfinite(beside)
    moved = np.where(known, beside, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    found = np.abs(step[places] - moved)
    period = float(np.median(found))
    if np.abs(found - period).max() > ALIKE * period or np.ptp(position) > (1.0 + ALIKE) * period:
        return None
    turns = max(round(period / (2.0 * math.pi)), 1)
    whole = turns * 2.0 * math.pi
    return whole if abs(period / whole - 1.0) < WHOLE else period


def undone(position: Array, period: float) -> Array:
    """A position (n,) without its jumps by `period`, of steps below half of it."""
    return np.unwrap(position, period=period)


def without_wraps(signals: Mapping[str, Sampled]) -> tuple[dict[str, Sampled], Wraps | None]:
    """Signals in which the position runs on where it plainly wraps, and its reference with it.

    Before samples are brought to a regular time base: interpolated over a jump, they would lie inside it.
    """
    if "position" not in signals:
        return dict(signals), None
    position = signals["position"].values
    places = jumps(position, signals["position"].clock.time)
    period = period_of(position, places) if places.size else None
    if period is None:
        return dict(signals), None
    wrapping = {name: one for name, one in signals.items() if name in ("position", "position_reference")}
    changed = {name: replace(one, values=undone(one.values, period)) for name, one in wrapping.items()}
    return {**signals, **changed}, Wraps(period, int(places.size))
