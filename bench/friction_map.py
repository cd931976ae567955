"""Friction over steady speeds: recordings at one speed each, or of several speeds one after the other, determine how
friction depends on speed, without inertia.

    M(omega) = K_w*omega + K_0*sgn(omega) + M_0 (+ an effect of speed alone)

Each steady stretch gives one point, the means of its speed and torque: at a steady speed inertia takes no torque, and
what repeats with position averages out. An effect is named where an F-test over all shapes tried shows that chance
would not save as many squares. A lone speed determines none of this, and no such map determines the inertia.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize
import scipy.stats

from bench.arrays import Array
from bench.axis_kind import AxisKind
from bench.effects.catalogue import catalogue
from bench.effects.effect import Columns
from bench.effects.signals import Axis, Signals
from bench.errors import InputError, UndeterminedError
from bench.gate.check import Check
from bench.gate.gate import STEADY as STEADY_CHECKS
from bench.gate.gate import joined, passed
from bench.presented import ByName
from bench.rig.given import Given, GivenRig, Units, recordings_of
from bench.rig.rig import Rig
from bench.trace.motion import measured_velocity
from bench.trace.trace import Trace

#: Chance that a map without an effect gets a name, for all shapes of all effects tried together.
CHANCE = 1e-3
#: Speeds in each direction below which curvature is lost in scatter.
LEAST = 8
#: Parts of a recording whose mean speeds show whether it keeps one, and how far they may differ, as share of it: a
#: screw drive at its slowest, published as steady, has 0.35, a ramp from rest 1.75.
PARTS, STEADY = 8, 0.5
#: Lengths of the windows that show where a recording of several speeds keeps one - s; samples of the shortest; and how
#: far the means of a window's quarters, and of a stretch's, differ at most, as share of the speed.
WINDOWS, SAMPLES, KEPT = (0.05, 0.1, 0.2, 0.4, 0.8), 8, 0.01
#: Share of all squares due to rounding in a map without scatter.
ROUNDING = 1e-24


@dataclass(frozen=True)
class FrictionCurve:
    """Friction over speed as fitted, with one effect or, where the name is empty, without.

    Attributes:
        name: of the effect.
        shape: what enters nonlinearly - SI.
        theta: K_w, K_0, M_0, strengths of the effect - SI. M_0 is 0 where the effect contains a constant torque itself.
        squares: sum of its residuals - effort squared.
        freedom: numbers fitted.
        constant: whether M_0 was fitted with the effect.
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


@dataclass(frozen=True)
class FrictionMap(ByName):
    """What a map of friction over speed shows.

    Attributes:
        velocity, effort: a point for each steady stretch - rad/s (m/s), N*m (N) - (n,).
        effort_unit: N*m, N, or what the rig allows.
        kind: of the axis.
        plain, best: curves without an effect and with the one that explains most; the same where physics allows none.
        base: K_w and K_0 of the valid curve; inertia nan.
        offset: M_0 of that curve; None where the named effect contains a constant torque, which no map distinguishes
            from it.
        name: of the effect, None where chance explains as much.
        values: of the effect's quantities - SI.
        probability: that chance saves as many squares, for the best effect.
        unexplained: norm of the residual over that of the effort, without and with the best effect.
        checks: of the recordings, the worst of each.
    """

    velocity: Array
    effort: Array
    effort_unit: str
    kind: AxisKind
    plain: FrictionCurve
    best: FrictionCurve
    base: Axis
    offset: float | None
    name: str | None
    values: dict[str, float]
    probability: float
    unexplained: tuple[float, float]
    checks: tuple[Check, ...] = ()


