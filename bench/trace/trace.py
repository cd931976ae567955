"""A trace: one recording of one axis, in SI units, on one regular time base between holes.

Several recordings make one trace, one after the other with a hole between any two (`join`). What belongs to a recording
stays its own where the trace is read: time since its start (`Trace.joined`), and with it what warms up or drifts, and
the phase of mains interference. What belongs to the axis is shared: so is absolute position, as an encoder that keeps
its zero gives it. One that starts again in every recording shifts what is periodic in position, which then fits some
of them and not the others.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, KeysView, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, overload

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, all_finite
from bench.axis_kind import LINEAR, ROTARY, AxisKind
from bench.errors import InputError
from bench.names import counted
from bench.presented import Shown
from bench.trace.channel import Recording
from bench.trace.choose import ReadingOptions, SignalColumn, assumed_note, choose, reading_options
from bench.trace.in_si import SampledSignal, in_si
from bench.trace.signals import KNOWN_INERTIA, KNOWN_MOMENTUM, KNOWN_SLOPE, KNOWN_TORQUE
from bench.trace.time_base import HOLE, TimeBase, interpolate, regular
from bench.trace.wraps import Wraps

if TYPE_CHECKING:
    from bench.trace.from_arrays import Arrays

#: Largest magnitude of a signal - SI -, far beyond any axis: one within it may be wrong, one outside certainly is, by a
#: wrong unit or a damaged file, or its square overflows. Of time it is 30,000 years, of position a spindle's turns in a
#: year.
LARGEST = {
    "time": 1e12,
    "position": 1e12,
    "load_position": 1e12,
    "velocity": 1e8,
    "acceleration": 1e12,
    "current": 1e8,
    "torque": 1e10,
    "force": 1e12,
    "voltage": 1e8,
    "supply_voltage": 1e8,
    "temperature": 1e8,
    KNOWN_TORQUE: 1e12,
    KNOWN_MOMENTUM: 1e12,
    KNOWN_INERTIA: 1e12,
    KNOWN_SLOPE: 1e12,
}
#: A signal that never exceeds this has a square that underflows - SI.
SMALLEST = 1e-30
#: Key of a trace's metadata: which units were assumed, in words.
ASSUMED_UNITS = "assumed_units"
#: Sample periods that a recording can have - s.
SHORTEST, LONGEST = 1e-9, 1e6


@dataclass(frozen=True, repr=False)
class Trace(Shown):
    """One recording of one axis, synthetic or measured.

    Attributes:
        time: sample times, increasing, regular within each segment - s - (n,).
        signals: value of each signal by its name (see `bench.trace.signals`) - SI - (n,) each.
        units: SI unit of each signal.
        origin: file or simulation it came from.
        metadata: what the source stated about itself.
        time_base: what was found about the sample times, where a reader found something.
        notes: what a reader did, assumed or left out that the user should know.
        joined: time at which each recording starts - s - and its origin, where several make it (`join`).
        wraps: of the position, which were undone.
        continues: whether it follows the trace before it, of the same recording, without a hole.

    Raises:
        InputError: fewer than two samples, a signal of another length, a value that is not finite, or time that
            does not increase.
    """

    time: Array
    signals: Mapping[str, Array]
    units: Mapping[str, str]
    origin: str
    metadata: Mapping[str, str] = field(default_factory=dict)
    time_base: TimeBase | None = None
    notes: tuple[str, ...] = ()
    joined: tuple[tuple[float, str], ...] = ()
    continues: bool = False
    wraps: Wraps | None = None

    def __post_init__(self) -> None:
        for name in ("signals", "units", "metadata"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        if self.time.size < 2:
            raise InputError(self.origin, f"found {counted(self.time.size, 'sample')}", "allowed: at least two")
        for name, values in {"time": self.time, **self.signals}.items():
            where = f"{self.origin}: {name}"
            if values.shape != self.time.shape:
                raise InputError(where, f"found shape {values.shape}", f"allowed: {self.time.shape} as time has")
            if not all_finite(values):
                first = int(np.argmin(np.isfinite(values)))
                raise InputError(where, f"found {values[first]} at sample {first}", "allowed: finite numbers")
        if not (self.time[1:] > self.time[:-1]).all():
            first = int(np.argmax(np.diff(self.time) <= 0)) + 1
            found = f"does not increase at sample {first} ({self.time[first - 1]:g} s, then {self.time[first]:g} s)"
            raise InputError(f"{self.origin}: time", found, "allowed: increasing times")

    def __repr__(self) -> str:
        held = ", ".join(f"{name} [{unit}]" for name, unit in self.units.items())
        return f"Trace({self.origin!r}, {len(self)} samples, every {self.sample_period:.6g} s: {held})"

    def __reduce__(self) -> tuple[partial[Trace], tuple[()]]:
        """Pickled as it was given: other processes take traces, and a read-only view of a dict does not travel."""
        given = {one.name: getattr(self, one.name) for one in fields(self)}
        views = {name: dict(value) for name, value in given.items() if isinstance(value, MappingProxyType)}
        return partial(Trace, **{**given, **views}), ()

    @classmethod
    def from_arrays(
        cls,
        signals: Arrays,
        units: Mapping[str, str] | None = None,
        sample_period: float | str | None = None,
        columns: Mapping[str, str] | None = None,
        origin: str = "arrays",
    ) -> Trace:
        """Trace of samples in memory, on the same regular time base that a file's samples are brought to.

        Args:
            signals: name -> (n,) samples, or a data frame (pandas, polars, Arrow): `time`, and signals under the names
                of `bench.trace.signals`. A name may carry its unit, `velocity [deg/s]`. Samples are copied.
            units: unit of each column whose name carries none; `time` among them. Where no column has one, SI is
                assumed if physics agrees, with a note.
            sample_period: where there is no `time` - s, or a text with its unit such as `1 ms`.
            columns: signal -> column with unit, as in a rig's `[trace.columns]`, for foreign names.
            origin: what messages call it.

        Raises:
            InputError: as `assemble`; a unit for a column that is not there; neither time nor sample period, or both.
        """
        from bench.trace.from_arrays import options_of, recording_of  # pyarrow: 0.05 s

        recording = recording_of(signals, origin).stated(units)
        return assemble(recording, options_of(recording, sample_period, columns or {}))

    @overload
    def __getitem__(self, name: str) -> NDArray[np.float64]: ...
    @overload
    def __getitem__(self, name: slice) -> Trace: ...
    def __getitem__(self, name: str | slice) -> NDArray[np.float64] | Trace:
        """Values of a signal, or a part of all; InputError naming the signal that the trace does not hold."""
        if isinstance(name, slice):
            if not all(isinstance(end, int | np.integer | None) for end in (name.start, name.stop, name.step)):
                allowed = "allowed: whole numbers, of samples; for times: .between(start, stop)"
                raise InputError(self.origin, f"found [{name.start}:{name.stop}]", allowed)
            base = self.time_base and replace(self.time_base, sample_period=(name.step or 1) * self.sample_period)
            signals = {key: own[name] for key, own in self.signals.items()}
            return replace(self, time=self.time[name], signals=signals, time_base=base)
        if not isinstance(name, str):
            raise InputError(self.origin, f"found {name!r}", f"allowed: one of {', '.join(self.signals)}, or a slice")
        if name not in self.signals:
            raise InputError(self.origin, f"contains no {name}", f"found: {', '.join(self.signals) or 'no signal'}")
        return self.signals[name]

    def __contains__(self, name: str) -> bool:
        return name in self.signals

    def __len__(self) -> int:
        return self.time.size

    def __iter__(self) -> Iterator[str]:
        return iter(self.signals)

    def keys(self) -> KeysView[str]:
        """Names of the signals."""
        return self.signals.keys()

    @property
    def columns(self) -> list[str]:
        """The same as a list."""
        return [*self]

    @property
    def sample_rate(self) -> float:
        """Samples per second - Hz."""
        return 1.0 / self.sample_period

    @property
    def duration(self) -> float:
        """From the first sample to the last - s."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def sample_period(self) -> float:
        """Of the time base, else the median time step - s."""
        return self.time_base.sample_period if self.time_base else float(np.median(np.diff(self.time)))

    @cached_property
    def segments(self) -> tuple[slice, ...]:
        """Stretches without a hole, in order, as slices into `time` and every signal."""
        if self.time[-1] - self.time[0] < (len(self) - 1 + HOLE - 1.0) * self.sample_period:
            return (slice(0, len(self)),)  # a regular trace with a hole would last longer
        breaks = np.flatnonzero(np.diff(self.time) > HOLE * self.sample_period) + 1
        edges = [0, *breaks.tolist(), self.time.size]
        return tuple(slice(start, stop) for start, stop in pairwise(edges))

    def start_of(self, part: slice) -> float:
        """Time at which the recording starts that a stretch is of - s."""
        starts = [start for start, _ in self.joined if start <= self.time[part.start]]
        return starts[-1] if starts else float(self.time[0])

    @property
    def axis_kind(self) -> AxisKind:
        """Linear if position or velocity is in metres, else rotary."""
        lengths = (LINEAR.length_unit, LINEAR.speed_unit)
        return LINEAR if any(self.units.get(name) in lengths for name in ("position", "velocity")) else ROTARY

    def resample(self, rate: float) -> Trace:
        """The same at another number of samples per second - Hz -, on straight lines between its samples."""
        if not 0.0 < rate < math.inf:
            raise InputError("resample(rate)", f"found {rate:g} Hz", "allowed: above 0 Hz")
        time, signals = _sampled(self, [*self], 1.0 / rate)
        return replace(self, time=time, signals=signals, time_base=TimeBase(1.0 / rate, resampled=True))

    def without(self, name: str) -> Trace:
        """The same without one of its signals."""
        signals, units = dict(self.signals), dict(self.units)
        del signals[name], units[name]
        return replace(self, signals=signals, units=units)

    def with_signals(self, signals: Mapping[str, Array], units: Mapping[str, str]) -> Trace:
        """The same recording with signals added or replaced."""
        return replace(self, signals={**self.signals, **signals}, units={**self.units, **units})

    def between(self, start: float, stop: float) -> Trace:
        """The part with start <= time < stop - s."""
        first, last = np.searchsorted(self.time, [start, stop])
        return self[first:last]


