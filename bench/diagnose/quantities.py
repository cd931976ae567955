"""An effect's reported quantities from a fit, with intervals that count correlated residuals.

Every free number of the fit, strengths and continuous shapes alike, is one column of the Jacobian of the modelled
torque; covariance by long-run scores as in identification; quantities by the delta method.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.axis_kind import AxisKind
from bench.diagnose.backlash import SCALE
from bench.diagnose.candidates import EVENT
from bench.diagnose.columns import build
from bench.diagnose.contact_spread import contact_spread
from bench.diagnose.fit import Fit, least_squares
from bench.diagnose.hypothesis import BACKLASH, CURRENT_LAG, ECCENTRICITY, ELASTIC, VELOCITY_LAG, Named
from bench.diagnose.shapes import free_shapes
from bench.diagnose.workbench import Workbench
from bench.effects.catalogue import catalogue, physics
from bench.effects.effect import Base, Signals, amplitude_and_phase
from bench.identify.covariance import long_run_covariance
from bench.identify.estimate import Parameter

Array = NDArray[np.float64]

#: Effect and index of each free shape.
Slots = tuple[tuple[int, int], ...]

#: Step of a numerical derivative, relative, and 95 % of a normal distribution.
STEP, REACH = 1e-4, 1.96
#: The same of a dead zone's gap, frequency and damping: impacts move in jumps, a smaller step would see only one.
DEAD_ZONE_STEPS = (3e-3, 3e-2, 3e-2)
#: Rows per block of the scores.
BLOCK = 16


@dataclass(frozen=True)
class Uncertain:
    """The free numbers of a fit - strengths, then continuous shapes - and their covariance."""

    values: Array
    covariance: Array
    shapes: Slots


def uncertain(bench: Workbench, fitted: Fit) -> Uncertain:
    """Free numbers of a fit with their covariance; rows beside a dead zone count as in its search."""
    slots = tuple(
        (index, k) for index, effect in enumerate(fitted.hypothesis.effects) for k in _uncertain_shapes(effect, bench)
    )
    jacobian = _jacobian(bench, fitted, slots)
    scale = np.sqrt(np.mean(jacobian**2, axis=0))
    scale = np.where(scale > 0.0, scale, 1.0)
    jacobian = jacobian / scale
    left, weight = bench.effort - fitted.columns @ fitted.theta, np.ones(jacobian.shape[0])
    if not fitted.told.all():
        weight = 1.0 / (1.0 + (left / (SCALE * fitted.floor)) ** 2)
    inverse = np.linalg.pinv((jacobian.T * weight) @ jacobian, rcond=1e-12)
    scores = jacobian * (weight * left)[:, None]
    edges = np.arange(0, scores.shape[0], BLOCK)
    middle, _ = long_run_covariance(np.add.reduceat(scores, edges, axis=0))
    covariance = inverse @ middle @ inverse / np.outer(scale, scale)
    shapes = np.array([fitted.hypothesis.effects[index].shape[k] for index, k in slots])
    for place, (index, k) in enumerate(slots, fitted.theta.size):
        covariance[place, place] += _untold(bench, fitted.hypothesis.effects[index], k) ** 2
    for moved in (*_misplaced(bench, fitted), *_louder(bench, fitted, slots)):
        covariance[: moved.size, : moved.size] += np.outer(moved, moved)
    loose = [place for place, (k, _) in enumerate(slots, fitted.theta.size) if _is_loose(fitted, k)]
    if loose:
        covariance[np.ix_(loose, loose)] += contact_spread(bench, fitted)
    return Uncertain(np.concatenate([fitted.theta, shapes]), covariance, slots)


def _jacobian(bench: Workbench, fitted: Fit, slots: Slots) -> Array:
    """Derivative of the modelled torque by strengths and shapes (m, p + s)."""
    columns = [fitted.columns]
    for index, k in slots:
        shape = fitted.hypothesis.effects[index].shape
        backlash = fitted.hypothesis.effects[index].name == BACKLASH
        step = (DEAD_ZONE_STEPS[k] if backlash else STEP) * max(abs(shape[k]), 1e-3)
        moved = tuple(value + step * (j == k) for j, value in enumerate(shape))
        other, _ = build(bench, fitted.hypothesis.reshaped(index, moved))
        columns.append((((other - fitted.columns) @ fitted.theta) / step)[:, None])
    return np.concatenate(columns, axis=1)


def _is_loose(fitted: Fit, index: int) -> bool:
    return fitted.hypothesis.effects[index].name == BACKLASH


def _uncertain_shapes(effect: Named, bench: Workbench) -> list[int]:
    return list(range(len(DEAD_ZONE_STEPS))) if effect.name == BACKLASH else free_shapes(effect, bench)


def _untold(bench: Workbench, effect: Named, k: int) -> float:
    """Standard deviation of a shape that no noise shows: of instants between rows or ticks, of an angle's origin."""
    if effect.name == ECCENTRICITY:
        speed = float(np.sqrt(np.mean(bench.row_values(lambda s: s.velocity) ** 2)))
        return float(np.hypot(effect.shape[0], effect.shape[1])) * (bench.drift + 0.5 * bench.latched * speed / REACH)
    if effect.name == EVENT:
        time = bench.row_values(lambda s: s.time)
        after = min(max(int(np.searchsorted(time, effect.shape[k])), 1), time.size - 1)
        return float(time[after] - time[after - 1]) / REACH
    return bench.latched / REACH if effect.name in (CURRENT_LAG, VELOCITY_LAG) else 0.0


