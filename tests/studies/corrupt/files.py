"""Corruptions of files: of the bytes that a recording is kept in."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from scipy.io import savemat

from tests.hostile import csv_of

Columns = tuple[np.ndarray, np.ndarray, np.ndarray]


def as_csv(columns: Columns) -> bytes:
    return csv_of(*columns).encode()


def as_parquet(columns: Columns) -> bytes:
    names, kept = ("time [s]", "velocity [rad/s]", "current [A]"), io.BytesIO()
    pq.write_table(pa.table(dict(zip(names, columns, strict=True))), kept)
    return kept.getvalue()


def as_npz(columns: Columns) -> bytes:
    kept = io.BytesIO()
    np.savez(kept, **dict(zip(("time", "velocity", "current"), columns, strict=True)))
    return kept.getvalue()


def as_mat(columns: Columns) -> bytes:
    kept = io.BytesIO()
    savemat(kept, dict(zip(("time", "velocity", "current"), columns, strict=True)))
    return kept.getvalue()


#: Endings of files, and how they are made.
KEPT: dict[str, Callable[[Columns], bytes]] = {"csv": as_csv, "parquet": as_parquet, "npz": as_npz, "mat": as_mat}


def bit(rng: np.random.Generator, content: bytes) -> bytes:
    """One bit flipped."""
    changed = bytearray(content)
    changed[int(rng.integers(len(changed)))] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def cut(rng: np.random.Generator, content: bytes) -> bytes:
    """Ended early."""
    return content[: int(rng.integers(len(content) // 4, len(content)))]


def digits(count: int) -> Callable[[np.random.Generator, bytes], bytes]:
    """Some digits changed below the header."""

    def changed(rng: np.random.Generator, content: bytes) -> bytes:
        kept, head = bytearray(content), content.index(b"\n")
        places = [k for k in rng.integers(head, len(kept), 20 * count).tolist() if chr(kept[k]).isdigit()][:count]
        for place in places:
            kept[place] = ord("0") + int(rng.integers(10))
        return bytes(kept)

    return changed


def lines(change: Callable[[np.random.Generator, list[bytes]], list[bytes]]) -> Callable:
    """A change of the lines below the header."""

    def changed(rng: np.random.Generator, content: bytes) -> bytes:
        head, *rows = content.splitlines(keepends=True)
        return head + b"".join(change(rng, rows))

    return changed


def points_lost(rng: np.random.Generator, rows: list[bytes]) -> list[bytes]:
    """Decimal points of a row that are gone."""
    k = int(rng.integers(len(rows)))
    return [*rows[:k], rows[k].replace(b".", b""), *rows[k + 1 :]]


def one_less(rng: np.random.Generator, rows: list[bytes]) -> list[bytes]:
    """A cell that is gone from a row."""
    k = int(rng.integers(len(rows)))
    return [*rows[:k], rows[k].partition(b",")[2], *rows[k + 1 :]]


def twice(rng: np.random.Generator, rows: list[bytes]) -> list[bytes]:
    """A hundred rows that are written twice."""
    k = int(rng.integers(len(rows) - 100))
    return [*rows[: k + 100], *rows[k:]]


def gone(rng: np.random.Generator, rows: list[bytes]) -> list[bytes]:
    """A hundred rows that are gone."""
    k = int(rng.integers(len(rows) - 100))
    return [*rows[:k], *rows[k + 100 :]]


KINDS: dict[str, tuple[str, Callable[[np.random.Generator, bytes], bytes]]] = {
    **{f"{ending}: one bit flipped": (ending, bit) for ending in KEPT},
    **{f"{ending}: cut off": (ending, cut) for ending in KEPT},
    "csv: one digit changed": ("csv", digits(1)),
    "csv: fifty digits changed": ("csv", digits(50)),
    "csv: points of a row lost": ("csv", lines(points_lost)),
    "csv: a cell of a row lost": ("csv", lines(one_less)),
    "csv: rows written twice": ("csv", lines(twice)),
    "csv: rows lost": ("csv", lines(gone)),
}