def assemble(recording: Recording, given: Mapping[str, str] | ReadingOptions | None = None) -> Trace:
    """Trace of a recording: signals are chosen and named, brought to SI, and to one regular time base.

    Args:
        recording: as a reader returned it.
        given: signal (or `time`) -> column of the file with unit, e.g. `{"velocity": "-Axis1.ActVel [mm/s]"}`, where a
            leading `-` inverts the sign; or a rig's `[trace]`. Other signals are taken from columns with well-known
            names.

    Raises:
        InputError: a column missing, ambiguous, without unit or of the wrong dimension; no time; values that are not
            finite; times that run backwards or stand twice too often.
    """
    how = reading_options(given)
    chosen, assumed = choose(recording, how)
    notes = [*recording.notes, *assumed]
    return on_time_base(in_si(chosen, recording, how, notes), chosen, recording, notes)


def on_time_base(
    sampled: Mapping[str, SampledSignal], chosen: Mapping[str, SignalColumn], recording: Recording, notes: Sequence[str]
) -> Trace:
    """Trace of the signals `sampled` in the `chosen` columns of a recording; raises as `regular`."""
    base = regular(sampled)
    metadata = {**recording.metadata, "format": recording.format}
    dropped = unused(chosen, recording)
    if dropped:
        metadata["dropped_columns"] = ", ".join(dropped)
    for note in assumed_note(chosen, recording):
        metadata[ASSUMED_UNITS] = note
    return Trace(
        time=base.time,
        signals=base.signals,
        units={name: chosen[name].scale.unit for name in sampled},
        origin=recording.origin,
        metadata=metadata,
        time_base=base.time_base,
        notes=(*notes, *base.notes),
        wraps=sampled["position"].wraps if "position" in sampled else None,
    )


