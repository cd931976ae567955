"""Dead time: a torque that acts, or a motion that is read, some samples later than recorded; or a first-order lag.

    M(t - T) = M - T*dM/dt + T**2/2*d2M/dt2 - ...     acts, of a dead time T of the command or of the sensors of motion
    M - tau*dM/dt + tau**2*d2M/dt2 - ...              acts, of a first-order lag tau of the torque

So behind the torque that is shifted by T, a second derivative of it counts 0 or T**2/2; whether its interval is that
narrow depends on how fast the motion is. A torque whose reading is late acts as M(t + T), or of a lag M + tau*dM/dt:
0 or -T**2/2. A torque that acts later and a motion that is older look the same: torque and motion give the sum. A
recorded command of the torque gives the part before the recorded torque.

    M(t) = g*M_ref(t - T) - tau*dM/dt + M_0

M_ref - command (`torque_reference`); g - its gain.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from bench.arrays import NORMAL95, Array, rms, splined
from bench.axis_kind import MISALIGNMENT, AxisKind
from bench.effects.catalogue import catalogue
from bench.effects.effect import Lag, lagged
from bench.effects.signals import Signals
from bench.errors import UndeterminedError
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows
from bench.fit.solution import BLOCKS, block_edges, equations, estimated, solved
from bench.parameter import Parameter
from bench.trace.filter import Column, GaussianFilter
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: Sides on which the torque is late, by the signal that lags: it acts later, or it is read later.
SIDES = {"torque": -1.0, "current": 1.0}
#: Names of signals that are shifted, and of the column of the second derivative.
LATER, BENT = "later effort", "second derivative of the effort"
#: Samples of a stretch in which a command is followed, at least and at most, and places between two of them.
FEWEST, MOST, FINER = 256, 2**15, 8
#: Residual of a torque that follows its command, over its standard deviation, at most.
FOLLOWS = 0.5
#: Longest dead time of a command that is sought - s -, and samples of it.
LONGEST, MOST_LATE = 0.1, 60
#: Share of noise in the second derivative of the effort from which on a wider filter is taken, and by which it is.
NOISY, LOWER = 0.25, (1.5, 2.0, 3.0, 4.0, 6.0)
#: Turns of the search of a dead time, and samples by which it moves in the last.
TURNS, SETTLED = 8, 0.01


@dataclass(frozen=True)
class DeadTime:
    """By how much the torque is later than the motion.

    Attributes:
        delay: as a dead time - s; positive where the torque acts after it is recorded, or the motion is read late.
        lag: as time constant of a first-order lag of the torque, or, where the delay is negative, of its reading - s.
        kind: which of the two it is; None where the motion does not show it.
        period: of the samples - s.
        bound: whether the search of the delay ended at its bound.
    """

    delay: Parameter
    lag: Parameter
    kind: Literal["dead_time", "first_order_lag"] | None
    period: float
    bound: bool = False

    def __str__(self) -> str:
        late = self.delay.value > 0.0
        size, lag = (f"{1e3 * abs(one.value):.3g} ± {1e3 * one.half_width:.2g} ms" for one in (self.delay, self.lag))
        text = (
            f"the torque acts {size} {'after' if late else 'before'} it is reported, which is more than a sample "
            f"({1e3 * self.period:.3g} ms): "
        )
        dead = f"a dead time of {'the command or of the sensors of the motion' if late else 'its reading'}"
        if self.bound:
            return f"{text}the search ended at its bound; record torque and motion by one clock"
        if self.kind == "dead_time":
            return f"{text}{dead}, not a first-order lag"
        if self.kind == "first_order_lag":
            return f"{text}a first-order lag of {lag}, not a dead time"
        return f"{text}{dead}, or a first-order lag of {lag}; faster motion would distinguish them"


@dataclass(frozen=True)
class CommandDelay:
    """How the recorded torque follows its command: after `dead_time`, with the time constant `lag` - s."""

    dead_time: Parameter
    lag: Parameter

    def __str__(self) -> str:
        dead, lag = (f"{1e3 * one.value:.3g} ± {1e3 * one.half_width:.2g} ms" for one in (self.dead_time, self.lag))
        text = f"the torque follows its command after a dead time of {dead}, with a first-order lag of {lag}"
        if self.dead_time.ci95[0] > 0.0 or self.lag.ci95[0] > 0.0:
            return text
        return f"{text}; the command changes too slowly to distinguish them"


def dead_time(rows: Rows, hypothesis: Hypothesis, shift: float, search: bool = True) -> DeadTime:
    """Dead time of a recording, against the lag in its place, by a hypothesis without a lag and without a shift.

    `shift` is by which the torque is reported late - s -, where a `search` begins or without one.
    """
    rows, period = _quiet(rows), rows.scope.sample_period
    late = _fit_later(rows, hypothesis, shift)
    for _ in range(TURNS if search else 0):
        remaining = late.value(MISALIGNMENT)
        if abs(remaining) < SETTLED * period:
            break
        shift += remaining
        late = _fit_later(rows, hypothesis, shift)
    at = int(np.flatnonzero(late.owners == MISALIGNMENT)[0])
    straight, (theta, half) = _straight_and_bent(late)
    delay = _parameter(-shift, float(straight[1][at]) + SETTLED * period)
    moved = float(theta[at]) - float(straight[0][at])  # by the second derivative; the third moves a lag by less
    lag = _parameter(abs(shift + float(theta[at])), float(half[at]) + SETTLED * period + abs(moved))
    expected = 0.5 * shift * abs(shift)  # of a lag, on the side of the columns
    share, reach = theta[-1] / expected, half[-1] / abs(expected)
    kind, bound = None, search and at in late.held
    if not bound and reach < abs(share - 0.5) < 1.0 + reach:  # on the side of one of them, and not far beyond
        kind = "dead_time" if share < 0.5 else "first_order_lag"
    return DeadTime(delay, lag, kind, period, bound)


def with_delay(hypothesis: Hypothesis, late: DeadTime) -> tuple[Hypothesis, ...]:
    """A hypothesis in which the torque is late as was found, and one with its lag at the end of the interval.

    () where the motion does not show in what way it is late; a dead time, which the shift corrects, has one.
    """
    if late.kind == "dead_time":
        return (replace(hypothesis, shift=-late.delay.value),)
    if late.kind is None:
        return ()
    signal = "torque" if late.delay.value > 0.0 else "current"
    effects = (effect for effect in catalogue().values() if isinstance(effect, Lag) and effect.signal == signal)
    lag = next(effects)
    return tuple(hypothesis.plus(Term(lag, (size,))) for size in (late.lag.value, late.lag.ci95[1]))


def without_delay(hypothesis: Hypothesis) -> tuple[Hypothesis, float]:
    """A hypothesis without shift and lag of the torque, and by how much these made it late - s, as `shift`."""
    lags = [index for index in hypothesis.of_kind(Lag) if _side(hypothesis.terms[index])]
    shift = hypothesis.shift + sum(_side(hypothesis.terms[index]) * hypothesis.terms[index].shape[0] for index in lags)
    kept = (term for index, term in enumerate(hypothesis.terms) if index not in lags)
    return replace(hypothesis, terms=(*kept,), shift=0.0), shift


def _side(term: Term) -> float:
    """Of a lag of the torque, on which side it is; 0 of any other term."""
    return SIDES.get(term.effect.signal, 0.0) if isinstance(term.effect, Lag) else 0.0


def _quiet(rows: Rows) -> Rows:
    """Rows through the narrowest filter at which the effort's second derivative is hardly noise."""
    found, cutoff = rows, rows.conditioning.filter.cutoff
    for lower in LOWER:
        noise = found.conditioning.effort_noise * found.conditioning.filter.noise_gain(2)
        if noise < NOISY * rms(found.kept(_bent)):
            break
        try:
            found = rows.through(GaussianFilter.from_cutoff(cutoff / lower, rows.scope.sample_period))
        except UndeterminedError:
            break
    return found


