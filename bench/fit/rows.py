"""A recording laid out in rows: raw signals, and any column of the torque balance through the one filter."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from operator import attrgetter
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.axis_kind import AxisKind
from bench.effects.effect import Columns, ColumnsOf
from bench.effects.shape import Shapes
from bench.effects.signals import Scope, Signals
from bench.errors import UndeterminedError
from bench.rig.rig import Rig
from bench.trace.filter import Column, GaussianFilter
from bench.trace.motion import (
    SIGN_REACH,
    Conditioning,
    condition,
    integrated,
    known_along,
    known_column,
    known_sign,
    raw_speed,
)
from bench.trace.signals import KNOWN_INERTIA, KNOWN_SLOPE
from bench.trace.trace import Trace

#: Widest filter - s: shapes of friction live in the milliseconds around a reversal.
WIDEST = 2e-3
#: A row needs one sign over this many filter widths to each side, so that a lag of some widths moves no reversal in.
SIGN_WIDTHS = 6.0
#: Lag of the torque that rows near reversals allow: this long or so many samples, at least a filter width.
LATE, LATE_SAMPLES = 5.8e-3, 2.0
#: Share of the motion in the weaker direction below which friction and a constant torque are one number.
ONE_WAY = 0.02


#: Bytes of columns kept: with 160 MB 600 s take 2.0 times as long as 300 s, with 96 MB 2.8 times.
KEPT = 160 * 2**20
#: Signals of which a stretch has a value for each sample; a load may be one number for all.
SAMPLES = ("time", "position", "velocity", "sign", "effort", "torque", "friction", "load", "began", "of_motion")
#: A lag of all columns, or of each - s.
Lag = float | tuple[float, ...]
Made = TypeVar("Made", Array, Sequence[Sequence[Column]])


class Memory:
    """Columns that were made last, up to KEPT bytes: fits of one search differ in one effect and share all others."""

    def __init__(self) -> None:
        self._kept: OrderedDict[Hashable, tuple[Any, int]] = OrderedDict()
        self._bytes = 0

    def get(self, made_of: Hashable, make: Callable[[], Made]) -> Made:
        """Columns, filtered or raw, by what they are made from - a function and values -; not to be written to."""
        if made_of in self._kept:
            self._kept.move_to_end(made_of)
            return self._kept[made_of][0]
        made = make()
        if isinstance(made, np.ndarray):
            made.flags.writeable, size = False, made.nbytes
        else:
            size = sum(values.nbytes for table in made for column in table for values, _ in column)
        self._kept[made_of] = made, size
        self._bytes += size
        while self._bytes > KEPT and len(self._kept) > 1:
            self._bytes -= self._kept.popitem(last=False)[1][1]
        return made


@dataclass(frozen=True)
class Stretch:
    """Raw signals of one stretch without holes, and which of its filtered rows have a known direction (r,).

    Attributes:
        signals: of it.
        used: (r,).
        start: of its first sample in the recording.
    """

    signals: Signals
    used: NDArray[np.bool_]
    start: int

    @classmethod
    def of(cls, signals: Signals, start: int, smooth: GaussianFilter, near: bool) -> Stretch:
        """The stretch through a filter: a row is used where the direction is known over `sign_reach` to each side."""
        wide = replace(smooth, width=sign_reach(smooth, near) / SIGN_REACH)
        size = signals.time.size
        used = np.zeros(len(range(smooth.margin, size - smooth.margin, smooth.stride)), dtype=bool)
        if size > 2 * wide.margin:
            (direction,) = wide.columns([[(signals.sign, 0)]])
            lost = (wide.margin - smooth.margin) // smooth.stride
            used[lost : lost + direction.size] = np.abs(direction) > 1.0 - 1e-3
        return cls(signals, used, start)

    @cached_property
    def places(self) -> NDArray[np.intp]:
        """Of the used ones among its rows."""
        return np.flatnonzero(self.used)


@dataclass(frozen=True)
class Rows:
    """One recording, filtered.

    Attributes:
        stretches: raw signals, stretch by stretch.
        conditioning: source, noises and filter.
        origin: of the recording.
        scope: what it is able to show.
        made_by, motion: what distinguishes its signals, and only its motion, from those reported; () as reported.
        memory: columns made before.
        near: whether rows as near to reversals as the filter allows are used, as effects there need.
        still: whether what follows the motion behind a coupling is kept while the motion is corrected a little.
    """

    stretches: tuple[Stretch, ...]
    conditioning: Conditioning
    origin: str
    scope: Scope
    made_by: Hashable = ()
    motion: Hashable = ()
    memory: Memory = field(default_factory=Memory, compare=False)
    near: bool = False
    still: bool = False

    @classmethod
    def of(
        cls,
        trace: Trace,
        rig: Rig,
        *,
        conditioning: Conditioning | None = None,
        cutoff: float | None = None,
        width: float | None = None,
        every: bool = False,
        begins: float | None = None,
        peak_effort: float | None = None,
        near: bool = False,
    ) -> Rows:
        """Lay out a recording, or a part of one.

        Args:
            conditioning: instead of the one read from the recording: that of its first part.
            cutoff: half-power frequency of the filter instead of the one chosen from the recording - Hz.
            width: of the filter instead of the one chosen from the recording - s.
            every: whether there is a row for every sample, which a replay wants.
            begins: the recording, if this is a later part of it - s.
            peak_effort: where the rig has none, that of the recording in which a model was found - N*m (N).

        Raises:
            InputError: a signal is missing, or rig and recording do not fit together.
            UndeterminedError: the recording is too short, or never moves clearly.
        """
        effort, driven = rig.own_effort(trace)[0], rig.driven(trace)
        if conditioning is None:
            found = condition(trace, effort, cutoff)
            width = width or (found.filter.width if cutoff else min(WIDEST, found.filter.width))
            smooth = GaussianFilter.from_cutoff(GaussianFilter(width, trace.sample_period).cutoff, trace.sample_period)
            conditioning = replace(found, filter=replace(smooth, stride=1) if every else smooth)
        constant, peak = rig.motor.torque_per_ampere, rig.motor.peak_current
        largest = float(np.abs(effort).max())
        peak_effort = float(constant.torque(np.asarray(peak))) if constant and peak else peak_effort or largest
        begins = float(trace.time[0]) if begins is None else begins
        parts = [
            (_signals(trace, rig, effort, driven, part, conditioning, peak_effort, begins), part.start)
            for part in trace.segments
            if part.stop - part.start > 4 * conditioning.filter.margin
        ]
        return cls._through(conditioning, parts, trace.origin, _scope(trace, rig, conditioning, peak_effort), near)

    def through(self, smooth: GaussianFilter, near: bool = False) -> Rows:
        """The same through a filter that is no narrower; UndeterminedError where nothing moves clearly so long."""
        parts = [(part.signals, part.start) for part in self.stretches if part.signals.time.size > 4 * smooth.margin]
        return self._through(replace(self.conditioning, filter=smooth), parts, self.origin, self.scope, near)

    @classmethod
    def _through(
        cls, conditioning: Conditioning, parts: Iterable[tuple[Signals, int]], origin: str, scope: Scope, near: bool
    ) -> Rows:
        """Stretches of raw signals, each with the place of its first sample, through a filter."""
        stretches = tuple(Stretch.of(signals, start, conditioning.filter, near) for signals, start in parts)
        if not any(part.used.any() for part in stretches):
            reason = f"no filtered sample of {origin} moves clearly in one direction"
            raise UndeterminedError("the torque balance", reason, clear_motion(conditioning, scope.kind))
        rows = cls(stretches, conditioning, origin, scope, near=near)
        return replace(rows, scope=rows._shown())

    def _shown(self) -> Scope:
        """What the stretches that the filter keeps are able to show."""
        signals = [part.signals for part in self.stretches]
        ends = {s.began: float(s.time[-1]) for s in signals}
        starts = {s.began: float(s.time[0]) for s in reversed(signals)}
        return replace(
            self.scope,
            width=self.conditioning.filter.width,
            one_way=bool(0.5 * (1.0 - abs(float(np.mean(self.values(lambda s: s.sign))))) < ONE_WAY),
            duration=max(ends[begun] - starts[begun] for begun in starts),
            travel=max(float(s.position.max()) for s in signals) - min(float(s.position.min()) for s in signals),
            top_speed=max(float(np.abs(s.velocity).max()) for s in signals),
            rms_speed=rms(self.values(lambda s: s.velocity)),
        )

    @property
    def correlation(self) -> float:
        """Variance of a sum of filtered noise over that of independent rows: 2*sqrt(pi)*width over their distance."""
        smooth = self.conditioning.filter
        return max(1.0, 2.0 * np.sqrt(np.pi) * smooth.width / (smooth.stride * smooth.sample_period))

    @property
    def independent(self) -> float:
        """How many independent samples the rows are."""
        return self._places.size / self.correlation

    def with_signals(self, change: Callable[[Signals], Signals], made_by: Hashable = None) -> Rows:
        """The same rows over changed signals; columns of them are kept if `made_by` distinguishes this change."""
        stretches = tuple(replace(p, signals=change(p.signals)) for p in self.stretches)
        pairs = [(new.signals, old.signals) for new, old in zip(stretches, self.stretches, strict=True)]
        moved = any(new.position is not old.position or new.velocity is not old.velocity for new, old in pairs)
        made_by, memory = (object(), Memory()) if made_by is None else (made_by, self.memory)
        motion = made_by if moved and not self.still else self.motion
        return replace(self, stretches=stretches, made_by=made_by, motion=motion, memory=memory)

    def selected(self, kept: Callable[[Array], NDArray[np.bool_]]) -> Rows:
        """Those of the rows that are kept, by their times (r,) - s."""
        smooth, stretches = self.conditioning.filter, list[Stretch]()
        for part in self.stretches:
            time = (part.signals.time + part.signals.began)[smooth.margin : -smooth.margin : smooth.stride]
            stretches.append(replace(part, used=part.used & kept(time[: part.used.size])))
        return replace(self, stretches=tuple(stretches), memory=Memory())

    @property
    def held(self) -> Rows:
        """This recording with the motion behind its couplings as it is first asked for."""
        return replace(self, still=True, memory=Memory())

    @cached_property
    def time(self) -> Array:
        """Of the used rows, since the start of the recording, or of the first of several - s - (m,)."""
        return self.values(lambda s: s.time + s.began)

    @cached_property
    def effort(self) -> Array:
        """Filtered motor torque at the used rows, less what is known to act - N*m (N) - (m,)."""
        effort = self.kept(effort_of)[:, 0]
        return effort - self.kept(known_of)[:, 0] if self.stretches[0].signals.known else effort

    @cached_property
    def known_inertia(self) -> float:
        """By which the known effort has the noise of the acceleration, on average over the rows - kg*m**2 (kg)."""
        return float(np.mean(self.values(lambda s: np.broadcast_to(s.known_inertia, s.time.shape))))

    @property
    def starts(self) -> tuple[float, ...]:
        """Of the recordings that were joined, since the start of the first - s."""
        return tuple(dict.fromkeys(part.signals.began for part in self.stretches))

    def samples(self) -> NDArray[np.int64]:
        """Index into the recording of every used row (m,)."""
        smooth = self.conditioning.filter
        return np.concatenate([part.start + smooth.margin + smooth.stride * part.places for part in self.stretches])

    def values(self, pick: Callable[[Signals], Array]) -> Array:
        """Raw values at the used rows (m,)."""
        smooth = self.conditioning.filter
        found = [pick(part.signals)[smooth.margin + smooth.stride * part.places] for part in self.stretches]
        return found[0] if len(found) == 1 else np.concatenate(found)

    def table(self, columns: ColumnsOf, lag: Lag = 0.0) -> Array:
        """Filtered columns at the used rows (m, k).

        Args:
            columns: of the raw signals of a stretch, or of each stretch, or of all as they are `joined`.
            lag: time constant of a first-order lag to undo, 1 + j*omega*lag, of all columns or of each - s.
        """
        tables = [columns(part.signals) for part in self.stretches] if callable(columns) else columns
        whole = tables[0] if len(tables) == 1 else self._end_to_end(tables)
        return self.conditioning.filter.columns(whole, lag, self._places).T

    def columns_of(self, effect: Columns, shapes: Shapes) -> list[Column]:
        """Columns of shapes of an effect, one after the other, of all stretches as they are `joined`."""
        if effect.memoryless or len(self.stretches) == 1:
            return effect.columns_of(self.joined, shapes)
        return self._end_to_end([effect.columns_of(part.signals, shapes) for part in self.stretches])

    @cached_property
    def _begins(self) -> NDArray[np.intp]:
        """Of each stretch where all stand one behind the other, and their end (s + 1,): multiples of the stride."""
        stride = self.conditioning.filter.stride
        return np.cumsum([0, *(-(-part.signals.time.size // stride) * stride for part in self.stretches)])

    @cached_property
    def _places(self) -> NDArray[np.intp]:
        """Of the used rows among those of all stretches one behind the other (m,)."""
        firsts = self._begins // self.conditioning.filter.stride
        return np.concatenate([first + part.places for first, part in zip(firsts, self.stretches, strict=False)])

    def _end_to_end(self, tables: Sequence[Sequence[Column]]) -> list[Column]:
        """Columns of all stretches one behind the other, to be filtered at once; no used row reaches over a joint."""
        whole = []
        for column in zip(*tables, strict=True):
            joined: dict[int, Array] = {}
            for begin, terms in zip(self._begins, column, strict=False):
                for values, order in terms:
                    whole_term = joined.setdefault(order, np.zeros(self._begins[-1]))
                    whole_term[begin : begin + values.size] += values
            whole.append([(values, order) for order, values in joined.items()])
        return whole

    def laid(self, pick: Callable[[Signals], Array | float]) -> Array:
        """Values of the samples of all stretches, laid as columns are that are filtered at once; zeros between (n,)."""
        if len(self.stretches) == 1:
            return np.asarray(pick(self.stretches[0].signals))
        laid = np.zeros(self._begins[-1])
        for begin, part in zip(self._begins, self.stretches, strict=False):
            laid[begin : begin + part.signals.time.size] = pick(part.signals)
        return laid

    @cached_property
    def joined(self) -> Signals:
        """All stretches as one, for columns that depend on each sample only; without other known torque."""
        if len(self.stretches) == 1:
            return self.stretches[0].signals
        samples = {name: self.laid(attrgetter(name)) for name in SAMPLES}
        return replace(self.stretches[0].signals, **samples, known=())

    def against(self, targets: Array, lag: float = 0.0) -> Callable[[Sequence[Column]], Array]:
        """Inner products (k, t) of columns with targets (m, t), for which no column has to be filtered itself.

        The columns are of all stretches as they are `joined`.
        """
        smooth = self.conditioning.filter
        spread = np.zeros((targets.shape[1], self._places[-1] + 1))
        spread[:, self._places] = targets.T

        @cache
        def back(size: int, order: int) -> Array:
            return smooth.backwards(spread, size, order, lag)

        def product(column: Column) -> Array:
            found = [back(values.size, order) @ values for values, order in column]
            return found[0] if len(found) == 1 else np.sum(found, axis=0)

        return lambda columns: np.array([product(column) for column in columns])

    def kept(self, columns: Callable[..., Sequence[Column]], *values: Hashable, lag: Lag = 0.0) -> Array:
        """The same of columns that a function computes from a stretch's raw signals and some values, made once."""
        key = columns, values, lag, self.made_by
        return self.memory.get(key, lambda: self.table(lambda signals: columns(signals, *values), lag))

    def kept_of(self, effect: Columns, shape: tuple[float, ...], lag: float) -> Array:
        """The same of the columns of an effect."""
        return self.memory.get(
            (effect.columns, shape, lag, self.made_by), lambda: self.table([self.columns_of(effect, [shape])], lag)
        )