def unused(chosen: Mapping[str, SignalColumn], recording: Recording) -> list[str]:
    """Labels of the columns that are no signal of the trace."""
    used = {choice.channel for choice in chosen.values()}
    return [channel.label for channel in recording.channels if channel not in used]


def require_plausible(trace: Trace) -> None:
    """Raise InputError for the first value beyond what a servo axis can have, or for a signal that is nearly zero.

    A reference has the bounds of its signal.
    """
    for name, values in {"time": trace.time, **trace.signals}.items():
        unit, where = trace.units.get(name, "s"), f"{trace.origin}: {name}"
        largest = LARGEST[name.removesuffix("_reference")]
        top = max(float(values.max()), -float(values.min()))
        if top > largest:
            first = int(np.argmax(np.abs(values) > largest))
            found = f"found {values[first]:g} {unit} at {trace.time[first]:g} s, which no servo axis has"
            raise InputError(where, found, f"allowed: up to {largest:g} {unit}; is the unit right?")
        if 0.0 < top < SMALLEST:
            found = f"found nothing beyond {top:g} {unit}"
            raise InputError(where, found, f"allowed: a signal that exceeds {SMALLEST:g} {unit}; is the unit right?")
    period = trace.sample_period
    if not SHORTEST <= period <= LONGEST:
        allowed = f"allowed: {SHORTEST:g} s to {LONGEST:g} s; is the unit right?"
        raise InputError(f"{trace.origin}: time", f"found a sample every {period:g} s", allowed)


