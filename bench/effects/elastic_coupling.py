"""Elastic coupling: motor and load are joined by a spring and damper (a belt, a bellows, a slender shaft).

    M_c = k*(q_m - q_l) + d*(omega_m - omega_l),  J_m*alpha_m = M - friction - M_c,  J_l*alpha_l = M_c

k - stiffness - N*m/rad (N/m); d - damping - N*m*s/rad (N*s/m); J_m, J_l - inertia on the motor's and on the load's
side - kg*m**2 (kg). Sensor and friction sit at the motor. Resonance at sqrt(k*(1/J_m + 1/J_l)), antiresonance of the
motor at w_a = sqrt(k/J_l). In the balance the load's acceleration less the motor's is a column of strength J_l. The
load is driven along the recorded motion,

    p'' + 2*D*w_a*p' + w_a**2*p = -alpha_m - M_l/J_l - sum(c_k*D_k(q_l, omega_l, t)),  p = q_l - q_m

D - damping ratio; M_l - known torque of the other links, if the load is a link of a robot -; D_k - torque of what acts
on the load (drag, a spring, an unbalance) per unit of its strength -, c_k its strength over load inertia. It starts
with the motor, at rest against it; a link of a robot bent as by the torque of its first oscillation, without ringing.
In time, not in frequency: there the ringing that a recording ends with returns at its start.
Source: D. Schröder, Elektrische Antriebe - Regelung von Antriebssystemen (two-mass system).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, recursive_filter
from bench.effects.effect import Coupling, Load
from bench.effects.mjcf import Spec, add_coupling_joint
from bench.effects.shape import FREQUENCY, Shape, Shapes
from bench.effects.signals import Axis, Signals
from bench.trace.filter import Column
from bench.units import Quantity

#: Antiresonances - rad/s - and damping ratios that a search tries first.
ANTIRESONANCES = tuple(2.0 * np.pi * float(f) for f in np.geomspace(8.0, 110.0, 28))
DAMPINGS = (0.01, 0.04, 0.12)
#: Damping ratio from which a coupling is no other than a lag, and the one with which no search may end.
OVERDAMPED, DULL = 1.0, 0.5
#: Turns in which known torque follows the load, and in which its motion and what acts on it are brought in line; the
#: change that ends them, and the one that no load makes - shares of the twist under the load's own inertia.
BENDS, TURNS, SETTLED, ASTRAY = 3, 40, 1e-6, 10.0


class ElasticCoupling(Coupling):
    name = "elastic_coupling"
    summary = "motor and load are joined by a spring and damper"
    filters_motion = True
    quantities = (
        Quantity("stiffness", "k", "N*m/rad", lower=0.0, null=np.inf),
        Quantity("damping", "d", "N*m*s/rad", lower=0.0, preset=0.0),
    )
    derived = (Quantity("resonance_frequency", "f", "Hz", lower=0.0),)
    shapes = (
        Shape(Quantity("antiresonance", "w_a", "rad/s", lower=0.0), ANTIRESONANCES, reach=0.35, measure=FREQUENCY),
        Shape(Quantity("damping_ratio", "D", "dimensionless", lower=0.0), DAMPINGS, reach=0.35),
    )

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return self.columns_of(signals, [shape])

    def columns_of(self, signals: Signals, shapes: Shapes, loads: Sequence[Load] = ()) -> list[Column]:
        """Load's acceleration less the motor's, with what acts on the load.

        The own column of that in the balance is one of an effect on the motor, so only the difference enters here.
        """
        return [_column(signals, antiresonance, damping, loads) for antiresonance, damping in shapes]

    def noise_of_motion(self, shape: Sequence[float], omega: Array) -> NDArray[np.complex128]:
        """Load's acceleration over the motor's, less one: (1 + 2*D*s/w_a)/(1 + 2*D*s/w_a + (s/w_a)**2) - 1."""
        s = 1j * omega / shape[0]
        return -(s**2) / (1.0 + 2.0 * shape[1] * s + s**2)

    def resonances(self, shape: Sequence[float]) -> list[tuple[float, float]]:
        """Its poles' frequency w_a*sqrt(1 - D**2) and decay D*w_a."""
        antiresonance, ratio = shape
        return [(antiresonance * float(np.sqrt(max(1.0 - ratio**2, 0.0))), ratio * antiresonance)]

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> bool:
        """It rings, and part of the inertia sits behind it."""
        return shape[1] < OVERDAMPED and super().physical(strengths, shape, base)

    def credible(self, shape: Sequence[float]) -> bool:
        """It rings well enough to be distinguished from a lag."""
        return shape[1] < DULL

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        """Stiffness J_l*w_a**2, damping 2*D*k/w_a, and the frequency at which both sides resonate."""
        antiresonance, ratio = shape
        load, motor = strengths[0], base.inertia - strengths[0]
        stiffness = load * antiresonance**2
        resonance = np.sqrt(max(stiffness * (1.0 / max(motor, 1e-12) + 1.0 / load), 0.0)) / (2.0 * np.pi)
        loss = 2.0 * ratio * stiffness / antiresonance
        return {"stiffness": stiffness, "damping": loss, "resonance_frequency": float(resonance)}

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        joint = add_coupling_joint(spec, name)
        joint.stiffness[0], joint.damping[0] = values["stiffness"], values["damping"]


