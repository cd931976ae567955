"""Load torque event: an external torque acts for a stretch of time (a collision, a hand, a brake dragging).

    M = M_e for t_1 <= t < t_2, else 0

M_e - N*m (N); t - time since the recording's start (that of the first, of several that are joined) - s.

A short one differs from the rest of a residual by its edges: that runs as a parabola through the event and as long
next to it. Where one takes many times what any other stretch of time does, it is no part of what comes again and again
(level shifts and outliers of a series: R. S. Tsay, Journal of Forecasting 7, 1988, 1-20).
"""

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bench.arrays import NORMAL95, Array, namespace
from bench.effects.effect import Fitted, Occasional, Proposal
from bench.effects.shape import Shape, Shapes
from bench.effects.signals import Axis, AxisState, Number, Scope, Values
from bench.effects.torque import Torque
from bench.units import Quantity

#: Points in time between which events are sought.
EDGES = 240
#: Longest events together, as share of the recording (of the longest, of several).
LONGEST = 0.6
#: Speed, as share of its RMS, below which an axis creeps.
CREEPS = 0.05
#: Coulomb frictions that static friction takes at most: beyond them, no friction holds an axis that creeps.
STATIC = 3.0
#: Of the most that a window takes, what others take that differ in rows alone where nothing moves: those decide then.
ALIKE = 1.0 - 1e-9
#: Widths of the filter that an event lasts at least: the full width at half maximum of its impulse response.
RESOLVED = 2.355
#: Lengths of short events that are tried: from so many widths of the filter to a time - s -, each by a factor longer.
SHORT, LONG, LONGER = 10.0, 0.15, 1.1
#: What an event takes over what any other stretch does from which on it is significant: 5.3 at most without an event.
STANDS_OUT = 9.0
#: Short events at most: more are no occasions.
FEW = 4
#: Instants that are tried at standstill.
PLACES = 5


class LoadTorqueEvent(Occasional, Torque):
    name = "load_torque_event"
    summary = "an external torque acts for a stretch of time"
    external = True
    quantities = (
        Quantity("torque", "M_e", "N*m", null=0.0),
        Quantity("start", "t_1", "s", lower=0.0, instant=True),
        Quantity("end", "t_2", "s", lower=0.0, instant=True),
    )
    shapes = tuple(Shape(instant, reach=0.05, additive=True) for instant in quantities[1:])

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """What acts of it within a step around the moment, on average."""
        instants = ((at.began + at.time - values[edge]) / at.step + 0.5 for edge in ("start", "end"))
        begun, over = (namespace(passed).clip(passed, 0.0, 1.0) for passed in instants)
        return values["torque"] * (begun - over)

    def propose(self, fitted: Fitted) -> list[Proposal]:
        """The best window of time, all of them compared through cumulative sums.

        Where the axis is at rest or creeps, friction balances the torque, up to its static level: nothing below that
        speaks for an event there, nor do the impacts of what meets and parts.
        """
        weight = (_telling(fitted) & fitted.determined).astype(np.float64)
        time = fitted.time
        edges = np.unique(np.linspace(0, time.size, EDGES + 1).astype(int))
        first, last = np.triu_indices(edges.size, 1)
        kept = (edges[last] - edges[first]) < LONGEST * time.size
        if time[-1] - time[0] > fitted.scope.duration:  # through all of one of several recordings: that is how they are
            instants = time[np.minimum(edges, time.size - 1)]
            kept &= instants[last] - instants[first] <= LONGEST * fitted.scope.duration
        first, last = first[kept], last[kept]
        gain = _gains(fitted, weight, edges, first, last)
        most = np.flatnonzero(gain >= ALIKE * gain.max())
        best = int(most[np.argmax(_gains(fitted, np.ones(time.size), edges, first[most], last[most]))])
        stop = min(int(edges[last[best]]), time.size - 1)
        return [Proposal((float(time[edges[first[best]]]), float(time[stop])), float(gain[best]))]

    def apart(self, fitted: Fitted) -> list[tuple[tuple[float, ...], tuple[float, float]]]:
        """Short events, each of which takes many times what any stretch takes that is none of them."""
        taken, windows = _short(fitted)
        found, least = list[tuple[tuple[float, ...], tuple[float, float]]](), 0.0
        while len(found) <= FEW and taken.any():
            best = int(np.argmax(taken))
            if least > STANDS_OUT * taken[best]:
                return found
            first, start, stop, last = windows[best].tolist()
            found.append(((start, stop), (first, last)))
            least, taken = float(taken[best]), taken * ((windows[:, 3] < first) | (windows[:, 0] > last))
        return []

    def duration(self, shape: Sequence[float]) -> float:
        return shape[1] - shape[0]

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> bool:
        return self.duration(shape) > 0.0

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        """Each lasts longer than the filter blurs; all of them for most of the recording would be how the axis is."""
        lasting = [self.duration(shape) for shape in shapes]
        return min(lasting) > RESOLVED * scope.width and sum(lasting) <= LONGEST * scope.duration

    def shape_errors(self, shape: Sequence[float], scope: Scope, time: Array) -> Sequence[float]:
        """Of its edges by the distance of the rows around them, which an instant lies within at 95 %."""
        return (np.diff(_rows_around(shape, time))[:, 0] / NORMAL95).tolist()

    def indistinct(self, shape: Sequence[float], time: Array, scope: Scope) -> list[tuple[float, ...]]:
        """An edge at standstill may be anywhere between the rows before and after."""
        places = [[edge] for edge in shape]
        for place, (before, after) in zip(places, _rows_around(shape, time), strict=True):
            if after - before > RESOLVED * scope.width:
                place += np.linspace(before, after, PLACES).tolist()
        return [(start, end) for start, end in product(*places) if start < end]


