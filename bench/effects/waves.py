"""Waves: effects that repeat with position, so many times a revolution, or per length of a linear axis.

    A*sin(n*q + phi) = s*sin(n*q) + c*cos(n*q)

A - amplitude; n - harmonic, the wave number of a pitch - rad/m - on a linear axis; phi - phase - rad in (-pi, pi];
s, c - strengths; q - position - rad (m).
"""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, namespace
from bench.effects.effect import Effect
from bench.effects.shape import Shape, Shapes
from bench.effects.signals import Axis, AxisState, Number, Scope, Signals, Values
from bench.effects.torque import Torque
from bench.trace.filter import Column
from bench.units import Quantity

PHASE = Quantity("phase", "phi", "rad", angle=True, preset=0.0)
#: Share of the Nyquist frequency up to which samples follow a wave.
FOLLOWED = 0.8


class Wave(Effect):
    """It repeats with position: its quantities are an amplitude, a harmonic if that is searched, and the phase."""

    @property
    def once_per_revolution(self) -> bool:
        """Whether it is a wave of one revolution, of which a linear axis has none."""
        return not any(slot.whole for slot in self.shapes)

    def sought(self, scope: Scope) -> bool:
        """Where something turns, if it is a wave of a revolution."""
        return super().sought(scope) and (scope.kind.turns or not self.once_per_revolution)

    def wave_number(self, shape: Sequence[float]) -> float:
        """Wave number over position - 1 (rad/m)."""
        return 1.0 if self.once_per_revolution else shape[0]

    def unit(self, base: Axis) -> float:
        """Strength of amplitude one."""
        return 1.0

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        """Amplitude, harmonic and phase."""
        amplitude, phase = amplitude_and_phase(*strengths)
        harmonic = super().report((), shape, base)
        return {self.quantities[0].name: amplitude / self.unit(base), **harmonic, PHASE.name: phase}

    def wave(self, values: Values, position: Number) -> Number:
        """The wave at a position, in the unit of its amplitude."""
        angle = phase_angle(values, position)
        return values[self.quantities[0].name] * namespace(angle).sin(angle)


class HarmonicTorque(Wave, Torque):
    """A torque in proportion to a wave whose harmonic is searched."""

    repeatable = True

    @abstractmethod
    def carrier(self, at: AxisState) -> Number:
        """Resisting torque where the wave is one - N*m (N) per unit of its amplitude."""

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """The wave of the torque."""
        return self.carrier(at) * self.wave(values, at.position)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Sine and cosine, nothing where the wave is faster than the samples can follow."""
        return self.columns_of(signals, [shape])

    def columns_of(self, signals: Signals, shapes: Shapes) -> list[Column]:
        """Of waves of several harmonics, one after the other."""
        carrier, columns = self.carrier(signals.state), list[Column]()
        for number, waves in turned(signals.position, [shape[0] for shape in shapes]):
            carried = carrier * followed(signals, number)
            columns += [[(carried * wave, 0)] for wave in waves]
        return columns


def harmonics(first: int, last: int) -> Shape:
    """The harmonic of a wave, sought from the first to the last."""
    quantity = Quantity("harmonic", "n", "dimensionless", lower=float(first), linear_unit="rad/m")
    return Shape(quantity, tuple(float(n) for n in range(first, last + 1)), whole=True)


def amplitude_and_phase(sine: float, cosine: float) -> tuple[float, float]:
    """A, phi of A*sin(x + phi) = sine*sin(x) + cosine*cos(x); phi - rad in (-pi, pi]."""
    return float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))


def turned(position: Array, numbers: Sequence[float]) -> Iterator[tuple[float, tuple[Array, Array]]]:
    """Each wave number with sin(n*q) and cos(n*q) (n,); a row at equal distances turns on, a twentieth of the time."""
    first, last, few = numbers[0], numbers[-1], len(numbers)
    even = few > 2 and bool(np.abs(np.linspace(first, last, few) - numbers).max() <= 1e-12 * abs(last))
    if not even:
        yield from ((number, (np.sin(number * position), np.cos(number * position))) for number in numbers)
        return
    wave: NDArray[np.complex128] = np.exp(1j * first * position)
    turn: NDArray[np.complex128] = np.exp(1j * (last - first) / (few - 1) * position)
    for number in numbers:
        yield number, (wave.imag, wave.real)
        wave = wave * turn


def followed(signals: Signals, number: float) -> Array:
    """1 where the samples follow a wave of a number - rad/rad (rad/m) -, 0 where a cycle takes less than two - (n,).

    A cosine between: a wave that breaks off has slow parts, which pass the filter that stops the wave (F. J. Harris,
    Proceedings of the IEEE 66, 1978, 51-83).
    """
    of_nyquist = (number * signals.sample_period / np.pi) * np.abs(signals.velocity)
    if of_nyquist.max(initial=0.0) <= FOLLOWED:  # the same, of which the cosine takes ten times as long
        return np.ones_like(of_nyquist)
    return 0.5 + 0.5 * np.cos(np.pi * np.clip((of_nyquist - FOLLOWED) / (1.0 - FOLLOWED), 0.0, 1.0))


def phase_angle(values: Values, position: Number) -> Number:
    """n*q + phi - rad -; one cycle a revolution where no harmonic is given."""
    return values.get("harmonic", 1.0) * position + values[PHASE.name]
