"""Arrays under names, as channels: vectors, and the signals in the rows or columns of a matrix."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bench.trace.channel import Channel

#: Signals that a matrix may hold, beside its samples.
MOST_SIGNALS = 1000


def is_samples(value: object) -> bool:
    """Whether a value is an array of samples: numbers, moments or fields of them, in one or two dimensions."""
    if not isinstance(value, np.ndarray) or value.size < 2 or value.ndim > 2:
        return False
    return value.dtype.kind in "fiubmM" or (value.dtype.names is not None and value.ndim == 1)


def channels_of(name: str, value: np.ndarray, path: str, unit: str | None = None) -> Iterator[Channel]:
    """Channels of an array: `name`; of a matrix `name(:,1)` with a signal a column, `name(1,:)` with a signal a row.

    The longer side of a matrix is taken for its samples.
    """
    if value.dtype.names is not None:
        for field in value.dtype.names:
            if value[field].dtype.kind in "fiubmM" and value[field].ndim == 1:
                yield from channels_of(f"{name}.{field}" if name else field, value[field], path)
        return
    if value.ndim == 1 or 1 in value.shape:
        yield _channel(name, value.reshape(-1), path, unit)
        return
    by_rows = value.shape[0] < value.shape[1]
    signals = value if by_rows else value.T
    if signals.shape[0] > MOST_SIGNALS:
        return
    for number, signal in enumerate(signals, 1):
        yield _channel(f"{name}({number},:)" if by_rows else f"{name}(:,{number})", signal, path, unit)


def _channel(name: str, values: np.ndarray, path: str, unit: str | None) -> Channel:
    if values.dtype.kind in "mM":
        known = values[~np.isnat(values)]
        first = known[0] if known.size else values[0]
        passed = (values - first) / np.timedelta64(1, "ns") * 1e-9
        return Channel(name, "s", np.asarray(passed, dtype=np.float64), path, moments=True)
    return Channel(name, unit, np.ascontiguousarray(values, dtype=np.float64), path)