def _column(signals: Signals, antiresonance: float, damping: float, loads: Sequence[Load]) -> Column:
    """Terms of one coupling.

    What acts on the load is brought in line with its motion turn by turn. Half of its steepest damping is counted to
    the coupling's, so that a turn reduces the error. Links that are heavier than `link_inertia` swing slower.
    """
    heavier = float(np.mean(signals.heavier))
    pulled = signals.pull(heavier)
    antiresonance, damping = antiresonance / heavier**0.5, damping / heavier**0.5
    loss, spring, step = 2.0 * damping * antiresonance, antiresonance**2, signals.sample_period
    damped = 0.5 * _steepest(signals, loads) / heavier if loads else 0.0
    state = np.array([[0.0, 1.0], [-spring, -loss - damped]])
    began = signals.course[0, 0]
    course = np.vstack([signals.course[0] - began, signals.course[1:]])
    driven, denominator = _driven(state, np.array([-1.0, loss]), step, course)
    twist = free = recursive_filter([1.0], denominator, driven[0])
    grown: list[tuple[Array, int]] = []
    drift = 0.0
    if pulled is not None:
        (pull, slope), (level, rate) = pulled, _first_pull(signals, pulled[0], antiresonance)
        line, drift = level + rate * step * np.arange(free.size), -rate / spring
        bent, twist = drift * loss / -spring - line / spring, np.zeros_like(free)
        forced = np.zeros_like(driven)
        for _ in range(BENDS):
            pulling = pull + slope * twist - line
            forced, _ = _driven(state, np.array([0.0, -1.0]), step, np.stack([pulling[:-1], np.diff(pulling)]))
            twist = recursive_filter([1.0], denominator, driven[0] + forced[0]) + bent
        driven, free, grown = driven + forced, twist, [(heavier * slope * twist, 0)]
    if not loads:
        return [*signals.reaction(free), *grown]
    load_speed = free_speed = recursive_filter([1.0], denominator, driven[1]) + drift
    torque = np.zeros_like(free)
    for _ in range(TURNS):
        torque = _torque(replace(signals, position=signals.position + twist, velocity=load_speed + began), loads)
        pulling = torque / heavier - damped * load_speed
        forcing, _ = _driven(state, np.array([0.0, -1.0]), step, np.stack([pulling[:-1], np.diff(pulling)]))
        forced = [recursive_filter([1.0], denominator, row) for row in forcing]
        before, twist, load_speed = twist, free + forced[0], free_speed + forced[1]
        change = np.abs(twist - before).max()
        if change < SETTLED * np.abs(free).max():
            break
        if change > ASTRAY * np.abs(free).max():
            return [*signals.reaction(free), *grown]
    return [*signals.reaction(twist), (torque - _torque(signals, loads), 0), *grown]


def _first_pull(signals: Signals, pull: Array, antiresonance: float) -> tuple[float, float]:
    """Deceleration of links at the start by inertia and known torque - rad/s**2 (m/s**2) -, and its rate.

    By parabola and line through the speed and the known torque of the first oscillation.
    """
    count = max(4, min(round(2.0 * np.pi / (antiresonance * signals.sample_period)), signals.time.size - 1))
    time = signals.sample_period * np.arange(count)
    curvature, rise, _ = np.polyfit(time, signals.course[0, :count], 2)
    slope, level = np.polyfit(time, pull[:count], 1)
    return float(level + rise), float(slope + 2.0 * curvature)


def _steepest(signals: Signals, loads: Sequence[Load]) -> float:
    """Largest rise of what acts on the load with its speed, over its inertia - 1/s."""
    step = 1e-3 * float(np.abs(signals.velocity).max()) + 1e-12
    faster = replace(signals, velocity=signals.velocity + step)
    return max(float(np.max(_torque(faster, loads) - _torque(signals, loads))) / step, 0.0)


def _driven(state: Array, drive: Array, step: float, course: Array) -> tuple[Array, Array]:
    """What drives both states of x' = A*x + b*u from rest (2, n), and the denominator (3,) of the filter it passes.

    Exact over a step: x+ = F*x + sum(g_m*c_m), where u = sum(c_m*(t/h)**m) (k, n - 1), with F = exp(m*h)*(cosh(s*h) +
    sinh(s*h)/s*(A - m)) of a matrix A (2, 2), m half its trace, s = sqrt(m**2 - det(A)), and g_m = A^-1*(m/h*g_(m-1) -
    b), g_0 = A^-1*(F - 1)*b.
    """
    one, inverse, mean = np.eye(2), np.linalg.inv(state), 0.5 * np.trace(state)
    turn = step * np.sqrt(complex(mean**2 - np.linalg.det(state)))
    slow, fast = np.exp(mean * step + turn), np.exp(mean * step - turn)  # of much damping cosh alone overflows
    sheared = np.exp(mean * step) * np.sinc(1j * turn / np.pi) if abs(turn) < 1.0 else 0.5 * (slow - fast) / turn
    moved = 0.5 * (slow + fast).real * one + sheared.real * step * (state - mean * one)
    gains = [inverse @ (moved - one) @ drive]
    for power in range(1, len(course)):
        gains.append(inverse @ (power / step * gains[-1] - drive))
    added = np.stack(gains, axis=1) @ course
    driven = np.zeros((2, course.shape[1] + 1))
    driven[:, 1:] = added
    driven[:, 2:] += (moved - np.trace(moved) * one) @ added[:, :-1]
    return driven, np.array([1.0, -np.trace(moved), np.linalg.det(moved)])


def _torque(signals: Signals, loads: Sequence[Load]) -> Array:
    """What acts on a load that moves so, over its inertia - rad/s**2 (m/s**2) - (n,)."""
    total = np.zeros_like(signals.position)
    for effect, shape, rates in loads:
        for ((values, _),), rate in zip(effect.columns(signals, shape), rates, strict=True):
            total = total + rate * values
    return total


EFFECT = ElasticCoupling()