def _rows_around(shape: Sequence[float], time: Array) -> Array:
    """Rows before and after each edge, of rows at some times (m,) - s - (2, 2)."""
    after = np.clip(np.searchsorted(time, shape), 1, time.size - 1)
    return np.column_stack([time[after - 1], time[after]])


def _telling(fitted: Fitted) -> NDArray[np.bool_]:
    """Rows (m,) where the axis neither is at rest nor creeps, or that demand more than static friction.

    By the Coulomb friction of the rows that move.
    """
    speed, sign = fitted.seen(lambda signals: [[(signals.velocity, 0)], [(signals.sign, 0)]], of_motion=True).T
    moves = np.abs(speed) > CREEPS * fitted.scope.rms_speed
    known = moves & fitted.determined
    less = fitted.residual[known] @ sign[known] / max(float(sign[known] @ sign[known]), 1.0)
    beyond = np.abs(fitted.base.coulomb * sign + fitted.residual) > STATIC * abs(fitted.base.coulomb + less)
    return moves | beyond


def _short(fitted: Fitted) -> tuple[Array, Array]:
    """Squares that short events take next to a parabola, times their share there (s,) - (N*m)**2; when (s, 4) - s.

    That is when its stretch begins, it begins and ends, and its stretch ends. What lies next to an event takes much,
    too, but a small share of what is there; nothing where one that lasts takes more.
    """
    time, residual, width = fitted.time, fitted.residual, fitted.scope.width
    step = float(np.diff(time).min())
    found = [(np.empty(0), np.empty((0, 4)))]
    for length in np.exp(np.arange(np.log(SHORT * width), np.log(LONG), np.log(LONGER))).tolist():
        inside, beside = round(length / step), round(0.5 * length / step)
        size = inside + 2 * beside
        if size > time.size:
            break
        first = np.arange(time.size - size + 1)
        first = first[time[first + size - 1] - time[first] < (size - 0.5) * step]
        at = np.arange(size)
        parabola = np.linalg.qr(np.vander(at / size - 0.5, 3))[0]
        later = np.stack([at >= beside, at >= beside + inside]).astype(np.float64)
        tried = np.stack([later[0] - later[1], *later])  # an event, and what lasts from its start or its end on
        tried -= (tried @ parabola) @ parabola.T
        tried /= np.linalg.norm(tried, axis=1, keepdims=True)
        slow = sum(np.correlate(residual, part, "valid") ** 2 for part in parabola.T)
        there = (np.correlate(residual**2, np.ones(size), "valid") - slow)[first]
        event, *lasting = (np.correlate(residual, part, "valid")[first] ** 2 for part in tried)
        taken = np.where(event > np.maximum(*lasting), event**2 / np.maximum(there, np.finfo(float).tiny), 0.0)
        found.append((taken, time[first[:, None] + [0, beside, beside + inside, size - 1]]))
    return np.concatenate([each for each, _ in found]), np.concatenate([each for _, each in found])


def _gains(
    fitted: Fitted, weight: Array, edges: NDArray[np.intp], first: NDArray[np.intp], last: NDArray[np.intp]
) -> Array:
    """Squares (w,) - (N*m)**2 (N**2) - that a torque takes from weighted rows, in windows from one edge to another."""
    residual, basis = fitted.residual * weight, fitted.span * weight[:, None]
    summed, counted = (np.concatenate([[0.0], np.cumsum(of)])[edges] for of in (residual, weight))
    spanned = np.concatenate([np.zeros((1, basis.shape[1])), np.cumsum(basis, axis=0)])[edges]
    count = counted[last] - counted[first]
    power = count - np.sum((spanned[last] - spanned[first]) ** 2, axis=1)
    determined = (power > 0.02 * count) & (count > 0.0)
    return np.where(determined, (summed[last] - summed[first]) ** 2 / np.maximum(power, 1e-9), 0.0)


EFFECT = LoadTorqueEvent()
