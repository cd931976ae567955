"""What a recording holds, before it is used: every column and, where they are clear, the signals.

Where a column is not read, the signal that it probably holds is judged by name, unit and values, with the reasons. Only
a suggestion: the user decides and enters it in the rig's `[trace.columns]`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from types import MappingProxyType

import numpy as np

from bench.arrays import Array, correlation, rms
from bench.errors import InputError
from bench.structured import json_text
from bench.trace.assumed import time_unit
from bench.trace.channel import Channel, Recording
from bench.trace.choose import ReadingOptions, SignalColumn, axes_of, choose, of_axis
from bench.trace.in_si import in_si
from bench.trace.signals import (
    REFERENCE,
    SI_UNITS,
    WORDS,
    is_index,
    scale_in,
    signal_of,
    unit_in_name,
    unit_of,
    wanted_units,
)
from bench.trace.trace import on_time_base, unused
from bench.units.conversion import scale_of
from bench.units.grammar import UnitError

SCHEMA = "bench.inspect/1"

_NAMED = {signal: re.compile(rf"(?:{words})\d*", re.I) for signal, words in WORDS.items()}
_FOREIGN = re.compile(
    r"d_axis\w*|id|in|battery|supply|mos|frame|seq|state|status|flags?|mode|error|fault|checksum", re.I
)
_PARTS = re.compile(r"[\s._/:()\[\],;|-]+|(?<=[a-z])(?=[A-Z])")
#: Correlation from which a column is another's derivative, and samples that are looked at.
DERIVATIVE, ENOUGH = 0.9, 200_000

_DYNAMIXEL = "as Dynamixel's X series has it (control table in Robotis' e-manual); check your model's"
_ODRIVE = "as ODrive has it (docs.odriverobotics.com, API reference)"
_ROS = "as ROS has it (REP 103)"
_VESC = "as VESC Tool logs it"
_SINAMICS = "as SINAMICS has it (list manual)"
_CIA402 = "object of CiA 402"

#: Columns of drive vendors: the signal, its unit by the manual - None if it depends on settings -, and the source with
#: what to check.
COLUMNS: dict[str, tuple[str, str | None, str]] = {
    "present_position": ("position", "turn/4096", _DYNAMIXEL),
    "present_velocity": ("velocity", "0.229 rpm", _DYNAMIXEL),
    "present_current": ("current", "2.69 mA", _DYNAMIXEL + ": 2.69 mA of XM and XH, 1 mA of XL330 and XC330"),
    "pos_estimate": ("position", "turn", _ODRIVE),
    "vel_estimate": ("velocity", "turn/s", _ODRIVE),
    "iq_measured": ("current", "A", _ODRIVE),
    "torque_estimate": ("torque", "N*m", _ODRIVE),
    "input_pos": ("position_reference", "turn", _ODRIVE),
    "input_vel": ("velocity_reference", "turn/s", _ODRIVE),
    "%time": ("time", "ns", "as rostopic echo -p writes it"),
    "position0": ("position", "rad", _ROS),
    "velocity0": ("velocity", "rad/s", _ROS),
    "effort0": ("torque", "N*m", _ROS),
    "ms_today": ("time", "ms", _VESC),
    "q_axis_current": ("current", "A", _VESC),
    "erpm": ("velocity", None, "electrical revolutions: write rpm/P with the motor's P pairs of poles"),
    "r63": ("velocity", "rpm", _SINAMICS),
    "r80": ("torque", "N*m", _SINAMICS),
    "r78": ("current", "Arms", _SINAMICS),
    "0x6064": ("position", None, f"{_CIA402}, position actual value; its unit is a setting of the drive"),
    "0x606c": ("velocity", None, f"{_CIA402}, velocity actual value; its unit is a setting of the drive"),
    "0x6077": ("torque", "permille", f"{_CIA402}, torque actual value in permille of rated_torque"),
}


@dataclass(frozen=True)
class SignalSummary:
    """One signal in numbers.

    Attributes:
        name, unit: of the signal; SI.
        column: of the file it was read from.
        minimum, maximum, rms: of its values - `unit`.
        resolution: smallest step between successive recorded values, unless they are all equal - `unit`.
    """

    name: str
    unit: str
    column: str
    minimum: float
    maximum: float
    rms: float
    resolution: float | None


@dataclass(frozen=True)
class ColumnSummary:
    """One column of the file.

    Attributes:
        name, unit: as in the file.
        axis: of a file that tells several apart.
        count: of its numbers.
        minimum, maximum, resolution: of its numbers, in the file's unit; None where it holds none, or never changes.
        rate: of its samples, where it has times of its own - Hz.
        signal: that it is read as, or probably is; None if unknown.
        read: whether it is read as that.
        why: the reasons.
        suggestion: line for the rig's `[trace.columns]`, if it is not read.
    """

    name: str
    unit: str | None
    axis: str | None
    count: int
    minimum: float | None
    maximum: float | None
    resolution: float | None
    rate: float | None
    signal: str | None
    read: bool
    why: tuple[str, ...]
    suggestion: str | None


@dataclass(frozen=True)
class Inspection:
    """What a recording holds; only columns and `asks` if its signals are not clear.

    Attributes:
        origin, format: the file and what it is.
        columns: of the file, in its order.
        axes: of the file.
        asks: why the file cannot be read as it is, and what to write; None if it can.
        samples, segments: on the regular time base, and its stretches between holes.
        start, duration: of the recording - s.
        rate: sample rate - Hz.
        jitter, holes, duplicates, interpolated, resampled, steps: as of `bench.trace.time_base.TimeBase`.
        signals: in the order of `bench.trace.signals`.
        dropped: columns that are no known signal.
        metadata: what the file says about itself.
        notes: what the reader did, assumed or left out.
    """

    origin: str
    format: str
    columns: tuple[ColumnSummary, ...]
    axes: tuple[str, ...]
    asks: str | None
    samples: int | None = None
    segments: int | None = None
    start: float | None = None
    duration: float | None = None
    rate: float | None = None
    jitter: float | None = None
    holes: tuple[tuple[float, float], ...] = ()
    duplicates: int = 0
    interpolated: int = 0
    resampled: bool = False
    steps: tuple[float, float] | None = None
    signals: tuple[SignalSummary, ...] = ()
    dropped: tuple[str, ...] = ()
    metadata: Mapping[str, str] | None = None
    notes: tuple[str, ...] = ()

    @property
    def suggestions(self) -> tuple[str, ...]:
        """Lines for the rig's `[trace.columns]`."""
        return tuple(column.suggestion for column in self.columns if column.suggestion is not None)


