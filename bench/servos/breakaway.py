"""Static friction of a position-controlled joint whose balance is known: the torque at which it breaks loose.

At rest, with the position q_0 and the load M of the links, the torque of the controller is u = kp*(g(t - d) + b - q_0).
The joint breaks loose at t_0, where |u - M| reaches K_s, and moves by

    x(t) = integral from t_0 to t of h(t - s)*(|u - M| - K_0) ds,   h: impulse response of J*x'' + (K_w + kd)*x' + kp*x

so that each stop has one unknown, t_0, and all stops of a log have one, K_s. Its likelihood is the sum over the stops,
in which no noisy one counts for more than it shows. A goal that is held passes K_s within a step, which is
unknown by the step's height over sqrt(12). Whether stops agree is judged by leaving out each (delete-one jackknife).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its special functions load when first used: 0.2 s

from bench.arrays import NORMAL95, Array
from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.errors import UndeterminedError
from bench.parameter import Parameter
from bench.servos.commanded import TERMS, Coefficients, JointBalance
from bench.trace.motion import slope
from bench.trace.signals import KNOWN_INERTIA, KNOWN_MOMENTUM, KNOWN_TORQUE
from bench.trace.trace import Trace

#: A stop is at least HELD long; SETTLES after its beginning it is compared, until AFTER its end - s.
HELD, SETTLES, AFTER = 0.04, 0.02, 0.06
#: Fewest samples of a window in which a joint is at rest, and steps of the integration in a sample.
FEWEST, FINER = 8, 4
#: Standard deviations of the position's noise by which halves of a window at rest may differ, their samples too, and
#: by which a joint has to move to have broken loose.
ALIKE, WITHIN, LOOSE = 1.5, 7.0, 6.0
#: Stops below which there is no interval.
STOPS = 4
#: Squared residual over that of noise above which something else moved the joint.
ELSE = 2.0
#: Levels of the friction that are tried.
LEVELS = 600


@dataclass(frozen=True)
class Stop:
    """A rest and how the joint left it.

    Attributes:
        force: torque against the friction - N*m (N) - at steps of the integration (k,).
        moved: by which the joint moves if it breaks loose at a step: at samples, by steps (s, k) - rad (m).
        measured: how it moved, from where it was on average at rest - rad (m) - (s,).
    """

    force: Array
    moved: Array
    measured: Array

    def misfit(self, levels: Array, noise: float) -> tuple[Array, Array]:
        """Squared residual over the noise - rad (m) - by levels of friction (l,), and the force's rise in a sample."""
        steps = np.arange(self.force.size)
        top = np.maximum.accumulate(self.force) + 1e-12 * steps
        at = np.interp(levels, top, steps, right=steps[-1])
        first = np.clip(at.astype(np.int64), 0, steps[-1] - 1)
        share = at - first
        error = self.measured[:, None] - (self.moved[:, first] * (1.0 - share) + self.moved[:, first + 1] * share)
        misfit = np.sum((error - error.mean(axis=0)) ** 2, axis=0) / noise**2
        return misfit, np.asarray(FINER * np.gradient(top)[first], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class StaticFriction:
    """Static friction of a joint.

    Attributes:
        level: by the stops, with the coefficients of the balance as they are.
        slopes: by which it changes with each coefficient (5,).
    """

    level: Parameter
    slopes: Array

    def at(self, own: Coefficients, found: Coefficients) -> Parameter:
        """With other coefficients than the joint's own, and with their errors."""
        value = self.level.value + float(self.slopes @ (found.theta - own.theta))
        error = float(np.sqrt(max(self.slopes @ found.covariance @ self.slopes, 0.0)))
        return self.level.at(value, positive=False).widened(NORMAL95 * error)


def static_friction(one: JointBalance) -> StaticFriction:
    """Static friction of a joint by its balance; UndeterminedError where it is too seldom at rest."""
    level, slopes = _level(one), np.zeros(len(TERMS))
    for k, error in enumerate(one.found.errors):
        theta = one.found.theta + np.where(np.arange(len(TERMS)) == k, error, 0.0)
        try:
            moved = _level(replace(one, found=replace(one.found, theta=theta))).value - level.value
        except UndeterminedError:  # of stops that are few as it is
            moved = 0.0
        slopes[k] = moved / max(error, 1e-300)
    return StaticFriction(level, slopes)


def _level(one: JointBalance) -> Parameter:
    """The level of most likelihood with its interval."""
    coulomb = max(float(one.found.theta[TERMS.index(COULOMB)]), 0.0)
    stops = list(_stops(one))
    if not stops:
        raise _seldom(0)
    levels = np.linspace(coulomb, max(float(stop.force.max()) for stop in stops), LEVELS)
    pairs = [(stop.misfit(levels, one.noise), stop.measured.size) for stop in stops]
    pairs = [(misfit, size) for misfit, size in pairs if misfit[0].min() < ELSE * size]
    if len(pairs) < STOPS:
        raise _seldom(len(pairs))
    misfits, rises = np.array([misfit for misfit, _ in pairs]).swapaxes(0, 1)
    k, spacing = int(np.argmin(misfits.sum(axis=0))), float(levels[1] - levels[0])
    variances = 1.0 / np.maximum(0.5 * _bend(misfits, k, spacing), 1e-9)
    misfits = misfits * (variances / (variances + rises[:, k] ** 2 / 12.0))[:, None]
    whole = misfits.sum(axis=0)
    best, others = _least(whole, levels), np.array([_least(whole - own, levels) for own in misfits])
    count = len(misfits)
    spread = (count - 1) / count * float(np.sum((others - others.mean()) ** 2))
    certain = 1.0 / max(0.5 * float(_bend(whole, int(np.argmin(whole)), spacing)), 1e-9)
    reach = float(scipy.special.stdtrit(count - 1, 0.975))
    inside = levels[whole - whole.min() <= max(spread / certain, 1.0) * reach**2]
    low, high = min(float(inside[0]), best), max(float(inside[-1]), best)
    return Parameter(best, one.found.kind.effort_unit, 0.5 * (high - low) / reach, (low, high))


def _seldom(count: int) -> UndeterminedError:
    reason = f"the joint breaks loose {count} times after a rest of {1e3 * (HELD + SETTLES):.0f} ms, {STOPS} are needed"
    return UndeterminedError("static friction", reason, "slow goals that turn back often, such as waves below 0.5 Hz")


def _bend(misfits: Array, k: int, spacing: float) -> Array:
    """Second derivative of misfits (..., l) over the level, around one of them."""
    k = min(max(k, 5), misfits.shape[-1] - 6)
    return (misfits[..., k - 5] - 2.0 * misfits[..., k] + misfits[..., k + 5]) / (5.0 * spacing) ** 2


def _least(misfit: Array, levels: Array) -> float:
    """The level of the least misfit (l,), by a parabola through three."""
    k = int(np.clip(np.argmin(misfit), 1, levels.size - 2))
    before, here, after = misfit[k - 1 : k + 2]
    bend = before - 2.0 * here + after
    place = k + 0.5 * (before - after) / bend if bend > 0.0 else float(np.argmin(misfit))
    return float(np.interp(np.clip(place, k - 1, k + 1), np.arange(levels.size), levels))


def _stops(one: JointBalance) -> Iterator[Stop]:
    """Stops of a joint that it leaves by breaking loose."""
    trace, period = one.trace, one.trace.sample_period
    held, settles, after = (max(round(time / period), FEWEST // 2) for time in (HELD, SETTLES, AFTER))
    held = max(held, FEWEST)
    for part in trace.segments:
        position = trace["position"][part]
        load, margin = _load(one, trace[part])
        if position.size <= 2 * margin:
            continue
        for begin, last in _standing(position, held, one.noise):
            first = max(begin + settles, last - 2 * held)
            if last - first >= held // 2 + settles // 2 and first >= margin and last + after < position.size - margin:
                rest = _left(one, part.start, (first, last, last + after), held // 2, load)
                if rest is not None:
                    yield rest


def _standing(position: Array, held: int, noise: float) -> Iterator[tuple[int, int]]:
    """First and last sample of stretches at rest, of at least `held` samples."""
    half = held // 2
    windows = np.lib.stride_tricks.sliding_window_view(position, 2 * half)
    change = np.abs(windows[:, :half].mean(axis=1) - windows[:, half:].mean(axis=1))
    still = (change < ALIKE * noise * np.sqrt(8.0 / half)) & (np.ptp(windows, axis=1) < WITHIN * noise)
    edges = np.flatnonzero(np.diff(np.r_[0, still.astype(np.int64), 0])).reshape(-1, 2)
    return ((int(start), int(stop) + 2 * half - 2) for start, stop in edges)


def _load(one: JointBalance, trace: Trace) -> tuple[Array, int]:
    """Load of the links on a joint whose own acceleration is not in it - N*m (N) -, and samples that it lacks at ends.

    What other joints do to it is smooth; where it breaks loose itself its acceleration is not.
    """
    smooth = replace(one.rows.conditioning.filter, stride=1)
    load, inner = np.full(len(trace), np.nan), slice(smooth.margin, len(trace) - smooth.margin)
    if len(trace) > 2 * smooth.margin:
        momentum = trace[KNOWN_MOMENTUM] - trace[KNOWN_INERTIA] * slope(trace["position"], trace.sample_period)
        (load[inner],) = smooth.columns([[(trace[KNOWN_TORQUE], 0), (momentum, 1)]])
    return load, smooth.margin


def _left(one: JointBalance, start: int, places: tuple[int, int, int], half: int, load: Array) -> Stop | None:
    """A rest by its first sample, its last, and the last that is compared; None where the joint does not move."""
    first, last, stop = places
    trace, found, period = one.trace, one.found, one.trace.sample_period
    inertia, damping, coulomb = (float(found.theta[TERMS.index(term)]) for term in (INERTIA, VISCOUS, COULOMB))
    position = trace["position"][start + first : start + stop + 1]
    rest = float(position[: last - half + 1 - first].mean())
    away = float(position[-4:].mean()) - rest
    if abs(away) < LOOSE * one.noise:
        return None
    side, at = np.copysign(1.0, away), first + np.arange((stop - first) * FINER + 1) / FINER
    torque = found.gains.kp * (one.goal(start + at) + found.bias - rest) - np.interp(at, np.arange(load.size), load)
    force = side * torque
    step = period / FINER
    inertia += float(trace[KNOWN_INERTIA][start + last])
    middles = step * (np.arange(at.size, dtype=np.float64) + 0.5)
    response = _impulse(inertia, damping, found.gains.kp, middles)
    later = np.arange(at.size)[::FINER, None] - 1 - np.arange(at.size)
    middle = 0.5 * (force + np.append(force[1:], force[-1])) - coulomb
    parts = np.where(later >= 0, response[np.maximum(later, 0)], 0.0) * middle * step
    moved = np.cumsum(parts[:, ::-1], axis=1)[:, ::-1]
    return Stop(force, moved, side * (position - rest))


def _impulse(inertia: float, damping: float, stiffness: float, time: Array) -> Array:
    """Impulse response of J*x'' + D*x' + k*x at times (n,)."""
    half = 0.5 * damping / inertia
    root = np.sqrt(complex(half**2 - stiffness / inertia))
    root = root if root != 0.0 else 1e-9 + 0.0j
    return (np.exp(-half * time) * np.sinh(root * time) / (inertia * root)).real