def _fit_later(rows: Rows, hypothesis: Hypothesis, shift: float) -> Fit:
    """The fit of a recording whose effort is shifted."""
    return fit(rows.with_signals(partial(_later, shift=shift), (LATER, shift)), hypothesis)


def _later(signals: Signals, shift: float) -> Signals:
    """Signals with the recorded effort as it is a shift later, by a spline."""
    fine = splined(signals.effort + signals.of_motion, FINER)[0]
    places = (np.arange(signals.effort.size) + shift / signals.sample_period) * FINER
    return replace(signals, effort=np.interp(places, np.arange(fine.size), fine) - signals.of_motion)


def _parameter(value: float, half: float) -> Parameter:
    return Parameter.around(value, "s", half / NORMAL95, half)


def _straight_and_bent(late: Fit) -> Iterator[tuple[Array, Array]]:
    """Coefficients with the half widths of their intervals, without and with a second derivative of the effort."""
    rows, smooth = late.rows, late.rows.conditioning.filter
    names = (*range(late.theta.size), BENT)
    bent = rows.kept(_bent)[:, 0]
    loud = rows.conditioning.effort_noise
    noise = np.pad(late.layout.noise, (0, 1))
    noise[-1, -1] = (loud * smooth.noise_gain(2)) ** 2
    table = np.vstack([late.columns.T, bent, late.effort])
    every = equations(names, table, noise, block_edges(rows.time, smooth.width), late.layout.known)
    for kept in (names[:-1], names):
        part = every.only(lambda name, kept=kept: name in kept)
        moment = part.moments.copy()
        if kept is names:  # the noise of the torque is in its second derivative, too: -(s_M*w)**2
            moment[-1] += part.count * (loud * smooth.noise_gain(1)) ** 2
        theta, inverse = solved(part.total, moment, part.count * part.noise)
        covariance, reach = estimated(part.scores(theta), inverse, loud**2 / smooth.stride)
        yield theta, reach * np.sqrt(np.maximum(np.diag(covariance), 0.0))