def inspect_recording(recording: Recording, how: ReadingOptions) -> Inspection:
    """Look into a recording.

    Raises:
        InputError: a column that the options name is not there, or has no unit. A recording that needs a rig to be read
            is no error here.
    """
    origin, kind, axes, metadata = recording.origin, recording.format, axes_of(recording.channels), recording.metadata
    try:
        chosen, assumed = choose(recording, how)
        notes = [*recording.notes, *assumed]
        sampled = in_si(chosen, recording, how, notes)
        trace = on_time_base(sampled, chosen, recording, notes)
    except InputError as error:
        if how.columns:
            raise
        columns = tuple(_columns(recording, {}, how))
        return Inspection(origin, kind, columns, axes, str(error), metadata=dict(metadata), notes=recording.notes)
    assert trace.time_base is not None  # a trace that was read has one
    base = asdict(trace.time_base)
    return Inspection(
        origin=origin,
        format=kind,
        columns=tuple(_columns(recording, chosen, how)),
        axes=axes,
        asks=None,
        samples=len(trace),
        segments=len(trace.segments),
        start=float(trace.time[0]),
        duration=float(trace.time[-1] - trace.time[0]),
        rate=1.0 / base.pop("sample_period"),
        **base,
        signals=tuple(
            _summary(name, trace.units[name], chosen[name].channel.label, values, sampled[name].values)
            for name, values in trace.signals.items()
        ),
        dropped=tuple(unused(chosen, recording)),
        metadata=dict(metadata),
        notes=trace.notes,
    )


def to_json(inspection: Inspection, more: Mapping[str, object] = MappingProxyType({})) -> str:
    """The inspection as JSON, its fields under their names, and what others have to say of the recording."""
    return json_text({"schema": SCHEMA, **asdict(inspection), "suggestions": inspection.suggestions, **more})


def _summary(name: str, unit: str, column: str, values: Array, recorded: Array) -> SignalSummary:
    largest = float(np.abs(values).max())
    effective = largest * rms(values / largest) if largest > 0.0 else 0.0
    return SignalSummary(name, unit, column, float(values.min()), float(values.max()), effective, _resolution(recorded))