def with_known(
    trace: Trace,
    torque: Array,
    momentum: Array,
    unit: str,
    inertia: Array | None = None,
    slope: Array | None = None,
) -> Trace:
    """A recording with known torque on its axis in addition to its inertia and friction, e.g. of the rest of a robot.

        M_known = r + dp/dt

    In this form no acceleration is needed: the filter of the torque balance differentiates the momentum.

    Args:
        trace: the recording.
        torque: r, not due to acceleration - unit - (n,).
        momentum: p, whose rate is the torque due to acceleration - unit*s - (n,).
        unit: N*m (N).
        inertia: dp/d(omega), by which the noise of the speed is in the momentum - kg*m**2 (kg) - (n,); None for 0.
        slope: dr/dq, by which the torque differs on a load that is not where the motor is - unit/rad (unit/m) - (n,);
            None for 0.
    """
    kind, nothing = trace.axis_kind, np.zeros(len(trace))
    signals = {KNOWN_TORQUE: torque, KNOWN_MOMENTUM: momentum}
    signals[KNOWN_INERTIA] = nothing if inertia is None else inertia
    signals[KNOWN_SLOPE] = nothing if slope is None else slope
    units = {KNOWN_TORQUE: unit, KNOWN_MOMENTUM: f"{unit}*s", KNOWN_INERTIA: kind.inertia_unit}
    units[KNOWN_SLOPE] = f"{unit}/{kind.length_unit}"
    return trace.with_signals(signals, units)


def less_known(trace: Trace, effort: Array) -> Array:
    """An effort less the known torque, unfiltered - (n,)."""
    if KNOWN_TORQUE not in trace:
        return effort
    rate = np.zeros(len(trace))
    for part in trace.segments:
        if part.stop - part.start > 1:
            rate[part] = np.gradient(trace[KNOWN_MOMENTUM][part], trace.sample_period)
    return effort - trace[KNOWN_TORQUE] - rate


#: Sample periods between the end of a recording and the start of the next: a hole.
APART = 10.0
#: Share by which sample periods may differ and be one: derivatives are off by as much.
SAME = 1e-5


def join(traces: Sequence[Trace]) -> Trace:
    """One trace of several recordings, of the signals that all of them hold, at the longest of their sample periods.

    Raises:
        InputError: no recording, one that is given twice, or signals in different units.
    """
    if not traces:
        raise InputError("recordings", "found none", "allowed: at least one")
    if len(traces) == 1:
        return traces[0]
    _require_alike(traces)
    first, period = traces[0], max(trace.sample_period for trace in traces)
    names = [name for name in first.signals if all(name in trace for trace in traces)]
    left_out = sorted({name for trace in traces for name in trace.signals} - set(names))
    sampled = [_sampled(trace, names, period) for trace in traces]
    times, starts, begin = [], [], float(first.time[0])
    for time, _ in sampled:
        starts.append(begin)
        times.append(begin + (time - time[0]))
        begin = float(times[-1][-1]) + APART * period
    return Trace(
        time=np.concatenate(times),
        signals={name: np.concatenate([signals[name] for _, signals in sampled]) for name in names},
        units={name: first.units[name] for name in names},
        origin=" and ".join(trace.origin for trace in traces),
        metadata=first.metadata,
        time_base=TimeBase(period, resampled=any(_apart(trace, period) for trace in traces)),
        notes=(
            *(f"{trace.origin}: {note}" for trace in traces for note in trace.notes),
            *(f"{trace.origin} taken every {period:g} s, as others are" for trace in traces if _apart(trace, period)),
            *([f"{', '.join(left_out)}: omitted, not every recording contains it"] if left_out else []),
        ),
        joined=tuple(zip(starts, (trace.origin for trace in traces), strict=True)),
    )


def _require_alike(traces: Sequence[Trace]) -> None:
    for index, other in enumerate(traces):
        for one in traces[:index]:
            for name in set(one.signals) & set(other.signals):
                if one.units[name] != other.units[name]:
                    found = f"found {other.units[name]}, in {one.origin} {one.units[name]}"
                    raise InputError(f"{other.origin}: {name}", found, "allowed: one unit in all recordings")
            alike = set(one.signals) == set(other.signals)
            if alike and all(np.array_equal(one[name], other[name]) for name in one.signals):
                found = f"found the same recording as {one.origin}"
                raise InputError(other.origin, found, "allowed: each recording once; twice would count as two")


def _apart(trace: Trace, period: float) -> bool:
    return abs(trace.sample_period / period - 1.0) > SAME


def _sampled(trace: Trace, names: Sequence[str], period: float) -> tuple[Array, dict[str, Array]]:
    """Times and signals of a recording at a sample period, stretch by stretch; as they are where it has that period."""
    if not _apart(trace, period):
        return trace.time, {name: trace[name] for name in names}
    placed = []
    for part in trace.segments:
        start, stop = trace.time[part][[0, -1]]
        placed.append((part, start + period * np.arange(int((stop - start) / period * (1.0 + 1e-12)) + 1)))
    signals = {
        name: np.concatenate([interpolate(at, trace.time[part], trace[name][part]) for part, at in placed])
        for name in names
    }
    return np.concatenate([at for _, at in placed]), signals
