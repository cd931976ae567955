"""The manifest of a fleet: which recordings there are, of which axis, by which rig, and when they were made."""

from __future__ import annotations

import io
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.csv as csv
import pyarrow.parquet as pq

from bench.arrays import Array
from bench.errors import InputError
from bench.files import read_bytes
from bench.rig.rig import shipped

#: Columns that a manifest must have; `axis` is the rig and `time` unknown where it has none.
REQUIRED = ("file", "rig")
_MAGIC = b"PAR1"


@dataclass(frozen=True)
class Manifest:
    """Recordings of a fleet: the table of a manifest, with columns `axis` and `time` added where it has none (n,)."""

    path: Path
    table: pa.Table

    def __len__(self) -> int:
        return self.table.num_rows

    def text(self, column: str) -> list[str]:
        """A column as text (n,); empty where there is nothing."""
        return [value or "" for value in self.table[column].cast(pa.string()).to_pylist()]

    def located(self, column: str) -> list[str]:
        """Paths and URLs of `file` or `rig` (n,): a file of the manifest's folder, or a shipped rig by its name."""
        known, places = shipped() if column == "rig" else {}, []
        for named in self.text(column):
            named = named.removeprefix("file://")
            path = self.path.parent / named
            if named in known and not os.path.lexists(path):
                path = known[named]
            places.append(named if "://" in named else str(path))
        return places

    @property
    def inputs(self) -> list[Path]:
        """Every file on this machine that a fleet reads."""
        named = {*self.located("file"), *self.located("rig")}
        return [self.path, *(Path(one) for one in sorted(named) if "://" not in one)]

    @property
    def dated(self) -> bool:
        """Whether times are moments rather than numbers."""
        return pa.types.is_temporal(self.table["time"].type)

    @property
    def times(self) -> Array:
        """When each was recorded (n,) - s, or what the manifest counts in; nan where it is not given."""
        column = self.table["time"].combine_chunks()
        if self.dated:
            microseconds = column.cast(pa.timestamp("us"), safe=False).cast(pa.int64())
            return 1e-6 * microseconds.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
        return column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)


def read_manifest(path: Path) -> Manifest:
    """Read and check a manifest, CSV or Parquet.

    InputError: it cannot be read, has no recording, a column is missing or twice, or a cell is empty or no time.
    """
    content = read_bytes(path, "a manifest, CSV or Parquet")
    try:
        table = pq.read_table(io.BytesIO(content)) if content.startswith(_MAGIC) else _of_csv(content)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(path, f"found no table ({reason})", "allowed: a manifest, CSV or Parquet") from error
    for place, field in enumerate(table.schema):
        if pa.types.is_dictionary(field.type):  # as data frames keep categories
            table = table.set_column(place, field.name, table.column(place).cast(field.type.value_type))
    names = table.column_names
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise InputError(f"{path}: {double}", "found this column twice", "allowed: each column once")
    for name in REQUIRED:
        if name not in names:
            allowed = f"allowed: {', '.join(REQUIRED)}, axis, time and any others; {name} is missing"
            raise InputError(path, f"found the columns {', '.join(names) or 'none'}", allowed)
        _require_text(path, table, name)
        empty = next((row for row, value in enumerate(table[name].to_pylist(), 1) if not value), None)
        if empty is not None:
            raise InputError(f"{path}: row {empty}: {name}", "found nothing", f"allowed: a {name} in every row")
    if not table.num_rows:
        raise InputError(path, "found no recording", "allowed: a row for each")
    if "axis" in names:
        _require_text(path, table, "axis")
    else:
        table = table.append_column("axis", table["rig"])
    table = table if "time" in names else table.append_column("time", pa.nulls(table.num_rows, pa.float64()))
    return Manifest(path, _timed(path, table))


def _of_csv(content: bytes) -> pa.Table:
    """Columns with the types that their values have; numbers that would change, as 007 does, stay text."""
    header = content.partition(b"\n")[0]
    layout = csv.ParseOptions(delimiter=";" if header.count(b";") > header.count(b",") else ",")

    def read(names: Iterable[str], empty: bool = False) -> pa.Table:
        texts = csv.ConvertOptions(column_types={name: pa.string() for name in names}, strings_can_be_null=empty)
        return csv.read_csv(io.BytesIO(content), parse_options=layout, convert_options=texts)

    table = read(("file", "rig", "axis"))
    text = read(table.column_names, empty=True)
    for place, field in enumerate(table.schema):
        column = text.column(place)
        if pa.types.is_integer(field.type) and not table.column(place).cast(pa.string()).equals(column):
            table = table.set_column(place, field.name, column)
    return table


def _require_text(path: Path, table: pa.Table, name: str) -> None:
    """InputError if a column contains anything but text."""
    kind = table[name].type
    if not (pa.types.is_string(kind) or pa.types.is_large_string(kind)):
        raise InputError(f"{path}: {name}", f"found values of type {kind}", "allowed: text")


def _timed(path: Path, table: pa.Table) -> pa.Table:
    """The table with times as moments or numbers."""
    column, kind = table["time"], table["time"].type
    if pa.types.is_null(kind):
        return table.set_column(table.column_names.index("time"), "time", column.cast(pa.float64()))
    kinds = (pa.types.is_timestamp, pa.types.is_date, pa.types.is_integer, pa.types.is_floating)
    if any(is_one(kind) for is_one in kinds):
        return table
    example = next((value for value in column.to_pylist() if value is not None), None)
    raise InputError(f"{path}: time", f"found {example!r}", "allowed: ISO 8601 (2026-03-01T12:00:00), or a number")