def _misplaced(bench: Workbench, fitted: Fit) -> list[Array]:
    """Standard changes of the strengths (p,) were what effects see half a tick older, or a drift further on.

    A drive latches its signals within one tick: the alignment of torque is fitted, that of a wave of position is not.
    """
    if not fitted.hypothesis.effects or not fitted.told.all():
        return []
    plain = least_squares(fitted.columns, bench.effort)

    def refitted(change: Callable[[Signals], Signals]) -> Array:
        columns, owners = build(bench.with_signals(change), fitted.hypothesis)
        return least_squares(np.where(owners >= 0, columns, fitted.columns), bench.effort) - plain

    def older(s: Signals) -> Signals:
        moved = (
            values + 0.5 * bench.latched * np.gradient(values, s.sample_period) for values in (s.position, s.velocity)
        )
        return replace(s, **dict(zip(("position", "velocity"), moved, strict=True)))

    found = [refitted(older) / REACH]
    return [*found, refitted(lambda s: replace(s, position=s.position + bench.drift))] if bench.drift else found


def _louder(bench: Workbench, fitted: Fit, slots: Slots) -> list[Array]:
    """Change of strengths and shapes of a soft coupling were noise twice as strong, by one step of Gauss and Newton.

    The coupling's column is made of the noisy motion, so noise biases it; that of the noise itself is as large.
    J. R. Cook, L. A. Stefanski, Journal of the American Statistical Association 89, 1994, 1314-1328.
    """
    if ELASTIC not in fitted.hypothesis.names or not fitted.told.all():
        return []
    rng, conditioning = np.random.default_rng(0), bench.conditioning

    def louder(s: Signals) -> Signals:
        noise = conditioning.source_noise * rng.standard_normal(s.time.size)
        effort = s.effort + conditioning.effort_noise * rng.standard_normal(s.time.size)
        s = replace(s, effort=effort, torque=effort)
        if conditioning.source == "velocity":
            return replace(s, velocity=s.velocity + noise)
        return replace(s, position=s.position + noise, velocity=s.velocity + np.gradient(noise, s.sample_period))

    loud = bench.with_signals(louder)
    columns, _ = build(loud, fitted.hypothesis)
    jacobian = _jacobian(loud, replace(fitted, columns=columns), slots)
    return [least_squares(jacobian, loud.effort - columns @ fitted.theta)]