def _resolution(values: Array) -> float | None:
    with np.errstate(over="ignore"):  # of numbers at the end of what there is
        steps = np.abs(np.diff(values))
    steps = steps[(steps > 0.0) & (steps < np.inf)]
    return float(steps.min()) if steps.size else None


def _columns(recording: Recording, chosen: Mapping[str, SignalColumn], how: ReadingOptions) -> Iterator[ColumnSummary]:
    """Every column of the axis in numbers, with what it is read as or likely to be."""
    channels = of_axis(recording, how.axis)
    read = {choice.channel: signal for signal, choice in chosen.items()}
    guesses = likely_signals(channels)
    for channel in channels:
        numbers = channel.values[np.isfinite(channel.values)]
        signal, guess, why, suggestion = read.get(channel), guesses.get(channel), (), None
        if signal is None and guess is not None and guess.signal not in chosen:
            unit = "" if channel.moments else f" [{guess.unit or '?'}]"  # of which only the user knows it
            signal, why = guess.signal, guess.why
            suggestion = f"{signal} = {json.dumps(channel.name + unit, ensure_ascii=False)}"
        yield ColumnSummary(
            name=channel.name,
            unit=channel.unit,
            axis=channel.axis,
            count=int(numbers.size),
            minimum=float(numbers.min()) if numbers.size else None,
            maximum=float(numbers.max()) if numbers.size else None,
            resolution=_resolution(numbers),
            rate=_rate(channel),
            signal=signal,
            read=channel in read,
            why=why if channel.defect is None else (str(channel.defect.found),),
            suggestion=suggestion,
        )


def _rate(channel: Channel) -> float | None:
    if channel.time is None or channel.time.values.size < 2:
        return None
    step = float(np.median(np.diff(channel.time.values)))
    seconds = step * scale_in("time", channel.time.unit or "s", channel.time.place()).factor
    return 1.0 / seconds if seconds > 0.0 else None


@dataclass(frozen=True)
class Guess:
    """A signal that a column may hold.

    Attributes:
        signal: as `[trace.columns]` names it.
        unit: of the column; None if only the user knows.
        why: the reasons.
        weight: of the reasons.
    """

    signal: str
    unit: str | None
    why: tuple[str, ...]
    weight: float


@np.errstate(over="ignore", invalid="ignore")  # implausible magnitudes give no reasons
def likely_signals(channels: Sequence[Channel]) -> dict[Channel, Guess]:
    """What each channel is likely to be; no two of an axis are the same signal."""
    numeric = [channel for channel in channels if channel.defect is None and channel.values.size > 1]
    times = {channel for channel in numeric if _rises(channel.values)}
    derived = _derivatives([channel for channel in numeric if channel not in times])
    found = [
        (guess, channel) for channel in numeric for guess in _guesses(channel, derived.get(channel), channel in times)
    ]
    given: dict[Channel, Guess] = {}
    taken: set[tuple[str, str | None]] = set()
    for guess, channel in sorted(found, key=lambda pair: -pair[0].weight):
        key = (guess.signal, channel.axis)
        if channel not in given and key not in taken:
            given[channel] = guess
            taken.add(key)
    return _with_time_unit(given)


def _with_time_unit(given: dict[Channel, Guess]) -> dict[Channel, Guess]:
    """A time without a unit takes the one in which position and velocity, both with theirs, agree."""
    of = {guess.signal: channel for channel, guess in given.items()}
    if not {"time", "position", "velocity"} <= set(of):
        return given
    clock, time = of["time"], given[of["time"]]
    if time.unit is not None or clock.moments:
        return given
    ticks, moved = clock.values[:ENOUGH], []
    for name in ("position", "velocity"):
        values, unit = of[name].values[:ENOUGH], given[of[name]].unit
        if unit is None or values.size != ticks.size:
            return given
        moved.append(values * scale_of(unit, wanted_units(name)).factor)
    unit = time_unit(ticks, *moved)
    if unit is None:
        return given
    return {**given, clock: replace(time, unit=unit, why=(*time.why, f"position and velocity agree in {unit}"))}