def friction_map(recordings: Sequence[Given], rig: GivenRig | None = None, units: Units | None = None) -> FrictionMap:
    """Friction over the steady speeds of recordings, one or several in each; arguments as `identify` takes them.

    Raises:
        UndeterminedError: fewer than LEAST speeds in a direction, or none twice as fast as another.
        InputError: a recording has no torque or speed, fails a check, keeps no speed or was given twice, recordings
            give efforts in different units, or torque and speed are counted in opposite directions.
    """
    rig, traces = recordings_of(recordings, rig, units)
    gated = [passed(trace, rig, STEADY_CHECKS) for trace in traces]
    velocity, effort, unit = _points([one.trace for one in gated], rig)
    total = float(effort @ effort)
    plain = _best_fit("", (), velocity, effort)
    if plain.theta[0] * (velocity @ velocity) + plain.theta[1] * np.abs(velocity).sum() < 0.0:
        found = "found friction that drives the axis: torque and motion have opposite signs"
        allowed = "allowed: both counted the same way (a leading - in the rig's [trace.columns] turns one)"
        raise InputError("friction over speed", found, allowed)
    names = [name for name, effect in catalogue().items() if effect.of_speed]
    tried = [bent_curve(name, velocity, effort) for name in names]
    chances = [chance(plain, one, effort.size, ROUNDING * total) for one in tried]
    least = int(np.argmin(chances))
    best = tried[least] if np.isfinite(tried[least].squares) else plain
    probability = min(1.0, len(names) * chances[least])
    kept = best if probability < CHANCE else plain
    base = Axis(float("nan"), float(kept.theta[0]), float(kept.theta[1]))
    effect = catalogue()[kept.name] if kept.name else None
    return FrictionMap(
        velocity=velocity,
        effort=effort,
        effort_unit=unit,
        kind=rig.axis_kind,
        plain=plain,
        best=best,
        base=base,
        offset=float(kept.theta[2]) if kept.constant else None,
        name=kept.name or None,
        values={} if effect is None else dict(effect.report(kept.theta[3:].tolist(), kept.shape, base)),
        probability=probability,
        unexplained=(float(np.sqrt(plain.squares / total)), float(np.sqrt(best.squares / total))),
        checks=joined([one.checks for one in gated]),
    )


def _points(recordings: Sequence[Trace], rig: Rig) -> tuple[Array, Array, str]:
    """Mean speed and effort of each steady stretch, and the unit of the efforts."""
    points: dict[tuple[float, float], str] = {}
    units: dict[str, str] = {}
    for trace in recordings:
        effort, unit = rig.effort(trace)
        units[unit] = trace.origin
        velocity = measured_velocity(trace)
        for part in _steady(trace, velocity):
            point = float(velocity[part].mean()), float(effort[part].mean())
            if point in points:
                raise InputError(trace.origin, f"found the recording {points[point]} again", "allowed: each once")
            points[point] = trace.origin
    if len(units) > 1:
        found = ", ".join(f"{unit} in {origin}" for unit, origin in units.items())
        raise InputError(rig.source, f"gives efforts in different units ({found})", "allowed: one unit")
    table = np.array(list(points)).reshape(-1, 2)
    velocity = table[:, 0]
    fewest = min(_different(velocity[velocity > 0.0]), _different(-velocity[velocity < 0.0]))
    wanted = f"at least {LEAST} different speeds in each direction"
    if fewest < LEAST:
        raise UndeterminedError("friction over speed", f"found {fewest} steady speeds in one of the directions", wanted)
    if np.abs(velocity).max() <= 2.0 * np.abs(velocity).min():
        wanted += ", the fastest well over twice the slowest"
        raise UndeterminedError("friction over speed", "found no speed twice another", wanted)
    return velocity, table[:, 1], next(iter(units))


def _steady(trace: Trace, velocity: Array) -> list[slice]:
    """All of a recording that keeps one speed; else the stretches that do."""
    parts = [float(part.mean()) for part in np.array_split(velocity, min(PARTS, velocity.size))]
    if max(parts) - min(parts) < STEADY * abs(float(velocity.mean())):
        return [slice(None)]
    found = max((_stretches(trace, velocity, window) for window in WINDOWS), key=_samples)
    if not found:
        unit = trace.axis_kind.speed_unit
        keeps = f"keeps no speed: parts of it have means from {min(parts):.3g} to {max(parts):.3g} {unit}"
        allowed = f"allowed: steady speeds, each kept for well over {WINDOWS[0]:g} s, or recordings of one each"
        raise InputError(trace.origin, keeps, allowed)
    return found


