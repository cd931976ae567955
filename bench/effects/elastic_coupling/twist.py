"""Motion of a load behind a soft coupling, driven along the recorded motion of the motor.

    p'' + 2*d*w_a*p' + w_a**2*p = -alpha_m - sum(c_k*D_k(q_l, omega_l, t)),  p = q_l - q_m

w_a - antiresonance sqrt(k/J_l) - rad/s -, d - damping ratio; D_k - torque of what acts on the load (drag, a spring, an
unbalance) per unit of its strength -, c_k its strength over load inertia. The load starts with the motor, at rest
against it. In time, not in frequency: there the ringing that a recording ends with returns at its start.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from bench.arrays import Array, recursive_filter
from bench.effects.effect import Load
from bench.effects.signals import Signals
from bench.trace.filter import Column

#: Longest step - rad of the antiresonance: speed that runs straight within it lacks step**2/12 of its swing.
LONGEST_STEP = 0.1
#: Steps of a sample at least and at most: a coupling that rings as fast as samples come is not told from a rigid one.
LEAST, MOST = 2, 8
#: Turns in which the load's motion and what acts on it are brought in line, the change that ends them and the one that
#: no load beyond belief would make - shares of the twist under the load's own inertia.
TURNS, SETTLED, ASTRAY = 40, 1e-6, 10.0


def twist_columns(signals: Signals, shapes: Sequence[Sequence[float]], loads: Sequence[Load]) -> list[Column]:
    """Load's acceleration less the motor's behind several couplings, with what acts on the load - rad/s**2 (m/s**2).

    Args:
        signals: of one stretch.
        shapes: antiresonance - rad/s - and damping ratio of each.
        loads: what acts on the load; its own column in the balance is that of an effect on the motor, so only the
            difference of the two enters here.
    """
    from scipy.interpolate import CubicSpline  # 0.15 s, which only a coupling has to pay

    values = signals.position if signals.source == "position" else signals.velocity
    spline = CubicSpline(np.arange(values.size), values)
    fine: dict[int, Array] = {}
    columns: list[Column] = []
    for antiresonance, damping in shapes:
        substeps = int(np.ceil(antiresonance * signals.sample_period / LONGEST_STEP))
        substeps = min(max(substeps, LEAST), MOST)
        if substeps not in fine:
            at = np.arange((values.size - 1) * substeps + 1) / substeps
            fine[substeps] = spline(at, 1) / signals.sample_period if signals.source == "position" else spline(at)
        columns.append(_column(signals, fine[substeps], substeps, antiresonance, damping, loads))
    return columns


def _column(
    signals: Signals, speed: Array, substeps: int, antiresonance: float, damping: float, loads: Sequence[Load]
) -> Column:
    """Terms of one coupling, driven by the motor's speed at substeps of the samples.

    What acts on the load is brought in line with its motion turn by turn. Half of its steepest damping is counted to
    the coupling's, so that a turn leaves less of an error than it found.
    """
    loss, spring, step = 2.0 * damping * antiresonance, antiresonance**2, signals.sample_period
    damped = 0.5 * _steepest(signals, loads) if loads else 0.0
    state = np.array([[0.0, 1.0], [-spring, -loss - damped]])
    driven = speed - speed[0]
    free, free_speed = _Driven.of(state, np.array([-1.0, loss]), step / substeps)(driven, substeps)
    forcing = _Driven.of(state, np.array([0.0, -1.0]), step)
    twist, load_speed, torque = free, free_speed, np.zeros_like(free)
    for _ in range(TURNS if loads else 0):
        load = replace(signals, position=signals.position + twist, velocity=load_speed + speed[0])
        torque = _torque(load, loads)
        forced, forced_speed = forcing(torque - damped * load_speed, 1)
        before, twist, load_speed = twist, free + forced, free_speed + forced_speed
        change = np.abs(twist - before).max()
        if change < SETTLED * np.abs(free).max():
            break
        if change > ASTRAY * np.abs(free).max():
            return [(free, 2)]
    return [(twist, 2), (torque - _torque(signals, loads), 0)] if loads else [(twist, 2)]


def _steepest(signals: Signals, loads: Sequence[Load]) -> float:
    """Largest rise of what acts on the load with its speed, over its inertia - 1/s."""
    step = 1e-3 * float(np.abs(signals.velocity).max()) + 1e-12
    faster = replace(signals, velocity=signals.velocity + step)
    return max(float(np.max(_torque(faster, loads) - _torque(signals, loads))) / step, 0.0)


@dataclass(frozen=True)
class _Driven:
    """Both states of x' = A*x + b*u, driven from rest by a u that runs straight between steps, as recursive filters."""

    numerators: Array
    denominator: Array

    @classmethod
    def of(cls, state: Array, drive: Array, step: float) -> _Driven:
        """Exact over a step: x+ = F*x + (P - Q)*u + Q*u+."""
        moved, inverse = scipy.linalg.expm(state * step), np.linalg.inv(state)
        grown = inverse @ (moved - np.eye(2))
        whole = grown @ drive
        later = inverse @ (grown / step - np.eye(2)) @ drive
        adjugate = np.array([[-moved[1, 1], moved[0, 1]], [moved[1, 0], -moved[0, 0]]])
        first = whole - later
        numerators = np.stack([later, adjugate @ later + first, adjugate @ first], axis=1)
        return cls(numerators, np.array([1.0, -np.trace(moved), np.linalg.det(moved)]))

    def __call__(self, values: Array, every: int) -> tuple[Array, Array]:
        """Both states at every so many of the values."""
        moved = [recursive_filter(row, self.denominator, values)[::every] for row in self.numerators]
        return moved[0], moved[1]


def _torque(signals: Signals, loads: Sequence[Load]) -> Array:
    """What acts on a load that moves so, over its inertia - rad/s**2 (m/s**2) - (n,)."""
    total = np.zeros_like(signals.position)
    for effect, shape, rates in loads:
        for ((values, _),), rate in zip(effect.columns(signals, shape), rates, strict=True):
            total = total + rate * values
    return total
