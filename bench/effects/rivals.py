"""Physics that no catalogue lists: it competes with the names of a search and never gets one.

So what none of the effects is does not get the name of the nearest one.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, recursive_filter
from bench.effects.effect import Columns, Effect, Stage
from bench.effects.shape import DURATION, FREQUENCY, SPEED, TRAVEL, Shape, Shapes
from bench.effects.signals import Scope, Signals
from bench.trace.filter import Column
from bench.units import Quantity

#: What the torque of a wave may depend on, with the derivative that gives it from the signal.
FACTORS: Mapping[str, tuple[Callable[[Signals], Array], int]] = {
    "nothing": (lambda s: np.ones_like(s.position), 0),
    "speed squared": (lambda s: s.velocity**2, 0),
    "direction": (lambda s: s.sign, 0),
    "torque": (lambda s: s.torque, 0),
    "acceleration": (lambda s: s.velocity, 1),
}


class Vibration(Columns):
    """A torque periodic in time, M = A*sin(2*pi*f*t + phi)."""

    name = "outside_vibration"
    summary = "a torque periodic in time"
    decoy = True
    memoryless = True
    quantities = (Quantity("frequency", "f", "1/s", lower=0.0),)
    shapes = (Shape(quantities[0], tuple(float(f) for f in np.geomspace(0.4, 120.0, 240)), measure=FREQUENCY),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return self.columns_of(signals, [shape])

    def columns_of(self, signals: Signals, shapes: Shapes) -> list[Column]:
        """Of several frequencies, of few exponentials each: those of blocks of samples times those within one."""
        step, first = signals.sample_period, float(np.min(signals.time))
        passed = np.rint((signals.time - first) / step).astype(np.intp)
        size = math.isqrt(int(passed.max())) + 1
        block, within = np.divmod(passed, size)
        columns, ahead = list[Column](), step * np.arange(size)
        for rate in (2.0 * np.pi * shape[0] for shape in shapes):
            blocks = np.exp(1j * rate * (first + size * ahead))
            wave: NDArray[np.complex128] = blocks.take(block) * np.exp(1j * rate * ahead).take(within)
            columns += [[(wave.imag, 0)], [(wave.real, 0)]]
        return columns


class Notch(Columns):
    """A bump of torque or friction at one angle of the revolution, of Gaussian shape.

    However wide: one wider than a turn is what speaks for a constant torque that the catalogue does not have.
    """

    name = "outside_notch"
    summary = "a bump at one angle"
    decoy = True
    memoryless = True
    quantities = (Quantity("angle", "q_0", "rad"), Quantity("width", "w", "rad", lower=0.0))
    shapes = (
        Shape(quantities[0], tuple(float(q) for q in np.arange(36) * np.pi / 18.0), additive=True),
        Shape(quantities[1], (0.08, 0.2, 0.45)),
    )

    def sought(self, scope: Scope) -> bool:
        return scope.kind.turns

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """The bump, and the bump of friction."""
        return self.columns_of(signals, [shape])

    def columns_of(self, signals: Signals, shapes: Shapes) -> list[Column]:
        """Of several bumps; those at one angle one after the other."""
        columns: list[Column] = []
        for angle, alike in groupby(shapes, key=lambda shape: shape[0]):
            away = (signals.position - angle + np.pi) % (2.0 * np.pi) - np.pi
            bumps = [np.exp(-0.5 * (away / width) ** 2) for _, width in alike]
            columns += [column for bump in bumps for column in ([(bump, 0)], [(bump * signals.sign, 0)])]
        return columns


class Smooth(Columns):
    """A torque that runs smoothly over the travel, as parts of waves do: a cable, a spring that is not Hooke's."""

    name = "outside_smooth"
    summary = "a torque that runs smoothly over the travel"
    decoy = True
    memoryless = True
    quantities = (Quantity("wave_number", "k", "dimensionless", lower=0.0, linear_unit="rad/m"),)
    shapes = (Shape(quantities[0], (0.5 * np.pi,), reach=0.0, measure=TRAVEL),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """One, and sines and cosines of a quarter and half a cycle."""
        angle = shape[0] * signals.position
        waves = (wave(times * angle) for times in (1.0, 2.0) for wave in (np.sin, np.cos))
        return [[(values, 0)] for values in (np.ones_like(angle), *waves)]


class SlowMemory(Columns):
    """Friction that grows with how fast the axis has run: level A*m, T*dm/dt = |omega| - m."""

    name = "outside_slow_memory"
    summary = "friction that grows with recent speed"
    decoy = True
    quantities = (Quantity("time_constant", "T", "s", lower=0.0),)
    shapes = (Shape(quantities[0], (0.05, 0.12, 0.3, 0.7, 1.5, 3.0), measure=DURATION),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Direction times low-passed magnitude of speed."""
        return [[(signals.sign * _recent_speed(signals, shape[0]), 0)]]


class FrictionalMemory(Columns):
    """Friction that follows a change of speed late: A*exp(-m/omega_s)*sgn(omega), T*dm/dt = |omega| - m.

    Source: D. P. Hess, A. Soom, Journal of Tribology 112(1), 1990, 147-152.
    """

    name = "outside_frictional_memory"
    summary = "friction that follows a change of speed late"
    decoy = True
    quantities = (Quantity("time_constant", "T", "s", lower=0.0), Quantity("speed", "omega_s", "rad/s", lower=0.0))
    shapes = (
        Shape(quantities[0], (0.03, 0.1, 0.3, 1.0), measure=DURATION),
        Shape(quantities[1], (1.0, 3.0, 10.0, 30.0), measure=SPEED),
    )

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return [[(signals.sign * np.exp(-_recent_speed(signals, shape[0]) / shape[1]), 0)]]


class VaryingGain(Columns):
    """A torque per ampere that changes with current or speed, M*(1 + c*M**2 + d*omega**2), in either direction."""

    name = "outside_gain"
    summary = "a torque per ampere that changes with current or speed"
    decoy = True
    memoryless = True
    stage = Stage.COMMUTATION
    copies_torque = True
    quantities = ()

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """The torque, times the squares of itself and of speed as shares of a peak."""
        fastest = np.max(np.abs(signals.velocity), initial=1e-300)
        squares = (signals.torque / signals.peak_effort) ** 2, (signals.velocity / fastest) ** 2
        return [[(signals.torque * square, 0)] for square in squares]


class OtherWave(Columns):
    """A wave of position of one number, times what a torque may depend on: one of FACTORS, or all of them.

    Where a wave sits right and is not what it is called, or is called by several names, this takes its place.
    """

    name = "outside_wave"
    summary = "a wave of position of another form"
    decoy = True
    memoryless = True
    stage = Stage.COMMUTATION
    copies_torque = True
    quantities = (Quantity("harmonic", "n", "dimensionless", lower=0.0, linear_unit="rad/m"),)
    shapes = (Shape(quantities[0], (1.0,), whole=True),)

    def __init__(self, factors: Sequence[str]) -> None:
        self._factors = [FACTORS[name] for name in factors]

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        angle = shape[0] * signals.position
        waves = np.sin(angle), np.cos(angle)
        return [[(factor(signals) * wave, order)] for factor, order in self._factors for wave in waves]


def _recent_speed(signals: Signals, time_constant: float) -> Array:
    """Low-passed magnitude of the speed (n,) - rad/s (m/s)."""
    keep = np.exp(-signals.sample_period / time_constant)
    return recursive_filter([1.0 - keep], [1.0, -keep], np.abs(signals.velocity))


#: Where a residual as small as noise depends on torque or speed, and where more than noise remains.
GAINS: tuple[Effect, ...] = (VaryingGain(),)
RIVALS: tuple[Effect, ...] = (Vibration(), Notch(), Smooth(), SlowMemory(), FrictionalMemory())
#: Waves of another form: of any first, then of one each.
WAVES = (OtherWave(tuple(FACTORS)), *(OtherWave((name,)) for name in FACTORS))
