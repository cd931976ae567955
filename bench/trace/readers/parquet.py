"""Reader of Parquet: unit in the column's name `velocity [deg/s]` or in its field metadata under `unit`."""

from __future__ import annotations

import pyarrow as pa

from bench.bounds import require_expansion
from bench.errors import InputError
from bench.trace.channel import Recording
from bench.trace.readers.columns import channel_of, is_numeric
from bench.trace.readers.containers import reading
from bench.trace.source import Source

MAGIC = b"PAR1"
#: What Arrow raises on a damaged file.
DAMAGE = (pa.ArrowException, OSError, UnicodeDecodeError)
#: Bytes of a value once it is read.
WIDTH = 8


class Parquet:
    """Parquet, see the module."""

    format = "Parquet"
    endings = (".parquet", ".pq")

    def recognises(self, source: Source) -> bool:
        """Whether the file begins as Parquet does."""
        return source.content.startswith(MAGIC)

    def read(self, source: Source) -> Recording:
        """Recording of a Parquet file.

        Raises:
            InputError: truncated, damaged, or without rows.
        """
        import pyarrow.parquet as pq  # 0.04 s, for one format of fifteen

        with reading(source.path, self.format, DAMAGE), pq.ParquetFile(pa.BufferReader(source.content)) as file:
            fields = list(file.schema_arrow)
            wanted = [number for number, field in enumerate(fields) if is_numeric(field.type)]
            rows = file.metadata.num_rows
            require_expansion(source.path, rows * len(wanted) * WIDTH, len(source.content))
            table = file.read(None if len(wanted) == len(fields) else [fields[number].name for number in wanted])
        if not rows:
            raise InputError(source.path, "found columns and no rows", "allowed: at least two samples")
        columns = iter(table.columns)
        channels = tuple(
            channel_of(field, next(columns) if is_numeric(field.type) else pa.nulls(0, field.type), source.path)
            for field in fields
        )
        return Recording(channels, self.format, source.path)
