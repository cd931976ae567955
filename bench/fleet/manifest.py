"""The manifest of a fleet: which recordings there are, of which axis, by which rig, and when they were made."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as csv
import pyarrow.parquet as pq

from bench.arrays import Array
from bench.errors import InputError
from bench.files import read_bytes

#: Columns that a manifest must have; `axis` is the rig and `time` unknown where it has none.
REQUIRED = ("file", "rig")
_MAGIC = b"PAR1"


@dataclass(frozen=True)
class Manifest:
    """Recordings of a fleet.

    Attributes:
        path: of the manifest.
        table: as the manifest has it, with columns `axis` and `time` added where it has none (n,).
    """

    path: Path
    table: pa.Table

    def __len__(self) -> int:
        return self.table.num_rows

    def text(self, column: str) -> list[str]:
        """A column as text (n,); empty where there is nothing."""
        return [value or "" for value in self.table[column].cast(pa.string()).to_pylist()]

    def located(self, column: str) -> list[str]:
        """Paths and URLs of `file` or `rig` (n,): a relative path begins at the manifest's folder."""
        folder = self.path.parent
        return [named if "://" in named else str(folder / named) for named in self.text(column)]

    @property
    def times(self) -> Array:
        """When each was recorded (n,) - s, or what the manifest counts in; nan where it does not say."""
        column = self.table["time"].combine_chunks()
        if pa.types.is_temporal(column.type):
            column = pc.cast(pc.cast(column, pa.timestamp("us")), pa.int64())
        return column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)


def read_manifest(path: Path) -> Manifest:
    """Read and check a manifest, CSV or Parquet.

    Raises:
        InputError: it cannot be read, has no recording, a column is missing or twice, or a cell is empty or no time.
    """
    content = read_bytes(path, "a manifest, CSV or Parquet")
    try:
        table = pq.read_table(io.BytesIO(content)) if content.startswith(_MAGIC) else _of_csv(content)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        told = str(error).splitlines()[0]
        raise InputError(path, f"found no table ({told})", "allowed: a manifest, CSV or Parquet") from error
    names = table.column_names
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise InputError(f"{path}: {double}", "found this column twice", "allowed: each column once")
    for name in REQUIRED:
        if name not in names:
            found = f"found the columns {', '.join(names) or 'none'}"
            raise InputError(
                path, found, f"allowed: {', '.join(REQUIRED)}, axis, time and any others; {name} is missing"
            )
        _require_filled(path, table, name)
    if not table.num_rows:
        raise InputError(path, "found no recording", "allowed: a row for each")
    table = table if "axis" in names else table.append_column("axis", table["rig"])
    table = table if "time" in names else table.append_column("time", pa.nulls(table.num_rows, pa.float64()))
    return Manifest(path, _timed(path, table))


def _of_csv(content: bytes) -> pa.Table:
    """Columns with the types that their values have; numbers that would change, as 007 does, stay text."""
    named = csv.ConvertOptions(column_types={name: pa.string() for name in ("file", "rig", "axis")})
    table = csv.read_csv(io.BytesIO(content), convert_options=named)
    every = csv.ConvertOptions(column_types={name: pa.string() for name in table.column_names})
    text = csv.read_csv(io.BytesIO(content), convert_options=every)
    for place, field in enumerate(table.schema):
        column = text[field.name]
        if pa.types.is_integer(field.type) and not table[field.name].cast(pa.string()).equals(column):
            table = table.set_column(place, field.name, column)
    return table


def _require_filled(path: Path, table: pa.Table, name: str) -> None:
    """InputError naming the row if a cell of a column is empty, or holds no text."""
    column = table[name]
    if not (pa.types.is_string(column.type) or pa.types.is_large_string(column.type)):
        raise InputError(f"{path}: {name}", f"found values of type {column.type}", "allowed: text")
    empty = np.flatnonzero([not value for value in column.to_pylist()])
    if empty.size:
        raise InputError(f"{path}: row {empty[0] + 1}: {name}", "found nothing", f"allowed: a {name} in every row")


def _timed(path: Path, table: pa.Table) -> pa.Table:
    """The table with times as moments or numbers."""
    kind = table["time"].type
    if pa.types.is_null(kind):
        return table.set_column(table.column_names.index("time"), "time", table["time"].cast(pa.float64()))
    if pa.types.is_temporal(kind) or pa.types.is_integer(kind) or pa.types.is_floating(kind):
        return table
    example = next((value for value in table["time"].to_pylist() if value is not None), None)
    raise InputError(f"{path}: time", f"found {example!r}", "allowed: ISO 8601 (2026-03-01T12:00:00), or a number")
