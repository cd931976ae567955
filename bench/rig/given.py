"""What a person may give for a rig or a recording: the object, a file's path, arrays by name or a data frame.

Where no rig is given, one is drafted from the recording: it works as far as the file determines it, and requires what
only the user can state.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from bench.errors import InputError
from bench.names import short
from bench.rig.motor import catalogue_motor
from bench.rig.rig import Rig, load_rig, without_constant, without_rated
from bench.structured import parse_toml
from bench.trace.channel import ARRAYS, Recording
from bench.trace.choose import GivenOptions
from bench.trace.from_arrays import Arrays, recording_of
from bench.trace.trace import Trace, assemble, join

if TYPE_CHECKING:
    from bench.trace.inspect import ColumnSummary, Inspection

Given: TypeAlias = Trace | str | Path | Arrays
GivenRig: TypeAlias = Rig | str | Path | Mapping[str, Any]
Units: TypeAlias = Mapping[str, str]


def given(
    traces: Given | Iterator[Trace] | Sequence[Given | Iterator[Trace]],
    rig: GivenRig | None,
    units: Units | None = None,
) -> tuple[Rig, list[Trace | Iterator[Trace]]]:
    """A rig, drafted from the first recording where none is given, and one recording or a list (tuple) of several.

    Args:
        traces: a recording, its file, arrays by their names or a data frame, parts of one, or a list of these.
        rig: or its file, the name of a shipped one, or its tables as a dictionary.
        units: of columns by their names, which replace those of the file or frame.

    Raises:
        InputError: one of them is none, or a recording cannot be read.
    """
    every = [_trace_in(one) for one in (traces if isinstance(traces, list | tuple) else [cast(Given, traces)])]
    known = rig_of(rig) if rig is not None else _drafted_for(every, units)
    return known, [one if isinstance(one, Iterator) else trace_of(one, known, units) for one in every]


def _trace_in(given: Given | Iterator[Trace]) -> Given | Iterator[Trace]:
    """The trace of a simulation; else what is given."""
    held = None if isinstance(given, Trace) else getattr(given, "trace", None)
    return held if isinstance(held, Trace) else given


def recordings_of(
    traces: Given | Sequence[Given], rig: GivenRig | None, units: Units | None = None
) -> tuple[Rig, list[Trace]]:
    """The same for recordings that are in memory as a whole."""
    known, every = given(traces, rig, units)
    return known, [one if isinstance(one, Trace) else join(list(one)) for one in every]


def rig_of(given: GivenRig) -> Rig:
    """A rig, or that of a file, of a shipped one's name, or of tables; InputError where it is none."""
    if isinstance(given, Rig):
        return given
    if isinstance(given, Mapping):
        return Rig(**{str(key): value for key, value in given.items()})
    if not isinstance(given, str | Path):
        allowed = 'allowed: a Rig, a rig file, a shipped rig\'s name, or {"motor": {"torque_constant": "0.8 N*m/A"}}'
        if hasattr(given, "__array__"):
            raise InputError("rig", f"found {type(given).__name__}", f"{allowed}; signals go into the first argument")
        raise InputError("rig", f"found {short(repr(given))}", allowed)
    return load_rig(given)


def trace_of(given: Given, rig: Rig, units: Units | None = None) -> Trace:
    """A recording, read by the rig where it is a file, arrays or a frame; InputError where it is none."""
    if not isinstance(given, Trace):
        return assemble(_recorded(given, units), rig.trace)
    if units:
        raise InputError("units", "found with a Trace, which has units", "allowed: with a file, arrays or a frame")
    return given


def _recorded(given: str | Path | Arrays, units: Units | None) -> Recording:
    if not isinstance(given, str | Path):
        return recording_of(given).stated(units)
    from bench.trace.read import read_recording  # the readers of all formats: 0.1 s with pyarrow

    return read_recording(given).stated(units)


def _drafted_for(every: Sequence[Given | Iterator[Trace]], units: Units | None) -> Rig:
    """The rig that the first recording drafts; what it assumes is a warning of the result."""
    if not every or isinstance(every[0], Iterator):
        raise InputError("rig", "missing", "allowed: without one only where a whole recording is given")
    if isinstance(every[0], Trace):
        return Rig(name="axis", kind=every[0].axis_kind.name)
    found, _, assumed = drafted(_recorded(every[0], units))
    return found.model_copy(update={"assumed": (assumed,)})


