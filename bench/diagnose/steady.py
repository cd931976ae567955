"""Friction over steady speeds: several recordings, each at one speed, tell how friction depends on it, without inertia.

    M(omega) = K_w*omega + K_0*sgn(omega) + M_0 (+ an effect of speed alone)

Each recording gives one point, the means of its speed and torque: at a steady speed inertia takes no torque, and what
repeats with position averages out. An effect is named where an F-test over all shapes tried says that chance would not
save as many squares. A single recording at one speed tells none of this, and no such map tells the inertia.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize
import scipy.stats
from numpy.typing import NDArray

from bench.effects.catalogue import catalogue
from bench.effects.effect import Base, Signals
from bench.errors import UndeterminedError
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Array = NDArray[np.float64]

#: Effects that depend on speed alone.
OF_SPEED = ("stribeck_friction", "quadratic_drag", "direction_dependent_friction")
#: Chance that a map without an effect gets a name, for all shapes of all effects tried together.
CHANCE = 1e-3
#: Points in each direction below which curvature is not told from scatter.
LEAST = 8


@dataclass(frozen=True)
class SteadyFriction:
    """What a map of friction over speed shows.

    Attributes:
        velocity, effort: a point for each recording - rad/s (m/s), N*m (N) - (n,).
        base: K_w and K_0; inertia nan.
        name: of the effect, None where chance explains as much.
        values: of the effect's quantities - SI.
        probability: that chance saves as many squares, for the best effect.
        unexplained: norm of what is left over that of the effort, without and with the best effect.
    """

    velocity: Array
    effort: Array
    base: Base
    name: str | None
    values: dict[str, float]
    probability: float
    unexplained: tuple[float, float]


@dataclass(frozen=True)
class _Tried:
    name: str
    shape: tuple[float, ...]
    theta: Array
    squares: float
    freedom: int


def steady_friction(recordings: Sequence[Trace], rig: Rig) -> SteadyFriction:
    """Friction over the speeds of recordings at one speed each.

    Raises:
        UndeterminedError: fewer than LEAST speeds in a direction.
        InputError: a recording holds no torque or speed.
    """
    velocity = np.array([float(trace["velocity"].mean()) for trace in recordings])
    effort = np.array([float(rig.effort(trace)[0].mean()) for trace in recordings])
    fewest = int(min((velocity > 0.0).sum(), (velocity < 0.0).sum()))
    if fewest < LEAST:
        reason = f"found {fewest} steady speeds in one of the directions"
        raise UndeterminedError("friction over speed", reason, f"at least {LEAST} different speeds in each direction")
    plain = _fitted("", (), velocity, effort)
    tried = [_best(name, velocity, effort) for name in OF_SPEED]
    chances = [_chance(plain, one, effort.size) for one in tried]
    best = int(np.argmin(chances))
    probability = min(1.0, len(OF_SPEED) * chances[best])
    name = tried[best].name if probability < CHANCE else None
    kept = tried[best] if name else plain
    base = Base(float("nan"), float(kept.theta[0]), float(kept.theta[1]))
    values = dict(catalogue()[name].values(kept.theta[3:].tolist(), kept.shape, base)) if name else {}
    total = float(effort @ effort)
    left = (float(np.sqrt(plain.squares / total)), float(np.sqrt(tried[best].squares / total)))
    return SteadyFriction(velocity, effort, base, name, values, probability, left)


def _best(name: str, velocity: Array, effort: Array) -> _Tried:
    """The effect with the shape that leaves least, within what physics allows."""
    effect = catalogue()[name]
    if not effect.shapes:
        return _fitted(name, (), velocity, effort)
    low, high = np.log(np.abs(velocity).min()), np.log(0.5 * np.abs(velocity).max())
    found = scipy.optimize.brute(
        lambda x: _fitted(name, (float(np.exp(x[0])),), velocity, effort).squares, ((low, high),), Ns=60, finish=None
    )
    return _fitted(name, (float(np.exp(found)),), velocity, effort)


def _fitted(name: str, shape: tuple[float, ...], velocity: Array, effort: Array) -> _Tried:
    sign = np.sign(velocity)
    columns = [velocity, sign, np.ones_like(velocity)]
    if name:
        zero = np.zeros_like(velocity)
        signals = Signals(zero, zero, velocity, sign, effort, effort, sign, 1.0, 1.0)
        columns += [sum((values for values, _ in column), zero) for column in catalogue()[name].columns(signals, shape)]
    table = np.column_stack(columns)
    solved, _, rank, _ = np.linalg.lstsq(table, effort, rcond=1e-10)
    theta = np.asarray(solved, dtype=np.float64)
    squares = float(np.sum((effort - table @ theta) ** 2))
    base = Base(1.0, float(theta[0]), float(theta[1]))
    if name and not catalogue()[name].physical(theta[3:].tolist(), shape, base):
        squares = float("inf")
    return _Tried(name, shape, theta, squares, int(rank) + len(shape))


def _chance(plain: _Tried, tried: _Tried, points: int) -> float:
    """Probability of the F-test that an effect's columns and shape save nothing."""
    added, left = tried.freedom - plain.freedom, points - tried.freedom
    if not np.isfinite(tried.squares) or added < 1:
        return 1.0
    ratio = (plain.squares - tried.squares) / added / (tried.squares / left)
    return float(scipy.stats.f.sf(ratio, added, left))
