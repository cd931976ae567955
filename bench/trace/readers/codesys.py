"""Readers of CODESYS V3 and Machine Expert traces: the trace editor's own file, and what it exports as CSV or text.

XML of controllers is recognised by its root element: that of a Sinumerik frequency response is recognised so that the
user learns why it is no trace of a motion.

`<Trace><TraceConfiguration>...<Single Name="MicroSeconds" Type="bool">False</Single>...</TraceConfiguration>
<TraceData><TraceRecord><TraceVariable VarName="PLC_PRG.x"><Values>1,2</Values><Timestamps>18,48</Timestamps>...`: one
time vector per variable, in ms or us from the trace's start. No format has units; the bench's own files have them in
the trace's comment, as `units: velocity [deg/s], current [mA]`.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Mapping
from typing import NoReturn
from xml.etree import ElementTree

import numpy as np
import pyarrow as pa

from bench.arrays import Array
from bench.errors import InputError
from bench.names import short
from bench.trace.channel import Channel, Recording, split_label, with_shared_times
from bench.trace.readers.table import BLANKS, read_timed
from bench.trace.source import FileFormat, Source, no_samples, shows
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
#: A comment of XML, which need not be closed.
_XML_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_ROOT = re.compile(r"<([A-Za-z_][\w:.-]*)")
_MICROSECONDS = 32
_EXPORT = re.compile(r"\A\s*\[key\]|^\d+\.Variable;", re.MULTILINE)
_FLAGS = re.compile(r"[0-9]{1,19}")
_STAMPS = re.compile(r"^[ \t]*(?:Timestamp|Zeitstempel)[ \t]*\((ms|us|µs)\)[ \t]+(\S.*)$", re.MULTILINE)


def _root_name(source: Source) -> str:
    """Name of the root element without its namespace; empty if the content is no XML."""
    head = source.head.lstrip()
    match = _ROOT.search(_XML_COMMENT.sub("", head)) if head.startswith("<") else None
    return match[1].rsplit(":", 1)[-1] if match else ""


class _WithoutDoctype(ElementTree.TreeBuilder):
    def doctype(self, *_: object) -> None:
        """Refuse it: a DOCTYPE may define entities, which expand. ElementTree calls this."""
        raise ValueError("found a DOCTYPE")


def _parse(source: Source) -> ElementTree.Element:
    """Root element, without namespaces in any name; InputError where it is not well-formed, as a truncated file."""
    try:
        text: str | bytes = source.content.decode("utf-8")  # a str, for the declaration may still be utf-16
    except UnicodeDecodeError:
        text = source.content
    try:
        root = ElementTree.fromstring(text, ElementTree.XMLParser(target=_WithoutDoctype()))
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        found = f"the XML is truncated or damaged ({error})"
        raise InputError(source.path, found, "allowed: a complete XML") from error
    for element in root.iter():
        element.tag = element.tag.rsplit("}", 1)[-1]
    return root


def _read_xml(source: Source) -> Recording:
    root = _parse(source)
    settings = {single.get("Name", ""): (single.text or "").strip() for single in root.iter("Single")}
    time_unit = "us" if settings.get("MicroSeconds", "").lower() == "true" else "ms"
    comment = settings.get("Comment", "")
    labels = comment.removeprefix(_UNITS_COMMENT).split(", ") if comment.startswith(_UNITS_COMMENT) else []
    units = dict(map(split_label, labels))
    variables = [_variable(element, units, time_unit, source.path) for element in root.iter("TraceVariable")]
    recorded = [channel for channel in variables if channel.values.size]
    if not recorded:
        raise InputError(source.path, "found no recorded variable", "allowed: a trace with recorded data")
    empty = ", ".join(channel.name for channel in variables if not channel.values.size)
    notes = (f"nothing recorded of {empty}",) if empty else ()
    return _recording(CODESYS_XML, source, recorded, settings, notes)


def _recording(
    kind: FileFormat, source: Source, channels: list[Channel], texts: Mapping[str, str], notes: tuple[str, ...] = ()
) -> Recording:
    metadata = {key: texts[key] for key in ("Name", "ApplicationName", "IecTaskName", "Comment") if texts.get(key)}
    return Recording(with_shared_times(channels), kind.format, source.path, metadata, notes, LAB_UNITS)


def _variable(element: ElementTree.Element, units: Mapping[str, str | None], time_unit: str, path: str) -> Channel:
    name = element.get("VarName", "?")
    place = f"{path}: variable '{name}'"
    times = _list(element, "Timestamps", place)
    values = _list(element, "Values", place, times.size)
    if values.size != times.size:
        found, allowed = f"found {values.size} values and {times.size} time stamps", "allowed: as many of both"
        if (
            times.size < values.size < 2 * times.size
        ):  # some numbers have a decimal comma, and which cannot be determined
            allowed += ", with decimal points, or with ; between numbers that have decimal commas"
        raise InputError(place, found, allowed)
    return Channel(name, units.get(name), values, path, time=Channel(f"{name} time stamps", time_unit, times, path))


def _list(element: ElementTree.Element, tag: str, place: str, count: int = 0) -> Array:
    """Numbers of a list, TRUE and FALSE as 1 and 0 - (n,); InputError naming the place of one that is none.

    Decimal commas are read where semicolons separate the numbers, and where commas make twice as many parts as the
    `count` of numbers: then each has one.
    """
    text = (element.findtext(tag) or "").strip()
    texts = text.split(",") if text else []
    if ";" in text:
        texts = text.replace(",", ".").strip("; ").split(";")
    elif count and len(texts) == 2 * count:
        texts = [f"{whole}.{part}" for whole, part in zip(texts[::2], texts[1::2], strict=True)]
    try:
        return np.array(texts, dtype=np.float64)
    except ValueError:
        numbers = [_number(text, f"{place}, {tag}, sample {sample}") for sample, text in enumerate(texts)]
        return np.array(numbers, dtype=np.float64)


def _number(text: str, place: str) -> float:
    word = text.strip()
    try:
        return float({"true": "1", "false": "0"}.get(word.lower(), word))
    except ValueError as error:
        found = f"found {short(word)!r}" if word else "found an empty cell"
        raise InputError(place, found, "allowed: a number") from error


def _read_csv(source: Source) -> Recording:
    keys: dict[str, str] = {}
    samples: dict[str, list[str]] = {}
    lines: dict[str, int] = {}
    number = ""
    for line, text in enumerate(source.text().splitlines(), 1):
        cells = [cell.strip() for cell in text.split(";")]
        if cells[0]:
            keys[cells[0]] = cells[1] if len(cells) > 1 else ""
            number = cells[0].removesuffix(".Data") if cells[0].endswith(".Data") else ""
        elif any(cells):
            if len(cells) != 3 or not number:
                raise InputError(f"{source.path}: line {line}", f"found {text.strip()!r}", "allowed: '; time; value'")
            lines.setdefault(number, line)
            samples.setdefault(number, []).append(text.partition(";")[2])
    flags = keys.get("Flags", "16")
    unit = "us" if _FLAGS.fullmatch(flags) and int(flags) & _MICROSECONDS else "ms"
    channels: list[Channel] = []
    for number, texts in samples.items():
        labels = (f"time [{unit}]", keys.get(f"{number}.Variable", f"variable {number}"))
        channels += read_timed(texts, lines[number], labels, ";", source.path)
    if not channels:
        raise InputError(source.path, "found no variable with data", "allowed: an export with recorded data")
    return _recording(CODESYS_CSV, source, channels, keys)


def _read_text(source: Source) -> Recording:
    text = source.text()
    header = _STAMPS.search(text)
    assert header is not None
    titles = [line.strip() for line in text[: header.start()].splitlines() if line.strip()]
    below = text[header.end() :].splitlines()[1:]
    if not any(line.strip() for line in below):
        raise no_samples(source)
    line = len(text[: header.end()].splitlines()) + 1
    channels = read_timed(below, line, (f"time [{header[1]}]", *header[2].split()), BLANKS, source.path)
    metadata = dict(zip(["title", "project"], titles, strict=False))
    return Recording(tuple(channels), CODESYS_TEXT.format, source.path, metadata, usual_units=LAB_UNITS)


def _refuse(source: Source) -> NoReturn:
    raise InputError(
        source.path,
        "found a Sinumerik frequency-response measurement, which contains no motion over time",
        "allowed: a recording of velocity or position and of current or torque over time",
    )


#: The trace editor's own file: `.trace`, or the same as `.xml`.
CODESYS_XML = FileFormat(
    "CODESYS / Machine Expert trace", (".trace", ".xml"), lambda s: _root_name(s) == "Trace", _read_xml
)
#: A header of `key; value` lines (`Flags` 16: times in ms, 32: us), then per variable `N.Variable; name`, further keys,
#: `N.Data;` and lines `; time; value`.
CODESYS_CSV = FileFormat("CODESYS / Machine Expert CSV export", (), shows(_EXPORT), _read_csv)
#: A title and the project's path, then `Timestamp(ms) VarA VarB` (German `Zeitstempel(ms)`).
CODESYS_TEXT = FileFormat("CODESYS / Machine Expert text export", (), shows(_STAMPS), _read_text)
SINUMERIK = FileFormat(
    "Sinumerik frequency response (refused)", (), lambda s: _root_name(s).startswith("ResponseTest"), _refuse
)


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
    comment = _UNITS_COMMENT + ", ".join(table.column_names[1:])
    for name, kind, value in (("Comment", "string", comment), ("MicroSeconds", "bool", str(not coarse))):
        ElementTree.SubElement(settings, "Single", Name=name, Type=kind).text = value
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
