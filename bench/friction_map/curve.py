"""A curve of friction over speed, fitted to points: plain, or bent by one effect of speed alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.optimize
import scipy.stats

from bench.arrays import Array
from bench.effects.catalogue import catalogue
from bench.effects.effect import OfSpeed
from bench.effects.signals import Base, Signals


@dataclass(frozen=True)
class Curve:
    """Friction over speed as fitted, with one effect or, where the name is empty, without.

    Attributes:
        name: of the effect.
        shape: what enters nonlinearly - SI.
        theta: K_w, K_0, M_0, strengths of the effect - SI. M_0 is 0 where the effect holds a constant torque itself.
        squares: sum of what it leaves - effort squared.
        freedom: numbers fitted.
        constant: whether M_0 was fitted beside the effect.
    """

    name: str
    shape: tuple[float, ...]
    theta: Array
    squares: float
    freedom: int
    constant: bool

    def effort(self, velocity: Array) -> Array:
        """Effort (n,) at speeds - rad/s (m/s) - (n,)."""
        return _columns(self.name, self.shape, velocity) @ self.theta


def plain_curve(velocity: Array, effort: Array) -> Curve:
    """The curve without an effect through points - rad/s (m/s), N*m (N) - (n,)."""
    return _fitted("", (), velocity, effort)


def bent_curve(name: str, velocity: Array, effort: Array) -> Curve:
    """The curve with an effect through points, its shape the one that leaves least within what physics allows.

    Args:
        name: of an effect of speed alone, whose shapes are speeds.
        velocity, effort: points - rad/s (m/s), N*m (N) - (n,).
    """
    shapes = len(catalogue()[name].shapes)
    if not shapes:
        return _fitted(name, (), velocity, effort)
    reach = float(np.log(np.abs(velocity).min())), float(np.log(0.5 * np.abs(velocity).max()))

    def curve(logarithms: Array) -> Curve:
        return _fitted(name, tuple(np.exp(np.atleast_1d(logarithms)).tolist()), velocity, effort)

    return curve(scipy.optimize.brute(lambda x: curve(x).squares, (reach,) * shapes, Ns=60, finish=None))


def _columns(name: str, shape: tuple[float, ...], velocity: Array) -> Array:
    """Columns (n, 3 + strengths) of speed, its sign, a constant and the effect."""
    zero, sign = np.zeros_like(velocity), np.sign(velocity)
    columns = [velocity, sign, np.ones_like(velocity)]
    if name:
        signals = Signals(zero, zero, velocity, sign, zero, zero, sign, 1.0, 1.0)
        effect = catalogue()[name]
        assert isinstance(effect, OfSpeed)
        columns += [sum((values for values, _ in column), zero) for column in effect.columns(signals, shape)]
    return np.column_stack(columns)


def _holds_constant(table: Array) -> bool:
    return bool((np.ptp(table[:, 3:], axis=0) == 0.0).any())


def _fitted(name: str, shape: tuple[float, ...], velocity: Array, effort: Array) -> Curve:
    table = _columns(name, shape, velocity)
    constant = not _holds_constant(table)
    if not constant:
        table[:, 2] = 0.0
    solved, _, rank, _ = np.linalg.lstsq(table, effort, rcond=1e-10)
    theta = np.asarray(solved, dtype=np.float64)
    squares = float(np.sum((effort - table @ theta) ** 2))
    base = Base(1.0, float(theta[0]), float(theta[1]))
    if name and not catalogue()[name].physical(theta[3:].tolist(), shape, base):
        squares = float("inf")
    return Curve(name, shape, theta, squares, int(rank) + len(shape), constant)


def chance(plain: Curve, tried: Curve, points: int, rounding: float) -> float:
    """Probability of the F-test that an effect's columns and shape save nothing; squares below `rounding` are none."""
    added, left = tried.freedom - plain.freedom, points - tried.freedom
    if not np.isfinite(tried.squares) or added < 1:
        return 1.0
    ratio = (plain.squares - tried.squares) / added / (max(tried.squares, rounding) / left)
    return float(scipy.stats.f.sf(ratio, added, left))
