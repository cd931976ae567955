"""A recording in the formats that are read, and a bit of it flipped."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from functools import partial

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from asammdf import MDF, Signal
from mcap.writer import CompressionType, Writer
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from tests.hostile import csv_of

Columns = tuple[np.ndarray, np.ndarray, np.ndarray]


def written(write: Callable[[io.BytesIO], object]) -> bytes:
    """What something writes into a file."""
    kept = io.BytesIO()
    write(kept)
    return kept.getvalue()


def as_csv(columns: Columns) -> bytes:
    return csv_of(*columns).encode()


def as_parquet(columns: Columns, checksums: bool = False) -> bytes:
    table = pa.table(dict(zip(("time [s]", "velocity [rad/s]", "current [A]"), columns, strict=True)))
    return written(lambda file: pq.write_table(table, file, use_dictionary=False, write_page_checksum=checksums))


def named(columns: Columns) -> dict[str, np.ndarray]:
    return dict(zip(("time", "velocity", "current"), columns, strict=True))


def as_hdf5(columns: Columns, checksums: bool = False) -> bytes:
    kept = io.BytesIO()
    with h5py.File(kept, "w") as file:
        for name, values in named(columns).items():
            file.create_dataset(name, data=values, chunks=values.shape, fletcher32=checksums)
    return kept.getvalue()


def as_mdf4(columns: Columns) -> bytes:
    kept, units = io.BytesIO(), {"velocity": "rad/s", "current": "A"}
    with MDF(version="4.10") as file:
        file.append([Signal(named(columns)[name], columns[0], name=name, unit=unit) for name, unit in units.items()])
        file.save(kept)
    return kept.getvalue()


def as_tdms(columns: Columns) -> bytes:
    kept = io.BytesIO()
    with TdmsWriter(kept) as writer:
        writer.write_segment([ChannelObject("axis", name, values) for name, values in named(columns).items()])
    return kept.getvalue()


def as_mcap(columns: Columns, checksums: bool = True) -> bytes:
    kept = io.BytesIO()
    writer = Writer(kept, compression=CompressionType.NONE, enable_crcs=checksums, enable_data_crcs=checksums)
    writer.start()
    channel = writer.register_channel(topic="axis", message_encoding="json", schema_id=0)
    for time, velocity, current in zip(*columns, strict=True):
        message = json.dumps({"velocity": velocity, "current": current}).encode()
        writer.add_message(channel, log_time=round(1e9 * time), publish_time=0, data=message)
    writer.finish()
    return kept.getvalue()


#: Endings of files, and how they are made; some with sums by which a reader sees that a bit has flipped.
KEPT: dict[str, Callable[[Columns], bytes]] = {
    "csv": as_csv,
    "parquet": as_parquet,
    "npz": lambda columns: written(lambda file: np.savez(file, **named(columns))),
    "npy": lambda columns: written(
        lambda file: np.save(file, np.rec.fromarrays(columns, names="time,velocity,current"))
    ),
    "mat": lambda columns: written(lambda file: savemat(file, named(columns))),
    "h5": as_hdf5,
    "mf4": as_mdf4,
    "tdms": as_tdms,
    "mcap": as_mcap,
}
SUMMED = {"parquet with sums": partial(as_parquet, checksums=True), "h5 with sums": partial(as_hdf5, checksums=True)}
SUMMED |= {"mcap without sums": partial(as_mcap, checksums=False)}
#: Signals of formats whose times are no column.
PLAIN = {"time": "time [s]", "velocity": "velocity [rad/s]", "current": "current [A]"}
COLUMNS = {
    "mcap": {"velocity": "axis.velocity [rad/s]", "current": "axis.current [A]"},
    "mf4": {"velocity": "velocity", "current": "current"},
}


def bit(rng: np.random.Generator, content: bytes) -> bytes:
    """One bit flipped."""
    changed = bytearray(content)
    changed[int(rng.integers(len(changed)))] ^= 1 << int(rng.integers(8))
    return bytes(changed)
