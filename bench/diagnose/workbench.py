"""A recording laid out for the search: raw signals, and any column of the torque balance through the one filter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from bench.diagnose.memory import Memory
from bench.effects.effect import Column, Signals
from bench.errors import UndeterminedError
from bench.rig.rig import Rig
from bench.trace.conditioning import Conditioning, condition, known_sign, raw_speed
from bench.trace.filter import GaussianFilter, fast_length
from bench.trace.trace import Trace

Array = NDArray[np.float64]

#: Widest filter of a diagnosis - s: shapes of friction live in the milliseconds around a reversal.
WIDEST = 2e-3
#: A row needs one sign over this many filter widths to each side, so that a lag of some widths moves no reversal in.
SIGN_WIDTHS = 6.0


@dataclass(frozen=True)
class Stretch:
    """Raw signals of one stretch without holes, and which of its filtered rows have a known direction (r,)."""

    signals: Signals
    used: NDArray[np.bool_]


@dataclass(frozen=True)
class Workbench:
    """One recording, filtered.

    Attributes:
        stretches: raw signals, stretch by stretch.
        conditioning: source, noises and filter.
        origin: of the recording.
        latched: within what time torque and speed were taken: one tick of a drive, else one sample - s.
        linear: whether the axis moves in metres.
        drift: standard deviation of a position that was integrated from noisy speed, 0 of a recorded one - rad (m).
        memory: columns made before.
        still: whether the motion behind a dead zone is kept while the angle's correction moves a little.
    """

    stretches: tuple[Stretch, ...]
    conditioning: Conditioning
    origin: str
    latched: float
    linear: bool
    drift: float
    memory: Memory = field(default_factory=Memory, compare=False)
    still: bool = False

    @classmethod
    def of(cls, trace: Trace, rig: Rig, width: float | None = None, every: bool = False) -> Workbench:
        """Lay out a recording.

        Args:
            trace: the recording.
            rig: of the axis.
            width: of the filter instead of the one chosen from the recording - s.
            every: whether a row stands for every sample, which a replay wants.

        Raises:
            InputError, UndeterminedError: as identification does.
        """
        effort, _ = rig.net_effort(trace)
        found = condition(trace, effort)
        width = width or min(WIDEST, found.filter.width)
        smooth = GaussianFilter.from_cutoff(GaussianFilter(width, trace.sample_period).cutoff, trace.sample_period)
        smooth = replace(smooth, stride=1) if every else smooth
        conditioning = replace(found, filter=smooth)
        constant, peak = rig.motor.torque_per_ampere, rig.motor.peak_current
        largest = float(np.abs(effort).max())
        peak_effort = float(constant.torque(np.asarray(peak))) if constant and peak else largest
        parts = [part for part in trace.segments if part.stop - part.start > 4 * smooth.margin]
        stretches = tuple(_stretch(trace, effort, part, conditioning, peak_effort) for part in parts)
        if not any(part.used.any() for part in stretches):
            reason = f"no filtered sample of {trace.origin} moves clearly in one direction"
            raise UndeterminedError("the torque balance", reason, clear_motion(conditioning, trace.linear))
        latched = rig.drive.control_period if rig.drive is not None else trace.sample_period
        drift = 0.0 if "position" in trace else _drift(conditioning.source_noise, trace)
        return cls(stretches, conditioning, trace.origin, latched, trace.linear, drift)

    def with_signals(self, change: Callable[[Signals], Signals]) -> Workbench:
        """The same rows over changed raw signals (a corrected angle, another friction level)."""
        stretches = tuple(replace(part, signals=change(part.signals)) for part in self.stretches)
        return replace(self, stretches=stretches, memory=Memory())

    def moved(self, signals: Signals) -> tuple[float, ...]:
        """What tells one motion of a stretch from another, as far as a dead zone is to follow it."""
        return () if self.still else (float(signals.position[-1]), float(signals.velocity[-1]))

    @property
    def held(self) -> Workbench:
        """This recording with the motion behind its dead zones as it is first asked for."""
        return replace(self, still=True, memory=Memory())

    @cached_property
    def duration(self) -> float:
        """Of the recording - s."""
        return float(self.stretches[-1].signals.time[-1] - self.stretches[0].signals.time[0])

    @cached_property
    def effort(self) -> Array:
        """Filtered motor torque at the used rows - N*m (N) - (m,)."""
        return self.rows(lambda s: [(s.effort, 0)])

    def samples(self, trace: Trace) -> NDArray[np.int64]:
        """Index into the recording of every used row (m,)."""
        smooth, found = self.conditioning.filter, []
        parts = [part for part in trace.segments if part.stop - part.start > 4 * smooth.margin]
        for part, stretch in zip(parts, self.stretches, strict=True):
            rows = part.start + smooth.margin + smooth.stride * np.arange(stretch.used.size)
            found.append(rows[stretch.used])
        return np.concatenate(found)

    def row_values(self, pick: Callable[[Signals], Array]) -> Array:
        """Raw values at the used rows (m,)."""
        smooth = self.conditioning.filter
        picked = [
            pick(part.signals)[smooth.margin : -smooth.margin : smooth.stride][: part.used.size]
            for part in self.stretches
        ]
        return np.concatenate([values[part.used] for values, part in zip(picked, self.stretches, strict=True)])

    def rows(self, column: Callable[[Signals], Column], lag: float = 0.0) -> Array:
        """One filtered column at the used rows (m,)."""
        return self.table(lambda s: [column(s)], lag)[:, 0]

    def table(self, columns: Callable[[Signals], Sequence[Column]], lag: float = 0.0) -> Array:
        """Filtered columns at the used rows (m, k).

        Args:
            columns: of the raw signals.
            lag: time constant of a first-order lag to undo, 1 + j*omega*lag - s.
        """
        parts = []
        for part in self.stretches:
            made = columns(part.signals)
            parts.append(_filtered(made, self.conditioning.filter, lag)[part.used])
        return np.concatenate(parts)


def clear_motion(conditioning: Conditioning, linear: bool) -> str:
    """What a row of the torque balance needs: one direction over the filter's reach, at a speed above the noise."""
    speed, reach = conditioning.sign_threshold, 2.0 * SIGN_WIDTHS * conditioning.filter.width
    return (
        f"runs that keep one direction well over {reach:.2g} s, "
        f"at speeds well above {speed:.3g} {'m/s' if linear else 'rad/s'}, where noise no longer makes the sign"
    )


