"""A trace: one recording of one axis, in SI units, on one regular time base between holes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.axis_kind import LINEAR, ROTARY, AxisKind
from bench.errors import InputError

if TYPE_CHECKING:
    from bench.trace.from_arrays import Arrays
    from bench.trace.wraps import Wraps

#: A step this many sample periods long is a hole, not jitter: no signal of a servo is known inside it.
HOLE = 1.5


def all_finite(values: Array) -> bool:
    """Whether no value is infinite or nan; costs no temporary array where none is."""
    with np.errstate(over="ignore", invalid="ignore"):
        # a sum is finite only if every term is; that of large finite ones may overflow, hence the second look
        return bool(np.isfinite(values.sum()) or np.isfinite(values).all())


@dataclass(frozen=True)
class TimeBase:
    """Sample times as found by a reader, before they were brought to a regular base.

    Attributes:
        sample_period: median step - s.
        jitter: largest deviation of a step (holes aside) from the sample period - share of the period.
        holes: (start, duration) of each stretch without samples - s.
        duplicates: samples dropped because their time stood already in the recording.
        interpolated: samples placed between measured ones, inside steps too short to be a hole.
        resampled: whether signals were interpolated onto the regular base.
    """

    sample_period: float
    jitter: float = 0.0
    holes: tuple[tuple[float, float], ...] = ()
    duplicates: int = 0
    interpolated: int = 0
    resampled: bool = False


@dataclass(frozen=True)
class Trace:
    """One recording of one axis, synthetic or measured.

    Attributes:
        time: sample times, increasing, regular within each segment - s - (n,).
        signals: value of each signal by its name (see `bench.trace.signals`) - SI - (n,) each.
        units: SI unit of each signal.
        origin: file or simulation it came from.
        metadata: what the source said about itself.
        time_base: what was found about the sample times, where a reader found something.
        notes: what a reader did, assumed or left out that the user should know.
        joined: time at which each recording starts - s - and its origin, where several make it (`bench.trace.join`).
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
            raise InputError(self.origin, f"found {self.time.size} samples", "allowed: at least two")
        for name, values in {"time": self.time, **self.signals}.items():
            if values.shape != self.time.shape:
                raise InputError(
                    f"{self.origin}: {name}", f"found shape {values.shape}", f"allowed: {self.time.shape} as time has"
                )
            if not all_finite(values):
                first = int(np.argmin(np.isfinite(values)))
                raise InputError(
                    f"{self.origin}: {name}", f"found {values[first]} at sample {first}", "allowed: finite numbers"
                )
        if not (self.time[1:] > self.time[:-1]).all():
            first = int(np.argmax(np.diff(self.time) <= 0)) + 1
            raise InputError(
                f"{self.origin}: time",
                f"does not increase at sample {first} ({self.time[first - 1]:g} s, then {self.time[first]:g} s)",
                "allowed: increasing times",
            )

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
            units: unit of each column whose name carries none; `time` among them.
            sample_period: where there is no `time` - s, or a text with its unit such as `1 ms`.
            columns: signal -> column with unit, as in a rig's `[trace.columns]`, for foreign names.
            origin: what messages call it.

        Raises:
            InputError: as `bench.trace.assemble.assemble`; a unit for a column that is not there; neither time nor
                sample period, or both.
        """
        from bench.trace.from_arrays import trace_of  # which imports this module

        return trace_of(signals, units or {}, sample_period, columns or {}, origin)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Values of a signal; InputError naming it when the trace does not hold it."""
        if name not in self.signals:
            raise InputError(self.origin, f"holds no {name}", f"found: {', '.join(self.signals) or 'no signal'}")
        return self.signals[name]

    def __contains__(self, name: str) -> bool:
        return name in self.signals

    def __len__(self) -> int:
        return self.time.size

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
        return replace(
            self, time=self.time[first:last], signals={name: v[first:last] for name, v in self.signals.items()}
        )
