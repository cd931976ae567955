"""The law of a controller whose torque is recorded, by a linear fit: PD, or a cascade of position P and speed PI.

    M = K_v*u + K_i*integral(u) + J_ff*dv/dt + M_0,   u = f*v + K_p*e - w,   e = r - q

r, q - position, demanded and measured; v, w - speed, demanded (dr/dt where it is not recorded) and measured; f - share
of v that is fed forward. With w = v - de/dt this is linear in e, its slope and its integral, and in r, v and dv/dt:

    M = kp*e + kv*de/dt + ki*integral(e) - (1 - f)*(K_i*r + K_v*v) + J_ff*dv/dt + M_0
    kp = K_p*K_v + K_i,   kv = K_v,   ki = K_p*K_i

Where f = 1, K_p and K_i/K_v are the roots of kv*x**2 - kp*x + ki, and may be exchanged. Where f < 1, r shows K_i. A
reference that is recorded by d late shows d*ki there, so it has to be more than some samples make.

A speed from counts is late by s: K_i*s*w is in addition to the law, and K_v*s*dw/dt, where the speed is the slope of
the recorded position. That and a late torque, -d*dM/dt, are fitted with it. Samples at the limit are omitted, and each
second has a constant of its own, as the integral of the rounding of a recorded position drifts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import NORMAL95, Array, rms
from bench.errors import UndeterminedError
from bench.fit.regression import DETERMINED, LEAST, filtered
from bench.fit.solution import block_edges, equations, estimated, misfit
from bench.parameter import Parameter
from bench.servos.fit import MARGIN, MATERIAL
from bench.trace.filter import GaussianFilter
from bench.trace.motion import condition
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: Columns of the law: e, de/dt, d2e/dt2, its integral while the torque is within its limit, r, v, dv/dt, dM/dt.
NAMES = ("error", "rate", "bent", "sum", "goal", "speed", "acceleration", "late")
ERROR, RATE, BENT, SUM, GOAL, SPEED, ACCELERATION, LATE = NAMES
#: Stretch with a constant of its own - s -; share of the torque's squares that the law has to explain.
PIECE, EXPLAINS = 1.0, 0.9
#: Longest delay of a goal - s -, and delays tried first.
LONGEST, TRIED = 0.1, 16
#: Share below the largest torque within which the torque is at its limit, if it has one, and noises in addition; share
#: above which its changes show that noise; samples in a row; residual there over that elsewhere, at least.
NEAR, CLEAR, SURELY, ROW, UNLIKE = 0.02, 3.0, 0.9, 5, 2.0
#: Order of the differences in which noise is most of a signal.
NOISY = 4


@dataclass(frozen=True)
class Reading:
    """How a law is read from signals.

    Attributes:
        smooth: the filter of all of them.
        source: of the speed, `velocity` or `position`.
        late: samples by which the goal is late.
        edge: torque from which on it may be at its limit - N*m (N).
        integral: whether the law has one.
    """

    smooth: GaussianFilter
    source: str
    late: int = 0
    edge: float = math.inf
    integral: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """Of its columns."""
        absent = ([BENT] if self.source == "velocity" else []) + ([] if self.integral else [SUM, GOAL])
        return tuple(name for name in NAMES if name not in absent)

    def rows(self, trace: Trace, effort: Array) -> tuple[Array, Array, Array]:
        """Times (m,), columns and effort, each less its mean of a piece (p + 1, m), and those means of the effort (m,),
        where no limit is in reach."""
        limited, own = np.abs(effort) >= self.edge, int(self.source == "position")
        goal = self._later(trace, "position_reference")
        error = goal - trace["position"]
        step = np.where(limited, 0.0, 0.5 * trace.sample_period * (error + np.r_[error[:1], error[:-1]]))
        recorded = "velocity_reference" in trace
        speed = self._later(trace, "velocity_reference") if recorded else goal
        made = {
            ERROR: (error, 0),
            RATE: (trace[self.source], own),
            BENT: (trace[self.source], own + 1),
            SUM: (np.cumsum(step), 0),
            GOAL: (goal, 0),
            SPEED: (speed, 1 - recorded),
            ACCELERATION: (speed, 2 - recorded),
            LATE: (effort, 1),
        }
        signals, orders = zip(*made.values(), (effort, 0), strict=True)
        time, table = filtered(trace, self.smooth, signals, orders)
        table[1:3] = table[5:7] - table[1:3]
        at = np.searchsorted(trace.time, time - 0.5 * trace.sample_period)
        kept = np.convolve(limited, np.ones(2 * self.smooth.margin + 1), "same")[at] < 0.5
        starts = np.array([part.start for part in trace.segments])
        segment = np.searchsorted(starts, at, side="right") - 1
        second = (time - trace.time[starts[segment]]) // PIECE
        places = np.stack([segment, np.cumsum(np.diff(limited, prepend=False))[at], second])[:, kept]
        table = table[:, kept][[*(NAMES.index(name) for name in self.names), -1]]
        piece = np.unique(places, axis=1, return_inverse=True)[1].ravel()
        means = np.array([np.bincount(piece, row) / np.bincount(piece) for row in table])[:, piece]
        return time[kept], table - means, means[-1]

    def _later(self, trace: Trace, name: str) -> Array:
        """A demand as it comes to the controller (n,)."""
        parts = [trace[name][part] for part in trace.segments]
        return np.concatenate([one[np.clip(np.arange(one.size) - self.late, 0, None)] for one in parts])


@dataclass(frozen=True, eq=False)
class Law:
    """A law that was fitted.

    Attributes:
        reading: how its columns come from signals.
        values: coefficients by the names of their columns.
        covariance: of them (p, p).
        reach: of an interval of 95 % in standard errors.
        residual: its RMS, through the filter - the effort's unit.
        floor: that of noise.
        explained: share of the torque's squares.
        limit: torque at which the recording shows that it is limited.
        period: of the samples - s.
        independent: number of rows that the filter does not correlate.
    """

    reading: Reading
    values: Mapping[str, float]
    covariance: Array
    reach: float
    residual: float
    floor: float
    explained: float
    period: float
    independent: float
    limit: Parameter | None = None

    @property
    def stiffness(self) -> float:
        """kp - N*m/rad (N/m)."""
        return self.values[ERROR]

    def parameter(self, of: Callable[[Mapping[str, float]], float], unit: str) -> Parameter:
        """A quantity that follows from the coefficients, with its interval of 95 %, to first order."""
        value, slopes = of(self.values), list[float]()
        for name, error in zip(self.values, np.sqrt(np.diag(self.covariance)).tolist(), strict=True):
            step = 1e-3 * error
            ends = (of({**self.values, name: self.values[name] + side * step}) for side in (1.0, -1.0))
            slopes.append((next(ends) - next(ends)) / (2.0 * step) if step > 0.0 else 0.0)
        error = float(np.sqrt(max(np.array(slopes) @ self.covariance @ np.array(slopes), 0.0)))
        return Parameter(value, unit, error, (value - self.reach * error, value + self.reach * error))

    def torque(self, trace: Trace, effort: Array, values: Mapping[str, float] | None = None) -> tuple[Array, Array]:
        """Times (m,), and the effort with that of the law, or of one with other coefficients (2, m)."""
        time, table, means = self.reading.rows(trace, effort)
        theta = [(self.values if values is None else values).get(name, 0.0) for name in self.reading.names]
        return time, np.stack([table[-1], np.array(theta) @ table[:-1]]) + means


def law_of(trace: Trace, effort: Array) -> Law | None:
    """The law of a controller from goal, motion and torque - N*m (N) - (n,); None where no law explains the torque.

    The speed is the recorded one or the slope of the position, whichever explains more; an integral, a late goal and a
    limit are in the law where they explain what it does not without them.
    """
    sources = [name for name in ("position", "velocity") if name in trace]
    try:
        smooth = condition(trace, effort).filter
        every = [_within_limit(trace, effort, _fitted(trace, effort, Reading(smooth, one))) for one in sources]
        best = _with_late_goal(trace, effort, min(every, key=lambda one: one.residual))
        plain = _fitted(trace, effort, replace(best.reading, integral=False))
    except UndeterminedError:  # too few samples
        return None
    if plain.residual**2 < MATERIAL * best.residual**2:
        best = replace(plain, limit=best.limit)
    gain = best.parameter(lambda values: values[ERROR], "")
    known = 0.0 < gain.half_width < DETERMINED * gain.value  # else the torque follows from the motion, not the error
    return best if known and best.explained >= EXPLAINS else None


def _with_late_goal(trace: Trace, effort: Array, best: Law) -> Law:
    """The law with the goal as many samples late as explains the torque best, if that is much better."""
    latest = max(min(int(LONGEST / trace.sample_period), len(trace) // 4), 1)
    coarse = np.unique(np.geomspace(1, latest, TRIED).astype(int)).tolist()
    found = [_fitted(trace, effort, replace(best.reading, late=late)) for late in coarse]
    place = min(range(len(found)), key=lambda k: found[k].residual)
    between = range(coarse[max(place - 1, 0)] + 1, coarse[min(place + 1, len(coarse) - 1)])
    found += [_fitted(trace, effort, replace(best.reading, late=late)) for late in between if late not in coarse]
    late = min(found, key=lambda one: one.residual)
    likelier = late.independent * np.log(best.residual / max(late.residual, 1e-300))
    return replace(late, limit=best.limit) if likelier > MARGIN + 0.5 * np.log(late.independent) else best


def _within_limit(trace: Trace, effort: Array, best: Law) -> Law:
    """The law by the samples within a limit of the torque, where it has one: the law does not explain those at it."""
    size, most = np.abs(effort), float(np.abs(effort).max())
    near = size >= SURELY * most
    noise = CLEAR * float(np.median(np.r_[np.abs(np.diff(effort))[near[1:] & near[:-1]], 0.0]))
    reading = replace(best.reading, edge=(1.0 - NEAR) * (most - noise) - noise)
    at = size >= reading.edge
    runs = np.flatnonzero(np.diff(np.r_[False, at, False])).reshape(-1, 2)
    inner = [size[first + 1 : last - 1] for first, last in runs.tolist() if last - first >= ROW]
    if not inner:
        return best
    try:
        within = _fitted(trace, effort, reading)
    except UndeterminedError:  # nearly always at it
        return best
    time, (torque, modelled) = replace(within, reading=best.reading).torque(trace, effort)
    inside = at[np.searchsorted(trace.time, time - 0.5 * trace.sample_period)]
    if not inside.any() or rms((torque - modelled)[inside]) < UNLIKE * within.residual:
        return best
    values = np.concatenate(inner)
    level, error = float(np.median(values)), float(np.std(values) / np.sqrt(values.size))
    return replace(within, limit=Parameter(level, "", error, (level - NORMAL95 * error, level + NORMAL95 * error)))


def _fitted(trace: Trace, effort: Array, how: Reading) -> Law:
    """The law by least squares; UndeterminedError where too few samples are within the limit."""
    names, smooth, source = how.names, how.smooth, how.source
    time, table, _ = how.rows(trace, effort)
    if time.size < LEAST * len(names):
        raise UndeterminedError("gains of the controller", f"{time.size} samples are within its limit", "10 s or more")
    loud, counts, own = (
        white_noise(*(one[part] for part in trace.segments)) for one in (trace[source], trace["position"], effort)
    )
    edges, order = block_edges(time, smooth.width), int(source == "position")
    theta = equations(names, table, np.zeros((len(names),) * 2), edges).solved()[0]
    residual = rms(table[-1] - theta @ table[:-1])
    own = min(own, residual / smooth.noise_gain(0))  # the rest of the effort's noise is the controller's answer
    of = {ERROR: (counts, 0), RATE: (loud, order), BENT: (loud, order + 1), LATE: (own, 1)}
    noise = np.array([(of[name][0] * smooth.noise_gain(of[name][1])) ** 2 if name in of else 0.0 for name in names])
    noise *= not _fed_back(trace, effort, source, float(theta[1]))
    every = equations(names, table, np.diag(noise), edges)
    theta, inverse = every.solved()
    covariance, reach = estimated(every.scores(theta), inverse, own**2 / smooth.stride)
    left = table[-1] - theta @ table[:-1]
    floor = float(np.sqrt((own * smooth.noise_gain(0)) ** 2 + noise[:-1] @ theta[:-1] ** 2))
    covariance += np.diag((misfit(table[:-1].T, left, floor) / reach) ** 2)
    explained = 1.0 - float(left @ left) / max(float(table[-1] @ table[-1]), 1e-300)
    independent = time.size * smooth.stride * trace.sample_period / (2.0 * math.sqrt(math.pi) * smooth.width)
    values = dict(zip(names, theta.tolist(), strict=True))
    return Law(how, values, covariance, reach, rms(left), floor, explained, trace.sample_period, independent)


def _fed_back(trace: Trace, effort: Array, source: str, gain: float) -> bool:
    """Whether the controller answers to the noise of the recorded speed, as one does whose own speed it is.

    Noise of a recorder that the controller does not have makes its column weaker, noise that it has does not. Of
    differences of high order most is noise, and the torque's are then by -kv those of the speed, or by none.
    """
    answered = 0.0
    for part in trace.segments:
        motion = trace[source][part]
        speed = np.diff(motion) / trace.sample_period if source == "position" else motion[1:]
        speed, torque = np.diff(speed, NOISY), np.diff(effort[part][1:], NOISY)
        answered += float(-(torque + 0.5 * gain * speed) @ speed)
    return answered > 0.0
