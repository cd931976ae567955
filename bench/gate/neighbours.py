"""Did the joints stand still that were stated to? The residual torque of another joint may show that one moved.

The torque that a moving joint causes in another follows a path that is not in the log: to the other it is a torque
that changes over time and not with its own motion. So it is what the joint's own terms leave and a spline in time
explains. What else pushes over time looks the same; which of the two it was, the log of one joint does not show.
"""

from __future__ import annotations

import numpy as np

from bench.arrays import Array, rms
from bench.gate.check import Check, Seen
from bench.trace.filter import Column, GaussianFilter
from bench.trace.motion import measured_position
from bench.trace.signals import STANDING, STANDING_ASK

NAME = "neighbours_stand"
#: Half-power frequency up to which torque is compared - Hz: other joints move below, dry friction's edges lie above.
CUTOFF = 3.0
#: A spline has a knot every so often - s -, at most so many, and so many rows for each at least.
EVERY, MOST, ROWS = 0.25, 200, 3
#: Share of the residual's power that remains next to a joint that moved: 0.06 at most, else 0.2 (tests/gate).
LEFT = 0.1

ALLOWED = "torque that goes with the joint's own motion, where others are stated to stand still"


def stand(seen: Seen) -> Check | None:
    """Whether the residual effort depends on time, as it does next to a joint that moves and is not in the log.

    None where no other joint is stated to stand.
    """
    standing = seen.trace.metadata.get(STANDING)
    if standing is None:
        return None
    over_time, unit = _over_time(seen), seen.trace.axis_kind.effort_unit
    if not 0.0 < over_time < float(seen.trace.metadata[STANDING_ASK]):
        return Check(NAME, "pass", f"stated, not seen: {standing}", ALLOWED)
    found = f"{over_time:.3g} {unit} depend on time and not on the joint's own motion, next to {standing}, as stated"
    advice = "one of these moved, or something else pushed: record their positions, too"
    return Check(NAME, "warn", found, ALLOWED, advice)


def _over_time(seen: Seen) -> float:
    """RMS of the effort that depends on time, not on its own motion, in its unit; 0 where that is not most of it."""
    if seen.effort is None or not seen.tells_motion:
        return 0.0
    trace, (effort, _) = seen.trace, seen.effort
    smooth = GaussianFilter.from_cutoff(CUTOFF, trace.sample_period)
    parts = [part for part in trace.segments if part.stop - part.start > 2 * smooth.margin]
    ratio = seen.rig.gear_ratio if seen.rig is not None else 1.0
    place, free = measured_position(trace) / ratio, _splines(trace.time)
    tables = [_table(smooth, part, place, effort, seen.speed(part), free) for part in parts]
    table, own = np.vstack([*tables, np.zeros((0, OWN + len(free) + 1))]), slice(0, OWN)
    if len(table) < ROWS * table.shape[1]:
        return 0.0
    alone, beside = (rms(_left(table[:, columns], table[:, -1])) for columns in (own, slice(0, -1)))
    return alone if beside**2 < LEFT * alone**2 else 0.0


#: Columns of a joint's own terms: inertia, friction, and weight, as no mass is sure.
OWN = 9


def _table(smooth: GaussianFilter, part: slice, place: Array, effort: Array, w: Array, free: list[Array]) -> Array:
    """A stretch filtered (m, k): the joint's own terms, splines in time, and its effort."""
    q, torque = place[part], effort[part]
    sign = np.sign(w)
    plain = (w, sign, sign * np.abs(torque), np.sin(q), np.cos(q), np.sin(2.0 * q), np.cos(2.0 * q), np.ones_like(q))
    own: list[Column] = [[(w, 1)], *([(values, 0)] for values in plain)]
    return smooth.columns([*own, *([(values[part], 0)] for values in free), [(torque, 0)]]).T


def _left(table: Array, torque: Array) -> Array:
    """Of a torque (m,) together with columns (m, k)."""
    return torque - table @ np.linalg.lstsq(table, torque, rcond=1e-10)[0]


def _splines(time: Array) -> list[Array]:
    """Cubic splines that together are any smooth course over times - s - (n,) each."""
    from scipy.interpolate import BSpline  # 0.1 s, which only a joint among others has to pay

    first, last = float(time[0]), float(time[-1])
    inner = np.linspace(first, last, min(round((last - first) / EVERY), MOST - 3) + 1)
    knots = np.concatenate([[first] * 3, inner, [last] * 3])
    return [BSpline(knots, unit, 3)(time) for unit in np.eye(knots.size - 4)]
