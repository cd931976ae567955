"""Readers of CODESYS V3 and Machine Expert traces: the trace editor's own file, and what it exports as CSV or text.

`<Trace><TraceConfiguration>...<Single Name="MicroSeconds" Type="bool">False</Single>...</TraceConfiguration>
<TraceData><TraceRecord><TraceVariable VarName="PLC_PRG.x"><Values>1,2</Values><Timestamps>18,48</Timestamps>...`: one
time vector per variable, in ms or us from the trace's start. No format has units; the bench's own files tell them in
the trace's comment, as `units: velocity [deg/s], current [mA]`.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable, Mapping
from xml.etree import ElementTree

import numpy as np
import pyarrow as pa

from bench.arrays import Array
from bench.errors import InputError
from bench.names import short
from bench.trace.channel import Channel, Recording, split_label, with_shared_times
from bench.trace.readers.layout import BLANKS, layout_of
from bench.trace.readers.table import read_timed
from bench.trace.readers.xml import parse, root_name
from bench.trace.source import Source
from bench.units import convert

#: Units of the lab's PLC variables: a reported assumption.
LAB_UNITS: dict[str, str] = {
    "position": "deg",
    "velocity": "deg/s",
    "current": "mA",
    "position_reference": "deg",
    "velocity_reference": "deg/s",
}
_UNITS_COMMENT = "units: "
_MICROSECONDS = 32
_FLAGS = re.compile(r"[0-9]{1,19}")
_STAMPS = re.compile(r"^[ \t]*(?:Timestamp|Zeitstempel)[ \t]*\((ms|us|µs)\)[ \t]+(\S.*)$", re.MULTILINE)


class CodesysXml:
    """The trace editor's own file: `.trace`, or the same as `.xml`."""

    format = "CODESYS / Machine Expert trace"
    endings = (".trace", ".xml")

    def recognises(self, source: Source) -> bool:
        """Whether the root element is that of a trace."""
        return root_name(source) == "Trace"

    def read(self, source: Source) -> Recording:
        """Recording of a trace.

        Raises:
            InputError: truncated, without recorded variables, or a variable whose values and times differ in number.
        """
        root = parse(source)
        settings = {single.get("Name", ""): (single.text or "").strip() for single in root.iter("Single")}
        time_unit = "us" if settings.get("MicroSeconds", "").lower() == "true" else "ms"
        comment = settings.get("Comment", "")
        labels = comment.removeprefix(_UNITS_COMMENT).split(", ") if comment.startswith(_UNITS_COMMENT) else []
        units = {name: unit for name, unit in map(split_label, labels) if unit is not None}
        variables = [_variable(element, units, time_unit, source.path) for element in root.iter("TraceVariable")]
        recorded = [channel for channel in variables if channel.values.size]
        if not recorded:
            raise InputError(source.path, "found no recorded variable", "allowed: a trace with recorded data")
        empty = [channel.name for channel in variables if not channel.values.size]
        notes = (f"nothing recorded of {', '.join(empty)}",) if empty else ()
        return Recording(
            with_shared_times(recorded), self.format, source.path, _metadata(settings), notes, usual_units=LAB_UNITS
        )


def _metadata(settings: Mapping[str, str]) -> dict[str, str]:
    return {key: settings[key] for key in ("Name", "ApplicationName", "IecTaskName", "Comment") if settings.get(key)}


def _variable(element: ElementTree.Element, units: Mapping[str, str], time_unit: str, path: str) -> Channel:
    name = element.get("VarName", "?")
    place = f"{path}: variable '{name}'"
    values, times = (_list(element, tag, place) for tag in ("Values", "Timestamps"))
    if values.size != times.size:
        raise InputError(place, f"found {values.size} values and {times.size} time stamps", "allowed: as many of both")
    return Channel(name, units.get(name), values, path, time=Channel(f"{name} time stamps", time_unit, times, path))


def _list(element: ElementTree.Element, tag: str, place: str) -> Array:
    text = (element.findtext(tag) or "").strip()
    if not text:
        return np.empty(0)
    return _numbers(text.split(","), lambda sample: f"{place}, {tag}, sample {sample}")


def _numbers(texts: list[str], place: Callable[[int], str]) -> Array:
    """Numbers from their texts (TRUE and FALSE as 1 and 0) - (n,); InputError naming the place of one that is none."""
    try:
        return np.array(texts, dtype=np.float64)
    except ValueError:
        return np.array([_number(text, place, sample) for sample, text in enumerate(texts)], dtype=np.float64)


def _number(text: str, place: Callable[[int], str], sample: int) -> float:
    word = text.strip().lower()
    if word in ("true", "false"):
        return float(word == "true")
    try:
        return float(word)
    except ValueError as error:
        found = f"found {short(text.strip())!r}" if word else "found an empty cell"
        raise InputError(place(sample), found, "allowed: a number") from error


