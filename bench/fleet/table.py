"""The fleet's table: a row for each recording, in the manifest's order; the same bytes whenever the results are."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from bench.errors import InputError
from bench.files import whole
from bench.fleet.manifest import Manifest
from bench.fleet.plan import Planned
from bench.fleet.recording import Plain

#: Of the gaps of torque (force) and velocity.
_GAP = ("after", "before", "noise_floor", "unit")


def tabulate(manifest: Manifest, planned: Sequence[Planned], results: Sequence[Plain]) -> pa.Table:
    """The manifest's columns, and behind them what was found (n rows).

    Raises:
        InputError: the manifest has a column of a name that the table needs.
    """
    columns = {
        "status": pa.array([found["status"] for found in results], pa.string()),
        "reason": pa.array([found["reason"] for found in results], pa.string()),
        **_parameters(results),
        "verdict": _texts(found.get("verdict") for found in results),
        "names": pa.array([_names(found) for found in results], pa.list_(pa.string())),
        "explained": _numbers(found.get("explained") for found in results),
        **_gaps(results),
        "checks": pa.array([_checks(found) for found in results], pa.list_(pa.string())),
        **_provenance(planned, results),
    }
    taken = next((name for name in manifest.table.column_names if name in columns), None)
    if taken is not None:
        found = "found a column that the fleet's table has too"
        raise InputError(f"{manifest.path}: {taken}", found, "allowed: another name for it")
    table = manifest.table.replace_schema_metadata(None)
    for name, column in columns.items():
        table = table.append_column(name, column)
    return table.combine_chunks()


def write_table(path: Path, table: pa.Table) -> None:
    """Write it as Parquet, whole or not at all.

    Raises:
        InputError: the place cannot be written to.
    """
    with whole(path) as temporary:
        pq.write_table(table, temporary)


def _parameters(results: Sequence[Plain]) -> dict[str, pa.Array]:
    """Value, standard error and unit of each parameter that any recording tells."""
    columns: dict[str, pa.Array] = {}
    tables = [found.get("parameters", {}) for found in results]
    for name in dict.fromkeys(name for one in tables for name in one):
        columns[name] = _numbers(one.get(name, {}).get("value") for one in tables)
        columns[f"{name}_std_error"] = _numbers(one.get(name, {}).get("std_error") for one in tables)
        columns[f"{name}_unit"] = _texts(one.get(name, {}).get("unit") for one in tables)
    return columns


def _gaps(results: Sequence[Plain]) -> dict[str, pa.Array]:
    """What is left, what was before effects were added, and what noise alone leaves."""
    columns = {}
    for of in ("torque", "velocity"):
        gaps = [found.get("gap", {}).get(of, {}) for found in results]
        for name in _GAP:
            values = (gap.get(name) for gap in gaps)
            columns[f"gap_{of}" if name == "after" else f"gap_{of}_{name}"] = (
                _texts(values) if name == "unit" else _numbers(values)
            )
    return columns


def _provenance(planned: Sequence[Planned], results: Sequence[Plain]) -> dict[str, pa.Array]:
    return {
        "version": _texts(one.basis["version"] for one in planned),
        "rig_sha256": _texts(one.basis["rig_sha256"] for one in planned),
        "trace_sha256": _texts(found.get("trace_sha256") for found in results),
        "options": _texts(json.dumps(one.basis["options"], sort_keys=True) for one in planned),
        "result": _texts(one.key or None for one in planned),
    }


def _names(found: Mapping[str, Any]) -> list[str] | None:
    """Of the effects; None where none were sought."""
    return [effect["name"] for effect in found["effects"]] if "effects" in found else None


def _checks(found: Mapping[str, Any]) -> list[str]:
    """Names of those that did not pass."""
    return [check["name"] for check in found.get("checks", [])]


def _numbers(values: Any) -> pa.Array:  # noqa: ANN401
    return pa.array(list(values), pa.float64())


def _texts(values: Any) -> pa.Array:  # noqa: ANN401
    return pa.array(list(values), pa.string())