def _drift(speed_noise: float, trace: Trace) -> float:
    """Standard deviation of the mean of integrated white noise, sigma*sqrt(T_s*T/3) - rad (m)."""
    return speed_noise * float(np.sqrt(trace.sample_period * (trace.time[-1] - trace.time[0]) / 3.0))


def _stretch(trace: Trace, effort: Array, part: slice, conditioning: Conditioning, peak_effort: float) -> Stretch:
    period, source = trace.sample_period, trace[conditioning.source][part]
    speed = raw_speed(source, conditioning.source, period)
    velocity = speed if conditioning.source == "position" or "velocity" not in trace else trace["velocity"][part]
    travelled = np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2.0) * period])
    position = trace["position"][part] if "position" in trace else travelled
    sign = known_sign(speed, conditioning.sign_threshold)
    smooth = conditioning.filter
    wide = replace(smooth, width=smooth.width * SIGN_WIDTHS / 3.1)
    (direction,) = wide(sign, 0)
    used = np.zeros(len(range(smooth.margin, position.size - smooth.margin, smooth.stride)), dtype=bool)
    lost = (wide.margin - smooth.margin) // smooth.stride
    used[lost : lost + direction.size] = np.abs(direction) > 1.0 - 1e-3
    signals = Signals(
        time=trace.time[part] - trace.time[0],
        position=position,
        velocity=velocity,
        sign=sign,
        effort=effort[part],
        torque=effort[part],
        friction=sign,
        peak_effort=peak_effort,
        sample_period=period,
    )
    return Stretch(signals, used)


def _filtered(columns: Sequence[Column], smooth: GaussianFilter, lag: float) -> Array:
    """Filter a stretch's columns, (r, k): each term to its derivative, the lag undone."""
    count = columns[0][0][0].size
    size = smooth.stride * fast_length(-(-count // smooth.stride))
    values = np.stack([term[0] for column in columns for term in column])
    orders = np.array([term[1] for column in columns for term in column])
    ends = np.cumsum([len(column) for column in columns])
    kept = size // smooth.stride // 2 + 1
    omega = np.asarray(2.0 * np.pi / (size * smooth.sample_period) * np.arange(kept), dtype=np.float64)
    spectra = np.asarray(scipy.fft.rfft(values, size))[:, :kept]
    spectra = spectra * (1j * omega) ** orders[:, None]
    summed = np.add.reduceat(spectra, np.concatenate([[0], ends[:-1]]), axis=0)
    factor = np.exp(-0.5 * (omega * smooth.width) ** 2) / smooth.stride * (1.0 + 1j * omega * lag)
    rows = np.asarray(scipy.fft.irfft(summed * factor, size // smooth.stride), dtype=np.float64)
    first, last = smooth.margin // smooth.stride, -(-(count - smooth.margin) // smooth.stride)
    return rows[:, first:last].T