def _guesses(channel: Channel, derived: tuple[str, str] | None, rises: bool) -> list[Guess]:
    """Signals that a channel may be."""
    unit = written_unit_of(channel)
    parts = [part for part in _PARTS.split(channel.name) if part]
    names = [channel.name.strip().rsplit(".", 1)[-1], *parts]
    speaks = 1.0 if any(_FOREIGN.fullmatch(part) for part in parts) else 2.0
    is_reference = any(REFERENCE.fullmatch(part) for part in parts)
    guesses = []
    named = (channel.signal or signal_of(channel.name) or "").removesuffix("_reference")
    signals = [signal for signal in WORDS if signal == named] or [signal for signal in WORDS if not named]
    for signal in signals if rises else [signal for signal in signals if signal != "time"]:
        fits = _fits(signal, unit)
        if fits is False:
            continue
        why: list[tuple[float, str]] = [(4.0, "holds moments")] if signal == "time" and channel.moments else []
        if (channel.signal or "").removesuffix("_reference") == signal:
            why.append((3.0, f"is of {channel.axis}"))
        elif signal_of(channel.name) == signal:
            why.append((3.0, f"is called '{channel.name}'"))
        elif any(_NAMED[signal].fullmatch(name) for name in names):
            why.append((speaks, f"'{channel.name}' speaks of {signal}"))
        if fits:
            why.append((1.5, f"stands in {unit}"))
        if derived is not None and derived[0] == signal:
            why.append((1.5, derived[1]))
        if signal == "time" and why:
            why.append((1.0, "rises steadily"))
        if sum(weight for weight, _ in why) < 1.5:
            continue
        if is_reference and f"{signal}_reference" in SI_UNITS:
            signal = f"{signal}_reference"
            why.append((-0.25, "is a set-point by its name"))
        own = unit if fits else None
        vendor = None if own is not None or channel.moments else vendor_column(channel.name)
        if vendor is not None and vendor[0] == signal:
            own = vendor[1]
            why.append((0.5, vendor[2]))
        guesses.append(Guess(signal, own, tuple(text for _, text in why), sum(weight for weight, _ in why)))
    return guesses


def written_unit_of(channel: Channel) -> str | None:
    """Unit of a channel from its head or, in round brackets or behind a comma, its name."""
    return unit_of(channel.unit) or (None if channel.moments else unit_in_name(channel.name)[1])


def _fits(signal: str, unit: str | None) -> bool | None:
    """Whether a signal may stand in a unit; None where there is none, or only the user knows."""
    if unit is None:
        return None
    try:
        scale_of(unit, wanted_units(signal))
    except UnitError as error:
        return None if "may mean" in error.found or "counts" in error.found else False
    return True


def _rises(values: Array) -> bool:
    steps = np.diff(values[:ENOUGH])
    steps = steps[np.isfinite(steps)]
    return steps.size > 0 and bool((steps >= 0).all()) and float(np.median(steps)) > 0.0


def _derivatives(columns: Sequence[Channel]) -> dict[Channel, tuple[str, str]]:
    """Signal and reason of pairs of which one is the other's derivative."""
    found: dict[Channel, tuple[str, str]] = {}
    smooth = {
        channel: _smoothed(np.nan_to_num(channel.values[:ENOUGH]))
        for channel in columns
        if channel.values.size >= 64 and not is_index(channel.name)
    }
    for channel in smooth:
        rate = _rate_of(channel.values[:ENOUGH])
        for other in smooth if rate.size else ():
            alike = other.values.size == channel.values.size and other.axis == channel.axis
            if alike and other is not channel and abs(correlation(rate, smooth[other])) > DERIVATIVE:
                found[channel] = ("position", f"its derivative is '{other.name}'")
                found[other] = ("velocity", f"is the derivative of '{channel.name}'")
    return found


def _rate_of(values: Array) -> Array:
    """Smoothed derivative of a column a sample, leaps of a wrapped one left out; empty where it never changes."""
    if not np.isfinite(values).all() or not np.ptp(values):
        return np.empty(0)
    rate = np.gradient(values)
    rate[np.abs(rate) > 0.2 * np.ptp(values)] = 0.0
    return _smoothed(rate)


def _smoothed(values: Array) -> Array:
    return np.convolve(values, np.ones(9) / 9.0, mode="same")


def vendor_column(name: str) -> tuple[str, str | None, str] | None:
    """The column of this name in COLUMNS; None if no known vendor has one."""
    plain = name.strip().lower()
    keys = (plain, plain.rsplit(".", 1)[-1], plain.split("[")[0].split(":")[0].replace("r00", "r"))
    return next((COLUMNS[key] for key in keys if key in COLUMNS), None)
