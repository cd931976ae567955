"""Columns of text into Arrow at its speed."""

from __future__ import annotations

import pyarrow as pa
from pyarrow import csv


def parse_columns(
    body: bytes | memoryview, kinds: list[pa.DataType], separator: str, decimal: str, nulls: tuple[str, ...] = ()
) -> pa.Table:
    """Lines of cells as columns named 0, 1, ... of the types given.

    Raises:
        pa.ArrowInvalid: a line with another count of cells, or a cell that is not of that type.
    """
    types = {str(number): kind for number, kind in enumerate(kinds)}
    return csv.read_csv(
        pa.py_buffer(body),
        read_options=csv.ReadOptions(column_names=list(types)),
        parse_options=csv.ParseOptions(delimiter=separator, quote_char='"'),
        convert_options=csv.ConvertOptions(
            column_types=types, null_values=list(nulls), strings_can_be_null=False, decimal_point=decimal
        ),
    )