class CodesysCsv:
    """The CSV export.

    A header of `key; value` lines (`Flags` 16: times in ms, 32: us), then per variable `N.Variable; name`, further
    keys, `N.Data;` and lines `; time; value`.
    """

    format = "CODESYS / Machine Expert CSV export"
    endings = ()

    def recognises(self, source: Source) -> bool:
        """Whether the head is that of the export."""
        return source.head.lstrip().startswith("[key]") or bool(
            re.search(r"^\d+\.Variable;", source.head, re.MULTILINE)
        )

    def read(self, source: Source) -> Recording:
        """Recording of an export.

        Raises:
            InputError: no variable with data, or a line that is neither `key; value` nor `; time; value`.
        """
        keys: dict[str, str] = {}
        samples: dict[str, list[str]] = {}
        lines: dict[str, int] = {}
        number = ""
        for line, text in enumerate(source.text().splitlines(), 1):
            cells = [cell.strip() for cell in text.split(";")]
            if not any(cells):
                continue
            if cells[0]:
                keys[cells[0]] = cells[1] if len(cells) > 1 else ""
                number = cells[0].removesuffix(".Data") if cells[0].endswith(".Data") else ""
                continue
            if len(cells) != 3 or not number:
                raise InputError(f"{source.path}: line {line}", f"found {text.strip()!r}", "allowed: '; time; value'")
            lines.setdefault(number, line)
            samples.setdefault(number, []).append(text.partition(";")[2])
        flags = keys.get("Flags", "16")
        unit = "us" if _FLAGS.fullmatch(flags) and int(flags) & _MICROSECONDS else "ms"
        channels: list[Channel] = []
        for number, texts in samples.items():
            name = keys.get(f"{number}.Variable", f"variable {number}")
            layout = layout_of((f"time [{unit}]", name), ";")
            channels += read_timed(texts, lines[number], layout, source.path)
        if not channels:
            raise InputError(source.path, "found no variable with data", "allowed: an export with recorded data")
        return Recording(with_shared_times(channels), self.format, source.path, _metadata(keys), usual_units=LAB_UNITS)


class CodesysText:
    """The text export: a title and the project's path, then `Timestamp(ms) VarA VarB` (German `Zeitstempel(ms)`)."""

    format = "CODESYS / Machine Expert text export"
    endings = ()

    def recognises(self, source: Source) -> bool:
        """Whether a line of the head names a time stamp with its unit, then variables."""
        return _STAMPS.search(source.head) is not None

    def read(self, source: Source) -> Recording:
        """Recording of a text export.

        Raises:
            InputError: no samples, or a line with too few or too many values.
        """
        text = source.text()
        header = _STAMPS.search(text)
        assert header is not None
        titles = [line.strip() for line in text[: header.start()].splitlines() if line.strip()]
        below = text[header.end() :].splitlines()[1:]
        if not any(line.strip() for line in below):
            raise InputError(source.path, "found a header and no samples", "allowed: at least two samples")
        line = len(text[: header.end()].splitlines()) + 1
        layout = layout_of((f"time [{header[1]}]", *header[2].split()), BLANKS)
        channels = read_timed(below, line, layout, source.path)
        metadata = dict(zip(["title", "project"], titles, strict=False))
        return Recording(channels, self.format, source.path, metadata, usual_units=LAB_UNITS)


def machine_expert_trace(table: pa.Table) -> bytes:
    """File content of columns `name [unit]`, the first of them the time.

    Times are whole ms where they all are, else whole us. The format has no place for units, so they stand in the
    trace's comment, which the editor shows and the bench reads.
    """
    time_unit = split_label(table.column_names[0])[1] or "s"
    microseconds = convert(table.column(0).to_numpy(), time_unit, "us")
    coarse = bool(np.abs(microseconds - 1e3 * np.rint(microseconds / 1e3)).max() < 1e-3)
    stamps = ",".join(map(str, np.rint(microseconds / 1e3 if coarse else microseconds).astype(np.int64).tolist()))
    root = ElementTree.Element("Trace")
    settings = ElementTree.SubElement(root, "TraceConfiguration")
    _single(settings, "Comment", "string", _UNITS_COMMENT + ", ".join(table.column_names[1:]))
    _single(settings, "MicroSeconds", "bool", str(not coarse))
    data = ElementTree.SubElement(root, "TraceData", Version="1.0.0.0")
    record = ElementTree.SubElement(data, "TraceRecord")
    for index, label in enumerate(table.column_names[1:]):
        variable = ElementTree.SubElement(
            record, "TraceVariable", VarName=split_label(label)[0], VariableIndex=str(index), Type="System.Double"
        )
        values = table.column(index + 1).to_numpy()
        ElementTree.SubElement(variable, "Values").text = ",".join(map(repr, values.tolist()))
        ElementTree.SubElement(variable, "Timestamps").text = stamps
    ElementTree.indent(root)
    text = '<?xml version="1.0" encoding="utf-16"?>\n' + ElementTree.tostring(root, encoding="unicode")
    return codecs.BOM_UTF16_LE + text.encode("utf-16-le")


def _single(parent: ElementTree.Element, name: str, kind: str, text: str) -> None:
    ElementTree.SubElement(parent, "Single", Name=name, Type=kind).text = text