def base_parameters(fitted: Fit, numbers: Uncertain, units: Mapping[str, str]) -> dict[str, Parameter]:
    """J, K_w and K_0 with their intervals; `units` by their names, in this order."""
    deviation = np.sqrt(np.maximum(np.diag(numbers.covariance), 0.0))
    return {
        name: _parameter(float(fitted.theta[k]), float(deviation[k]), unit)
        for k, (name, unit) in enumerate(units.items())
    }


def effect_parameters(
    fitted: Fit, numbers: Uncertain, index: int, kind: AxisKind, effort_unit: str
) -> dict[str, Parameter]:
    """Quantities of one effect with their intervals.

    Args:
        fitted: the fit.
        numbers: its free numbers.
        index: of the effect.
        kind: of the axis.
        effort_unit: N*m, N, or what the rig allows.
    """
    effect = fitted.hypothesis.effects[index]

    def values(point: Array) -> Mapping[str, float]:
        theta = point[: fitted.theta.size]
        shape = list(effect.shape)
        for slot, (owner, k) in enumerate(numbers.shapes):
            if owner == index:
                shape[k] = float(point[fitted.theta.size + slot])
        base = Base(float(theta[0]), float(theta[1]), float(theta[2]))
        return reported(Named(effect.name, tuple(shape)), theta[fitted.owners == index], base)

    centre = values(numbers.values)
    deviations = _deviations(values, numbers)
    return {
        name: _parameter(value, deviations[name], unit_of_quantity(effect.name, name, kind, effort_unit))
        for name, value in centre.items()
    }


def _deviations(values: Callable[[Array], Mapping[str, float]], numbers: Uncertain) -> dict[str, float]:
    gradient: dict[str, list[float]] = {name: [] for name in values(numbers.values)}
    for k, number in enumerate(numbers.values):
        step = STEP * max(abs(float(number)), 1e-9)
        up, down = numbers.values.copy(), numbers.values.copy()
        up[k] += step
        down[k] -= step
        high, low = values(up), values(down)
        for name, slopes in gradient.items():
            slopes.append((high[name] - low[name]) / (2.0 * step))
    found = {name: np.array(slopes) for name, slopes in gradient.items()}
    return {name: float(np.sqrt(max(g @ numbers.covariance @ g, 0.0))) for name, g in found.items()}


def reported(effect: Named, strengths: Array, base: Base) -> Mapping[str, float]:
    """Quantities of an effect from its strengths and shape - SI."""
    if effect.name in (CURRENT_LAG, VELOCITY_LAG):
        return {"time_constant": effect.shape[0]}
    if effect.name == ECCENTRICITY:
        amplitude, phase = amplitude_and_phase(*effect.shape)
        return {"amplitude": amplitude, "phase": phase}
    if effect.name == ELASTIC:
        antiresonance, damping = effect.shape
        load, motor = float(strengths[0]), base.inertia - float(strengths[0])
        stiffness = load * antiresonance**2
        resonance = np.sqrt(max(stiffness * (1.0 / max(motor, 1e-12) + 1.0 / load), 0.0)) / (2.0 * np.pi)
        loss = 2.0 * damping * stiffness / antiresonance
        return {"stiffness": stiffness, "damping": loss, "resonance_frequency": float(resonance)}
    if effect.name == BACKLASH:
        gap, contact, damping, _ = effect.shape
        stiffness = float(strengths[0]) * contact**2
        return {"gap": gap, "contact_stiffness": stiffness, "contact_damping": 2.0 * damping * stiffness / contact}
    return catalogue()[effect.name].values(strengths.tolist(), effect.shape, base)


def unit_of_quantity(effect: str, quantity: str, kind: AxisKind, effort_unit: str) -> str:
    """Unit of a reported quantity."""
    if quantity == "resonance_frequency":
        return "Hz"
    known = {q.name: q for q in physics()[effect].quantities} if effect in physics() else {}
    return kind.unit(known[quantity], effort_unit) if quantity in known else "dimensionless"


def _parameter(value: float, deviation: float, unit: str) -> Parameter:
    return Parameter(
        float(value), unit, deviation, (float(value - REACH * deviation), float(value + REACH * deviation))
    )
