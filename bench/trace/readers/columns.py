"""Columns of text into Arrow at its speed."""

from __future__ import annotations

import pyarrow as pa
from pyarrow import csv


def parse_columns(
    body: bytes, count: int, separator: str, decimal: str, kind: pa.DataType | None = None, nulls: tuple[str, ...] = ()
) -> pa.Table:
    """Lines of `count` cells each as columns named 0, 1, ... of type `kind` (float64 unless given).

    Raises:
        pa.ArrowInvalid: a line with another count of cells, or a cell that is not of that type.
    """
    types = dict.fromkeys([str(number) for number in range(count)], kind or pa.float64())
    return csv.read_csv(
        pa.py_buffer(body),
        read_options=csv.ReadOptions(column_names=list(types)),
        parse_options=csv.ParseOptions(delimiter=separator, quote_char='"'),
        convert_options=csv.ConvertOptions(
            column_types=types, null_values=list(nulls), strings_can_be_null=False, decimal_point=decimal
        ),
    )