def _samples(parts: Sequence[slice]) -> int:
    return sum(part.stop - part.start for part in parts)


def _stretches(trace: Trace, velocity: Array, window: float) -> list[slice]:
    """Windows whose quarters have the same mean speed, joined where they overlap, if that keeps one speed, too."""
    size, found = max(SAMPLES, round(window / trace.sample_period)) // 4, []
    for part in (part for part in trace.segments if part.stop - part.start >= 4 * size):
        sums = np.concatenate([[0.0], np.cumsum(velocity[part])])
        means = np.lib.stride_tricks.sliding_window_view(sums[size:] - sums[:-size], 3 * size + 1)[:, ::size] / size
        kept = np.ptp(means, axis=1) < KEPT * np.abs(means.mean(axis=1))
        edges = np.flatnonzero(np.diff(np.concatenate([[False], kept, [False]])))
        for first, last in edges.reshape(-1, 2) + part.start:
            one = slice(int(first) + size, int(last) + 3 * size - 1)
            quarters = [float(each.mean()) for each in np.array_split(velocity[one], 4)]
            if np.ptp(quarters) < KEPT * abs(float(np.mean(quarters))):
                found.append(one)
    return found


def _different(speeds: Array) -> int:
    """Speeds that differ by more than a hundredth: repetitions of one show scatter, not curvature."""
    return 1 + int((np.diff(np.log(np.sort(speeds))) > 0.01).sum()) if speeds.size else 0


def bent_curve(name: str, velocity: Array, effort: Array) -> FrictionCurve:
    """The curve with an effect of speed alone, its shape the physically allowed one of least residual."""
    shapes = len(catalogue()[name].shapes)
    if not shapes:
        return _best_fit(name, (), velocity, effort)
    reach = float(np.log(np.abs(velocity).min())), float(np.log(0.5 * np.abs(velocity).max()))

    def curve(logarithms: Array) -> FrictionCurve:
        return _best_fit(name, tuple(np.exp(np.atleast_1d(logarithms)).tolist()), velocity, effort)

    return curve(scipy.optimize.brute(lambda x: curve(x).squares, (reach,) * shapes, Ns=60, finish=None))


def _columns(name: str, shape: tuple[float, ...], velocity: Array) -> Array:
    """Columns (n, 3 + strengths) of speed, its sign, a constant and the effect."""
    zero, sign = np.zeros_like(velocity), np.sign(velocity)
    columns = [velocity, sign, np.ones_like(velocity)]
    if name:
        signals = Signals(zero, zero, velocity, sign, zero, zero, sign, 1.0, 1.0)
        effect = catalogue()[name]
        assert isinstance(effect, Columns)
        columns += [sum((values for values, _ in column), zero) for column in effect.columns(signals, shape)]
    return np.column_stack(columns)


def _best_fit(name: str, shape: tuple[float, ...], velocity: Array, effort: Array) -> FrictionCurve:
    table = _columns(name, shape, velocity)
    constant = bool(np.ptp(table[:, 3:], axis=0).all())
    if not constant:  # as the effect has one
        table[:, 2] = 0.0
    solved, _, rank, _ = np.linalg.lstsq(table, effort, rcond=1e-10)
    theta = np.asarray(solved, dtype=np.float64)
    squares = float(np.sum((effort - table @ theta) ** 2))
    base = Axis(1.0, float(theta[0]), float(theta[1]))
    if name and not catalogue()[name].physical(theta[3:].tolist(), shape, base):
        squares = float("inf")
    return FrictionCurve(name, shape, theta, squares, int(rank) + len(shape), constant)


def chance(plain: FrictionCurve, tried: FrictionCurve, points: int, rounding: float) -> float:
    """Probability of the F-test that an effect's columns and shape save nothing; squares below `rounding` are none."""
    added, left = tried.freedom - plain.freedom, points - tried.freedom
    if not np.isfinite(tried.squares) or added < 1:
        return 1.0
    ratio = (plain.squares - tried.squares) / added / (max(tried.squares, rounding) / left)
    return float(scipy.stats.f.sf(ratio, added, left))
