"""A Machine Expert trace (CODESYS V3 trace editor): UTF-16 XML with byte order mark, values and times per variable."""

from __future__ import annotations

import codecs
from xml.etree import ElementTree

import numpy as np
import pyarrow as pa

from bench.trace.channel import split_label
from bench.trace.readers.codesys_xml import UNITS_COMMENT
from bench.units import convert


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
    _single(settings, "Comment", "string", UNITS_COMMENT + ", ".join(table.column_names[1:]))
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