def sign_reach(smooth: GaussianFilter, near: bool = False) -> float:
    """How long the speed keeps its sign before and after a row - s.

    As far as the filter spreads a reversal, and a lag of the torque: one of some filter widths, or, `near` reversals, a
    short time, as a wider filter makes no drive later. One more width reduces it to 4e-5 of a reversal.
    """
    late = max(LATE, LATE_SAMPLES * smooth.sample_period, smooth.width)
    return min(SIGN_WIDTHS * smooth.width, SIGN_REACH * smooth.width + (late if near else np.inf))


def clear_motion(conditioning: Conditioning, kind: AxisKind) -> str:
    """What a row of the torque balance needs: one direction over the filter's reach, at a speed above the noise."""
    speed, reach = conditioning.sign_threshold, 2.0 * sign_reach(conditioning.filter)
    return (
        f"runs that keep one direction well over {reach:.2g} s, "
        f"at speeds well above {speed:.3g} {kind.speed_unit}, where noise no longer makes the sign"
    )


def effort_of(signals: Signals) -> list[Column]:
    """The motor torque as it is reported, as the one column of a table."""
    return [[(signals.effort, 0)]]


def known_of(signals: Signals) -> list[Column]:
    """The torque that is known to act, as the one column of a table."""
    return [signals.known]


