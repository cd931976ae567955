"""Containers from strangers: what expands is bounded, whatever their libraries would do; no formula of a file runs."""

import json
import struct
import zlib
from pathlib import Path

import h5py
import lz4.frame
import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
import zstandard
from asammdf import MDF, Signal
from mcap.writer import CompressionType, Writer
from nptdms import ChannelObject, TdmsWriter

from bench.bounds import bounded
from bench.errors import InputError
from bench.trace.read import read, read_recording
from bench.trace.readers.containers import unpack
from tests.hostile import cpu_seconds, run
from tests.trace import formats

TIME = np.arange(400) * 2e-3
#: A bound that keeps these tests short, and more than it allows.
BOUND, MUCH = "4 MB", 6 << 20


def mcap(path, messages, compression=CompressionType.ZSTD):
    with path.open("wb") as file:
        writer = Writer(file, compression=compression, chunk_size=2 * MUCH)
        writer.start()
        channel = writer.register_channel(topic="/axis", message_encoding="json", schema_id=0)
        for at, message in messages:
            writer.add_message(channel, log_time=at, publish_time=at, data=message)
        writer.finish()
    return path


def mdf_bomb(path):
    with MDF(version="4.10") as file:
        file.append([Signal(np.zeros(MUCH // 8), np.zeros(MUCH // 8), name="w", unit="rad/s")])
        file.save(path, overwrite=True, compression=1)
    return path


def hdf5_bomb(path):
    with h5py.File(path, "w") as file:
        file.create_dataset("w", (MUCH // 8,), dtype="f8", chunks=(1 << 16,), compression="gzip")
    return path


def zeros(count):
    return b"[" + b"0," * count + b"0]"


BOMBS = {
    "zstd.mcap": lambda path: mcap(path, [(0, zeros(MUCH // 2))]),
    "lz4.mcap": lambda path: mcap(path, [(0, zeros(MUCH // 2))], CompressionType.LZ4),
    "numbers.mcap": lambda path: mcap(path, [(k, zeros(255)) for k in range(800)]),  # of two bytes, three of eight
    "zip.mf4": mdf_bomb,
    "zip.h5": hdf5_bomb,
}


@pytest.mark.parametrize("name", BOMBS)
def test_what_a_container_expands_to_is_bounded(tmp_path, name):
    path = BOMBS[name](tmp_path / name)
    assert path.stat().st_size < MUCH / 20
    with bounded(BOUND), pytest.raises(InputError, match=r"expands to .*allowed: .*--max-size"):
        read_recording(path)


def test_a_length_that_a_file_does_not_hold_is_reported(tmp_path):
    """npTDMS' own warning is a note, and no line of its own on standard error."""
    path = tmp_path / "run.tdms"
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([ChannelObject("axis", "w", np.zeros(64))])
    path.write_bytes(path.read_bytes().replace(struct.pack("<Q", 64), struct.pack("<Q", 1 << 40), 1))
    recording = read_recording(path)
    assert recording.channels[0].values.size == 64 and "not a multiple of the chunk size" in recording.notes[0]
    done = run("inspect", "run.tdms", cwd=tmp_path)
    assert done.stderr == "" and "not a multiple" in done.stdout


@pytest.mark.parametrize("compression", list(CompressionType))
def test_chunks_are_read_in_the_order_of_the_log(tmp_path, compression):
    rng = np.random.default_rng(0)
    speed = np.sin(9.0 * TIME)
    messages = [(round(1e9 * TIME[k]), json.dumps({"w": speed[k]}).encode()) for k in rng.permutation(TIME.size)]
    trace = read(mcap(tmp_path / "run.mcap", messages, compression), {"velocity": "/axis.w [rad/s]"})
    np.testing.assert_allclose(trace.time, TIME, atol=1e-9)
    np.testing.assert_array_equal(trace["velocity"], speed)


def test_an_option_reads_it_all_the_same(tmp_path):
    with bounded("4 GB"):
        (channel,) = read_recording(hdf5_bomb(tmp_path / "x.h5")).channels
        assert channel.values.size == MUCH // 8


@pytest.mark.parametrize("pack", [zlib.compress, zstandard.compress, lz4.frame.compress])
def test_a_block_holds_no_more_than_it_declares(pack):
    content = bytes(range(256)) * 8
    assert unpack(pack(content), len(content)) == content
    with pytest.raises(ValueError, match="more than the 100 bytes"):
        unpack(pack(content), 100)
    with pytest.raises(ValueError, match="unknown way"):
        unpack(b"\0" + pack(content), len(content))


def test_a_zip_of_mdf_that_lies_is_damaged(tmp_path):
    """A block that declares a tenth of what comes out of it."""
    path = mdf_bomb(tmp_path / "x.mf4")
    content = bytearray(path.read_bytes())
    at = content.index(b"##DZ")
    declared = struct.unpack_from("<Q", content, at + 32)[0]
    struct.pack_into("<Q", content, at + 32, declared // 10)
    path.write_bytes(content)
    with pytest.raises(InputError, match="more than the"), bounded("4 GB"):
        read_recording(path)


@pytest.mark.parametrize("version", ["4.10", "3.30"])
def test_a_formula_in_a_measurement_is_not_evaluated(tmp_path, monkeypatch, version):
    """asammdf would hand it to numexpr and, where that refuses, to sympy, which runs any Python in it."""
    monkeypatch.chdir(tmp_path)
    formula = "__import__('pathlib').Path('ran').touch()"
    path = tmp_path / ("run.mf4" if version >= "4" else "run.mdf")
    with MDF(version=version) as file:
        bad = Signal(TIME.astype("i4"), TIME, name="bad", unit="V", conversion={"formula": formula})
        file.append([bad, Signal(np.sin(TIME), TIME, name="w", unit="rad/s")])
        file.save(path, overwrite=True)
    recording = read_recording(path)
    assert not Path("ran").exists()
    assert [channel.name for channel in recording.channels] == ["w"]
    assert recording.notes == ("bad left out: its conversion is a formula, which is not evaluated",)


def test_hdf5_is_of_one_file_and_each_dataset_read_once(tmp_path):
    """Raw data in another file, and two links a group to the next: 2**40 ways to one dataset."""
    (tmp_path / "secret").write_bytes(np.arange(400.0).tobytes())
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file.create_dataset("secret", (400,), dtype="f8", external=[("secret", 0, 3200)])
        layout = h5py.VirtualLayout(shape=(400,), dtype="f8")
        layout[:] = h5py.VirtualSource("other.h5", "w", shape=(400,))
        file.create_virtual_dataset("elsewhere", layout)
        inner = file.create_group("g0")
        for _ in range(40):
            deeper = inner.create_group("a")
            inner["b"] = deeper
            inner = deeper
        inner["w"] = np.sin(TIME)
        inner["round"] = file["g0"]
    (channel,) = read_recording(tmp_path / "run.h5").channels
    assert channel.name.endswith(".a.w") and np.array_equal(channel.values, np.sin(TIME))


MANY = {f"d{k}": np.arange(4.0) for k in range(4200)}
CROWDED = {
    "many.h5": lambda path: formats.hdf5(path, MANY),
    "many.tdms": lambda path: formats.tdms(path, MANY),
    "many.npz": lambda path: np.savez(path, **MANY),
    "many.parquet": lambda path: pyarrow.parquet.write_table(pa.table(MANY), path),
    "many.json": lambda path: path.write_text(json.dumps({name: [1, 2] for name in MANY})),
    "many.csv": lambda path: path.write_text(",".join(MANY) + "\n" + ",".join(["1"] * len(MANY)) + "\n"),
}


@pytest.mark.parametrize("name", CROWDED)
def test_columns_are_bounded_in_number(tmp_path, name):
    CROWDED[name](tmp_path / name)
    with cpu_seconds(20.0), pytest.raises(InputError, match="allowed: 4096"):
        read(tmp_path / name)
