"""A long recording in chunks: Parquet in bounded memory, at about the speed at which Arrow reads it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow as pa

from bench.allocation import keep_freed_memory
from bench.arrays import Array
from bench.bounds import require_ratio
from bench.errors import InputError
from bench.files import opened
from bench.names import readable
from bench.trace.channel import Recording, with_units
from bench.trace.choose import ReadingOptions, choose, reading_options
from bench.trace.in_si import in_si
from bench.trace.read import read
from bench.trace.readers.arrow import DAMAGE, MAGIC, PARQUET, WIDTH, channel_of, is_moment
from bench.trace.readers.containers import reading
from bench.trace.trace import Trace, on_time_base
from bench.trace.wraps import Unwrapping

if TYPE_CHECKING:
    import pyarrow.parquet as pq

#: Samples of a chunk: few enough for the processor's cache, enough to make Python's overhead negligible.
CHUNK = 1 << 17
#: Deviation of the step from one chunk to the next, as share of the sample period, within which the second continues
#: the first.
JOINT = 0.01


def stream(
    path: str | Path, columns: Mapping[str, str] | ReadingOptions | None = None, chunk: int = CHUNK
) -> Iterator[Trace]:
    """Consecutive traces of at most `chunk` samples (one more at the end), which together are the recording.

    They do not overlap; `Trace.continues` is whether one follows the last without a hole. Of Parquet only columns
    that are signals are read, chunk by chunk; other formats are read whole and cut. In Parquet the time base is found
    for each chunk, so a recording with jitter is interpolated onto a regular base in each.

    Path and columns are as for `read`, which raises the same, here while iterating; a chunk has at least 2 samples.
    """
    how = reading_options(columns)
    if how.sample_period is None and _is_parquet(Path(path)):
        return _parquet(str(path), how, chunk)
    return cut(read(path, columns), chunk)


def _is_parquet(path: Path) -> bool:
    """Whether a file is Parquet of plain numbers: timestamps count from the first one, unknown to later chunks, and of
    lists there are more channels than columns.
    """
    try:
        with opened(path, "a trace") as file:
            parquet = readable(path) == str(path) and file.read(len(MAGIC)) == MAGIC  # Arrow opens UTF-8 names
        if not parquet:
            return False
        import pyarrow.parquet as pq  # 0.04 s, for one format of fifteen

        return not any(is_moment(kind) or pa.types.is_nested(kind) for kind in pq.read_schema(path).types)
    except (*DAMAGE, InputError, ValueError):
        return False  # `read` reports what is wrong with it


def _continues(last: Trace | None, time: Array, period: float, origin: str) -> bool:
    """Whether samples follow the last chunk without a hole; InputError where they begin before it has ended."""
    if last is None:
        return False
    step = float(time[0] - last.time[-1])
    if step <= 0.0:
        found = f"runs backwards ({last.time[-1]:g} s, then {time[0]:g} s)"
        raise InputError(f"{origin}: time", found, "allowed: increasing times")
    return abs(step - period) <= JOINT * period


def cut(trace: Trace, chunk: int = CHUNK) -> Iterator[Trace]:
    """The same for a recording in memory; see `stream`."""
    edges, last = [*range(0, max(len(trace) - 1, 1), chunk), len(trace)], None
    for start, stop in pairwise(edges):
        time = trace.time[start:stop]
        part = {name: values[start:stop] for name, values in trace.signals.items()}
        follows = _continues(last, time, trace.sample_period, trace.origin)
        last = replace(trace, time=time, signals=part, continues=follows)
        yield last


def _parquet(path: str, how: ReadingOptions, chunk: int) -> Iterator[Trace]:
    import pyarrow.parquet as pq

    keep_freed_memory()
    with (
        reading(path, PARQUET.format, DAMAGE),
        pq.ParquetFile(path, memory_map=True, page_checksum_verification=True) as file,
    ):
        fields = list(file.schema_arrow)
        head = next(file.iter_batches(CHUNK), pa.table([pa.nulls(0, one.type) for one in fields], pa.schema(fields)))
        columns = zip(fields, head.columns, strict=True)
        channels = with_units(tuple(channel_of(field, column, path) for field, column in columns))
        beginning = Recording(channels, PARQUET.format, readable(path))
        chosen, assumed = choose(beginning, how)
        field_of = {name: fields[beginning.channels.index(choice.channel)] for name, choice in chosen.items()}
        require_ratio(path, file.metadata.num_rows * len(field_of) * WIDTH, Path(path).stat().st_size)
        start, last = 0, None
        wrapping: dict[str, Unwrapping] = {}
        for batch in _batches(file, [field.name for field in field_of.values()], chunk):
            pieces = {
                name: replace(choice, channel=channel_of(field_of[name], batch[field_of[name].name], path, start))
                for name, choice in chosen.items()
            }
            notes = list(assumed)
            part = on_time_base(in_si(pieces, beginning, how, notes, wrapping), chosen, beginning, notes)
            last = replace(part, continues=_continues(last, part.time, part.sample_period, part.origin))
            yield last
            start += batch.num_rows


def _batches(file: pq.ParquetFile, names: list[str], chunk: int) -> Iterator[pa.RecordBatch]:
    """Batches of at least two rows: the last one takes a single row that would remain."""
    held: pa.RecordBatch | None = None
    for batch in file.iter_batches(chunk, columns=names):
        if held is not None and batch.num_rows > 1:
            yield held
            held = batch
        else:
            held = batch if held is None else pa.concat_batches([held, batch])
    if held is not None:
        yield held