def slope_of(signals: Signals) -> list[Column]:
    """By how much that is another one where the links are ahead of their encoder, as the one column of a table."""
    return [[(np.broadcast_to(signals.known_slope, signals.time.shape), 0)]]


def _signals(
    trace: Trace,
    rig: Rig,
    effort: Array,
    driven: Array,
    part: slice,
    conditioning: Conditioning,
    peak_effort: float,
    begins: float,
) -> Signals:
    """Raw signals of a stretch; a position that is not recorded from speed."""
    period, source = trace.sample_period, trace[conditioning.source][part]
    speed = raw_speed(source, conditioning.source, period)
    velocity = speed if conditioning.source == "position" or "velocity" not in trace else trace["velocity"][part]
    sign = known_sign(speed, conditioning.sign_threshold)
    load = rig.load
    return Signals(
        time=trace.time[part] - (trace.start_of(part) if trace.joined else begins),
        began=trace.start_of(part) - begins if trace.joined else 0.0,
        position=trace["position"][part] if "position" in trace else integrated(velocity, period),
        velocity=velocity,
        sign=sign,
        effort=effort[part],
        torque=effort[part],
        friction=sign,
        peak_effort=peak_effort,
        sample_period=period,
        source=conditioning.source,
        known=known_column(trace, part),
        known_inertia=known_along(trace, part, KNOWN_INERTIA),
        known_slope=known_along(trace, part, KNOWN_SLOPE),
        link_inertia=(load.link_inertia or 0.0) / load.gear_ratio**2 if load is not None else 0.0,
        of_motion=(driven - effort)[part],
    )


def _scope(trace: Trace, rig: Rig, conditioning: Conditioning, peak_effort: float) -> Scope:
    """What a recording is able to show, before any of its motion is looked at."""
    drift = 0.0
    if "position" not in trace:  # of the mean of integrated white noise, sigma*sqrt(T_s*T/3)
        drift = conditioning.source_noise * float(np.sqrt(trace.sample_period * (trace.time[-1] - trace.time[0]) / 3.0))
    return Scope(
        kind=trace.axis_kind,
        source=conditioning.source,
        signals=frozenset(trace.signals),
        one_way=False,
        duration=0.0,
        sample_period=trace.sample_period,
        latched=rig.drive.control_period if rig.drive is not None else trace.sample_period,
        drift=drift,
        width=conditioning.filter.width,
        travel=0.0,
        top_speed=0.0,
        rms_speed=0.0,
        peak_effort=peak_effort,
        rotor_inertia=rig.motor.rotor_inertia or 0.0,
    )
