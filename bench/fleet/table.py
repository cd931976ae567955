"""The fleet's table: a row for each recording, in the manifest's order; the same bytes whenever the results are."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from bench.errors import InputError
from bench.files import whole
from bench.fleet.evaluate import Plain
from bench.fleet.manifest import Manifest
from bench.fleet.plan import PlannedRecording

NUMBER, TEXT, TEXTS = pa.float64(), pa.string(), pa.list_(pa.string())
#: Of each parameter, by what follows its name; and of the gaps of torque (force) and velocity.
OF_PARAMETER = {"": ("value", NUMBER), "_std_error": ("std_error", NUMBER), "_unit": ("unit", TEXT)}
OF_GAP = {"": "after", "_before": "before", "_noise_floor": "noise_floor", "_unit": "unit"}


def tabulate(manifest: Manifest, planned: Sequence[PlannedRecording], results: Sequence[Plain]) -> pa.Table:
    """The manifest's columns, and behind them what was found (n rows).

    Raises:
        InputError: the manifest has a column of a name that the table needs.
    """
    table = manifest.table.replace_schema_metadata(None)
    for name, kind, values in _columns(planned, results):
        if name in manifest.table.column_names:
            found = "found a column that the fleet's table has too"
            raise InputError(f"{manifest.path}: {name}", found, "allowed: another name for it")
        table = table.append_column(name, pa.array(values, kind))
    return table.combine_chunks()


def _columns(
    planned: Sequence[PlannedRecording], results: Sequence[Plain]
) -> Iterator[tuple[str, pa.DataType, list[Any]]]:
    """Name, type and values (n,) of each column; empty where a result tells nothing of it."""
    for name in ("status", "reason"):
        yield name, TEXT, [found[name] for found in results]
    parameters = [found.get("parameters", {}) for found in results]
    for name in dict.fromkeys(name for one in parameters for name in one):  # that any recording tells
        for ending, (key, kind) in OF_PARAMETER.items():
            yield name + ending, kind, [one.get(name, {}).get(key) for one in parameters]
    yield "verdict", TEXT, [found.get("verdict") for found in results]
    effects = [found.get("effects") for found in results]  # None where none were sought
    yield "names", TEXTS, [None if one is None else [effect["name"] for effect in one] for one in effects]
    yield "explained", NUMBER, [found.get("explained") for found in results]
    for of in ("torque", "velocity"):
        gaps = [found.get("gap", {}).get(of, {}) for found in results]
        for ending, key in OF_GAP.items():
            yield f"gap_{of}{ending}", TEXT if key == "unit" else NUMBER, [gap.get(key) for gap in gaps]
    yield "checks", TEXTS, [[check["name"] for check in found.get("checks", [])] for found in results]
    yield "version", TEXT, [one.basis["version"] for one in planned]
    yield "rig_sha256", TEXT, [one.basis["rig_sha256"] for one in planned]
    yield "trace_sha256", TEXT, [found.get("trace_sha256") for found in results]
    yield "options", TEXT, [json.dumps(one.basis["options"], sort_keys=True) for one in planned]
    yield "result", TEXT, [one.key or None for one in planned]


def write_table(path: Path, table: pa.Table) -> None:
    """Write it as Parquet, whole or not at all.

    Raises:
        InputError: the place cannot be written to.
    """
    with whole(path) as temporary:
        pq.write_table(table, temporary)