def draft(inspection: Inspection, motor: str | None = None, axis: str | None = None) -> str:
    """Text of a rig file for the recording, with a motor by its name in the catalogue, and the axis picked of several.

    InputError where the catalogue has no such motor.
    """
    if motor is not None:
        catalogue_motor(motor, "--motor")
    linear = any(signal.unit in ("m", "m/s", "N") for signal in inspection.signals)
    lines = [
        f"# Drafted from {Path(inspection.origin).name} ({inspection.format}). Check it; ? is what only you know.",
        f"name = {json.dumps(Path(inspection.origin).name.split('.')[0])}",
        f'kind = "{"linear" if linear else "rotary"}"{"" if linear else "                      # or linear"}',
        "",
        "[motor]",
        *_motor(inspection, motor, linear),
        "",
        *_trace(inspection, axis),
    ]
    return "\n".join(lines).rstrip() + "\n"


def drafted(recording: Recording, axis: str | None = None) -> tuple[Rig, str, str]:
    """The rig that a recording, or one axis of several in it, drafts: its text too, and what it assumes, in a line.

    InputError where the user has to state something.
    """
    from bench.trace.inspect import inspect_recording

    name, found = Path(recording.origin).name, inspect_recording(recording, GivenOptions(axis=axis))
    text = draft(found, axis=axis)
    rig = Rig.of(parse_toml(text, name), f"rig drafted from {name}")
    try:
        trace = assemble(recording, rig.trace)
    except InputError as error:
        if recording.format == ARRAYS:
            raise
        how = f"`bench inspect {shlex.quote(recording.origin)} --draft rig.toml` writes a rig to complete, for --rig"
        raise InputError(error.where, error.found, f"{error.allowed}; {how}") from error
    mapped = [f"{signal} = {column}" for signal, column in rig.trace.columns.items()]
    direct = {"torque", "force"} & trace.signals.keys()
    remark = without_rated(rig, trace) if direct else without_constant(rig) if "current" in trace else None
    assumed = "; ".join(filter(None, (f"a {rig.kind} axis", ", ".join(mapped), remark)))
    return rig, text, f"no rig was given, so one was drafted from {name}: {assumed}"


def _motor(inspection: Inspection, motor: str | None, linear: bool) -> list[str]:
    if motor is not None:
        return [f"model = {json.dumps(motor)}"]
    efforts = {column.signal for column in inspection.columns}
    units = [f"{one.unit or ''}{one.suggestion or ''}" for one in inspection.columns if one.signal == "torque"]
    constant, unit = ("force_constant", "N/A") if linear else ("torque_constant", "N*m/A")
    lines = [
        f'# {"moving_mass" if linear else "rotor_inertia"} = "? {"kg" if linear else "kg*cm**2"}"'
        "     # of the motor without load, datasheet: gives the load's",
    ]
    if "current" in efforts:
        lines.append(f'# {constant} = "? {unit}"     # datasheet; without it results are in A instead of {unit[:-2]}')
        lines.append('# current = "effective"     # where the datasheet gives its values for Arms')
    if any("%" in text or "permille" in text for text in units):
        lines.append('# rated_torque = "? N*m"     # what 100 % of the recorded torque means, datasheet')
    if not efforts & {"torque", "force", "current", "voltage"}:
        lines.append("# no torque, force or current was found in the file: identification needs one of them")
    return lines


def _trace(inspection: Inspection, axis: str | None) -> list[str]:
    """`[trace]` and its columns: those that are plain, and as comments those whose unit only the user can state."""
    settings = [f"axis = {json.dumps(axis)}"] if axis is not None else []
    timed = any(one.signal == "time" or one.rate is not None for one in inspection.columns)
    if (inspection.rate is None and not timed) or "sample_period" in (inspection.asks or ""):
        settings.append('# sample_period = "? ms"     # the file has no usable time: how often was it sampled?')
    lines = ["[trace]", *settings, ""] if settings else []
    several = axis is None and len(inspection.axes) > 1
    columns = _columns(one for one in inspection.columns if not several or one.axis is None)
    lines += ["[trace.columns]", *columns] if columns else []
    for joint in inspection.axes if several else ():
        own = _columns(one for one in inspection.columns if one.axis == joint)
        lines += [
            "",
            f"[joints.{json.dumps(joint)}.columns]     # the name that the joint has in its MJCF; without unit SI",
        ]
        lines += [line.removeprefix("# ").replace(" [?]", "").removesuffix("; its unit?") for line in own]
    return lines


def _columns(columns: Iterable[ColumnSummary]) -> list[str]:
    """Lines of what columns are likely to be, as comments where only the user can state the unit."""
    lines = []
    for column in columns:
        if column.suggestion is not None:
            why = f"     # {', '.join(column.why)}" if column.why else ""
            open_unit = "[?]" in column.suggestion
            lines.append(("# " if open_unit else "") + column.suggestion + why + ("; its unit?" if open_unit else ""))
    return lines