def dead_time_of(fitted: Fit) -> DeadTime | None:
    """Dead time of a fit whose torque is shifted, or in the place of its lag, if that is longer than a sample."""
    (bare, shift), shifted = without_delay(fitted.hypothesis), bool(fitted.hypothesis.shift)
    if not shifted and abs(shift) <= fitted.scope.sample_period:
        return None
    return dead_time(fitted.rows, bare, fitted.shift if shifted else shift, search=False)


def _bent(signals: Signals) -> list[Column]:
    """Second derivative of the recorded effort."""
    return [[(signals.effort + signals.of_motion, 2)]]


def command_delay(trace: Trace, kind: AxisKind) -> CommandDelay | None:
    """Of the recorded torque (force, current) behind its command; None where it is in step, or none is recorded.

    A command that is held between samples acts half a sample later than it is recorded: that is part of the dead time.
    """
    from scipy.optimize import least_squares  # 0.2 s, which only a command has to pay

    name = next((name for name in (kind.effort, "current") if name in trace), "")
    part = max(trace.segments, key=lambda one: one.stop - one.start)
    part = slice(part.start, min(part.stop, part.start + MOST))
    if not name or "torque_reference" not in trace or part.stop - part.start < FEWEST:
        return None
    asked, torque, period = trace["torque_reference"][part], trace[name][part], trace.sample_period
    if not np.ptp(asked) > 0.0:
        return None
    fine, steps = splined(asked, FINER)[0], np.arange(asked.size, dtype=np.float64) * FINER

    def columns(delay: float, lag: float) -> Array:
        """The command behind both, and a constant (n, 2)."""
        late = np.interp(steps - delay / period * FINER, np.arange(fine.size), fine)
        return np.stack([lagged(late, lag, period), np.ones(late.size)], axis=1)

    def fitted(place: Array) -> Array:
        table = columns(*place)
        return table @ np.linalg.lstsq(table, torque, rcond=None)[0]

    def slopes(place: Array) -> Array:
        return np.stack([(fitted(place + one) - fitted(place)) / step for one in step * np.eye(2)], axis=1)

    step = SETTLED * period
    lates = range(0, min(MOST_LATE, round(LONGEST / period)) + 1, 2)
    starts = [np.array([k * period, lag]) for k in lates for lag in (step, 2.0 * period)]
    begun = min(starts, key=lambda place: rms(fitted(place) - torque))
    bounds = [0.0, step], [2.0 * LONGEST] * 2
    found = least_squares(
        lambda place: fitted(place) - torque,
        begun,
        slopes,  # pyright: ignore[reportArgumentType] - its stub knows names only
        bounds,
        x_scale=period,
    )
    if sum(found.x) < 0.5 * period or rms(found.fun) > FOLLOWS * np.std(torque):
        return None
    table = np.vstack([*columns(*found.x).T, *slopes(found.x).T, torque - fitted(found.x)])
    edges = np.linspace(0, torque.size, min(BLOCKS, torque.size // FEWEST * 16) + 1).astype(np.int64)
    every = equations((*range(4),), table, np.zeros((4, 4)), edges)
    covariance, reach = estimated(every.scores(np.zeros(4)), every.solved()[1], white_noise(torque) ** 2)
    half = reach * np.sqrt(np.maximum(np.diag(covariance)[2:], 0.0)) + step
    return CommandDelay(*map(_parameter, found.x.tolist(), half.tolist()))
