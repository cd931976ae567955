"""Times of a clock or a calendar, as seconds from the first of them."""

from __future__ import annotations

import importlib
import re
from typing import Any

import numpy as np
import pyarrow as pa

from bench.arrays import Array

#: 2024-03-05T12:34:56.789+01:00, 05.03.2024 12:34:56,789, 12:34:56.789, 12:34:56:789, 1:34:56.7 PM, 34:56.7.
_MOMENT = (
    r"^\s*(?:(?P<date>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})[T ]+)?(?:(?P<hour>\d{1,2}):)?(?P<minute>\d{1,2}):"
    r"(?P<second>\d{2})(?:[.,:](?P<fraction>\d{1,12}))?\s*(?P<half>[AaPp]\.?[Mm]\.?)?\s*"
    r"(?P<zone>Z|UTC|[+-]\d{2}:?\d{2})?\s*$"
)
_PATTERN = re.compile(_MOMENT)
_DAY = 86400.0


def is_moment(text: str) -> bool:
    """Whether a text is a time of a clock or a calendar."""
    return _PATTERN.match(text) is not None


def compute() -> Any:  # noqa: ANN401
    """Arrow's functions, which take 0.05 s to import and are made then, so that checkers of types know none."""
    return importlib.import_module("pyarrow.compute")


def seconds(texts: pa.ChunkedArray) -> Array | None:
    """Seconds from the first moment - (n,), nan where a cell is empty; None where one is no moment.

    Dates are told apart, not read: they count days in the order in which they appear, so that it does not matter which
    of their numbers is the month. A clock without a date that falls back by most of a day has passed midnight.
    """
    pc = compute()
    column = texts.combine_chunks()
    column = column.chunk(0) if isinstance(column, pa.ChunkedArray) else column
    parts = pc.extract_regex(column, pattern=_MOMENT)
    empty = pc.equal(pc.utf8_trim_whitespace(column), "").to_numpy(zero_copy_only=False).astype(bool)
    unread = parts.is_null().to_numpy(zero_copy_only=False)
    if (unread & ~empty).any() or empty.all():
        return None
    fields = {
        name: pc.struct_field(parts, name) for name in ("date", "hour", "minute", "second", "fraction", "half", "zone")
    }
    clock = _number(fields["minute"]) * 60.0 + _number(fields["second"]) + _fraction(fields["fraction"])
    hour = _number(fields["hour"])
    half = np.char.upper(fields["half"].fill_null("").to_numpy(zero_copy_only=False).astype(str))
    hour = np.where(
        np.char.startswith(half, "P"), hour % 12 + 12, np.where(np.char.startswith(half, "A"), hour % 12, hour)
    )
    clock = clock + 3600.0 * hour - _offset(fields["zone"])
    dates = fields["date"].fill_null("").to_numpy(zero_copy_only=False).astype(str)
    known = ~empty
    if (dates[known] != "").all():
        _, first, inverse = np.unique(dates[known], return_index=True, return_inverse=True)
        order = np.empty(first.size)
        order[np.argsort(first)] = np.arange(first.size)
        clock[known] += _DAY * order[inverse]
    else:
        steps = np.diff(clock[known])
        clock[known] += _DAY * np.concatenate([[0.0], np.cumsum(steps < -0.5 * _DAY)])
    clock[empty] = np.nan
    return clock - clock[known][0]


def _number(texts: pa.Array) -> Array:
    pc = compute()
    filled = pc.if_else(pc.equal(texts.fill_null(""), ""), "0", texts.fill_null("0"))
    return pc.cast(filled, pa.float64()).to_numpy(zero_copy_only=False).copy()


def _fraction(texts: pa.Array) -> Array:
    pc = compute()
    digits = pc.binary_join_element_wise("0.", texts.fill_null(""), "0", "")
    return pc.cast(digits, pa.float64()).to_numpy(zero_copy_only=False)


def _offset(zones: pa.Array) -> Array:
    """Seconds by which the clocks of time zones are ahead of UTC."""
    texts = zones.fill_null("").to_numpy(zero_copy_only=False).astype(str)
    names, inverse = np.unique(texts, return_inverse=True)
    ahead = []
    for name in names:
        digits = name.replace(":", "")
        east = 3600.0 * int(digits[1:3]) + 60.0 * int(digits[3:5]) if digits[:1] in ("+", "-") else 0.0
        ahead.append(-east if digits.startswith("-") else east)
    return np.array(ahead)[inverse]
