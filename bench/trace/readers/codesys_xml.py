"""Reader of CODESYS V3 and Machine Expert traces (`.trace`, or the same as `.xml`).

`<Trace><TraceConfiguration>...<Single Name="MicroSeconds" Type="bool">False</Single>...</TraceConfiguration>
<TraceData><TraceRecord><TraceVariable VarName="PLC_PRG.x"><Values>1,2</Values><Timestamps>18,48</Timestamps>...`: one
time vector per variable, in ms or us from the trace's start. The format has no units; the bench's own files tell them
in the trace's comment, as `units: velocity [deg/s], current [mA]`.
"""

from __future__ import annotations

from dataclasses import replace
from xml.etree.ElementTree import Element

import numpy as np

from bench.errors import InputError
from bench.trace.channel import Channel, Recording, float_values, split_label, with_shared_times
from bench.trace.readers.lab_units import LAB_UNITS
from bench.trace.readers.xml import parse, root_name
from bench.trace.source import Source

FORMAT = "CODESYS / Machine Expert trace"
ENDINGS = (".trace", ".xml")

UNITS_COMMENT = "units: "


def recognises(source: Source) -> bool:
    """Whether the root element is that of a trace."""
    return root_name(source) == "Trace"


def read(source: Source) -> Recording:
    """Recording of a trace.

    Raises:
        InputError: truncated, without recorded variables, or a variable whose values and times differ in number.
    """
    root = parse(source)
    settings = {single.get("Name", ""): (single.text or "").strip() for single in root.iter("Single")}
    time_unit = "us" if settings.get("MicroSeconds", "").lower() == "true" else "ms"
    comment = settings.get("Comment", "")
    labels = comment.removeprefix(UNITS_COMMENT).split(", ") if comment.startswith(UNITS_COMMENT) else []
    units = {name: unit for name, unit in map(split_label, labels) if unit is not None}
    variables = [_channel(variable, time_unit, source.path) for variable in root.iter("TraceVariable")]
    recorded = [replace(channel, unit=units.get(channel.name)) for channel in variables if channel.values.size]
    if not recorded:
        raise InputError(source.path, "found no recorded variable", "allowed: a trace with recorded data")
    empty = [channel.name for channel in variables if not channel.values.size]
    notes = (f"nothing recorded of {', '.join(empty)}",) if empty else ()
    return Recording(with_shared_times(recorded), FORMAT, source.path, _metadata(settings), notes, LAB_UNITS)


def _metadata(settings: dict[str, str]) -> dict[str, str]:
    return {
        name: settings[name] for name in ("Name", "ApplicationName", "IecTaskName", "Comment") if settings.get(name)
    }


def _channel(variable: Element, time_unit: str, path: str) -> Channel:
    name = variable.get("VarName", "?")
    place = f"{path}: variable '{name}'"
    values, times = (_list(variable, tag, place) for tag in ("Values", "Timestamps"))
    if values.size != times.size:
        raise InputError(place, f"found {values.size} values and {times.size} time stamps", "allowed: as many of both")
    return Channel(name, None, values, path, time=Channel(f"{name} time stamps", time_unit, times, path))


def _list(variable: Element, tag: str, place: str) -> np.ndarray:
    text = (variable.findtext(tag) or "").strip()
    if not text:
        return np.empty(0)
    return float_values(text.split(","), lambda sample: f"{place}, {tag}, sample {sample}")
