"""Reader of logs in JSON: a line for each sample, a list of samples, or an object of columns.

Lists of a number for each joint are channels by their place, or by the names in a list of as many texts beside them, as
a ROS joint state has it; what holds fields is `parent.field`.
"""

from __future__ import annotations

import json

import pyarrow as pa
import pyarrow.json

from bench.bounds import require_expansion
from bench.errors import InputError
from bench.structured import parse_json
from bench.trace.channel import Recording
from bench.trace.readers.arrow import DAMAGE, WIDTH, channels_of_table
from bench.trace.readers.containers import reading
from bench.trace.source import FileFormat, Source


def _recognises(source: Source) -> bool:
    """Whether it begins with an object of JSON: in a list, with a list in it, or whole in the first line of several."""
    head = source.head.lstrip()
    if head.startswith("["):
        return head[1:].lstrip().startswith("{")
    return head.startswith("{") and ("[" in head or _has_lines(source))


def _has_lines(source: Source) -> bool:
    first, _, rest = source.head.lstrip().partition("\n")
    try:
        return rest.lstrip().startswith("{") and isinstance(json.loads(first), dict)
    except (ValueError, RecursionError):
        return False


def _read(source: Source) -> Recording:
    allowed = "allowed: a line or an object for each sample, or a list for each column"
    with reading(source.path, JSON_LOG.format, DAMAGE):
        if _has_lines(source):
            options = pyarrow.json.ReadOptions(block_size=min(len(source.content) + 1, 2**31 - 1))
            table = pyarrow.json.read_json(pa.py_buffer(source.content), read_options=options)
        else:
            content = parse_json(source.text(), source.path)
            if isinstance(content, dict):
                lists = {name: value for name, value in content.items() if isinstance(value, list) and len(value) > 1}
                content = [dict(zip(lists, row, strict=True)) for row in zip(*lists.values(), strict=False)]
            if not isinstance(content, list) or not content or not all(isinstance(row, dict) for row in content):
                raise InputError(source.path, "found no samples", allowed)
            table = pa.Table.from_pylist(content)
    require_expansion(source.path, table.nbytes, len(source.content) * WIDTH)
    return Recording(tuple(channels_of_table(table, source.path)), JSON_LOG.format, source.path)


JSON_LOG = FileFormat("JSON log", (".jsonl", ".ndjson", ".json"), _recognises, _read)
