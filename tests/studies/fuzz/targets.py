"""What is fuzzed, and the small good inputs that it begins with: each input ends in a result or in one line."""

import bz2
import gzip
import io
import lzma
import tempfile
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io
from nptdms import ChannelObject, TdmsWriter

from bench.errors import BenchError
from bench.plant.model_file import load_model
from bench.rig.rig import load_rig
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording, to_json
from bench.trace.read import read_recording
from bench.units import parse

ROOT = Path(__file__).resolve().parents[3]
#: Columns of the recordings in binary formats.
COLUMNS = {"time_s": np.arange(12) * 1e-3, "velocity_rad_s": np.arange(12.0), "current_A": np.ones(12)}


def units(data: bytes) -> None:
    parse(data.decode("utf-8", errors="replace"), "N*m", "units")


def rig(data: bytes) -> None:
    load_rig(written(data, "rig.toml"))


def model(data: bytes) -> None:
    load_model(written(data, "model.toml"))


def readers(data: bytes) -> None:
    to_json(inspect_recording(read_recording(written(data, "run")), GivenOptions()))


TARGETS = {target.__name__: target for target in (units, rig, model, readers)}


def once(name: str) -> Callable[[bytes], None]:
    """The target, which may refuse its input in one line; whatever else it raises is found."""

    def tried(data: bytes) -> None:
        try:
            TARGETS[name](data)
        except BenchError as error:
            assert "\n" not in str(error)

    return tried


def written(data: bytes, name: str) -> Path:
    path = folder() / name
    path.write_bytes(data)
    return path


@cache
def folder() -> Path:
    """Of this process' inputs."""
    return Path(tempfile.mkdtemp(prefix="fuzz-"))


def seeds(name: str) -> list[bytes]:
    """Good inputs of a target."""
    return {"units": UNITS, "rig": rigs(), "model": MODELS, "readers": [*TEXTS, *containers()]}[name]


UNITS = [b"22.4 kg*cm**2", b"1 m**(1/2)", b"-3e-4 N*m*s/rad", "2 °/s²".encode()]
MODELS = [
    b"""schema = "bench.model/1"
name = "axis"
kind = "rotary"
misalignment = "1e-5 s"
[parameters]
moment_of_inertia = "0.0022 kg*m**2"
viscous_friction_coefficient = "8e-4 N*m*s/rad"
coulomb_friction_torque = "0.06 N*m"
load_torque = "0 N*m"
motor_moment_of_inertia = "0.0002 kg*m**2"
[[effects]]
name = "cogging_torque"
amplitude = "0.02 N*m"
harmonic = 6
phase = "0.3 rad"
"""
]
TEXTS = [
    b"time [ms],velocity [deg/s],current [mA]\n0,1,2\n1,2,3\n2,3,4\n",
    b"[key]; [value]\nFlags; 16\n0.Variable; A.Velocity\n0.Data; \n; 0; 1\n; 1; 2\n",
    b"T\nP\nTimestamp(ms) A.Velocity\n0 1\n1 2\n",
    b"Name\tp\nStarttime of export\t132959733843760000\n\nName\tvelocity\nUnit\trad/s\n\n0\t1\n1\t2\n",
    b"EPOS Studio Version:;3\r\n;Velocity actual value;Torque actual value\r\nms;rpm;%\r\n0;1;1,5\r\n1;2;2\r\n",
    b'{"mass": 1, "entries": [{"timestamp": 0, "position": 0, "speed": 1, "load": 5, "input_volts": 7, "temp": 30, '
    b'"goal_position": 0}, {"timestamp": 0.1, "position": 0.1, "speed": 1, "load": 5, "input_volts": 7, "temp": 30, '
    b'"goal_position": 0}]}',
    b"<Trace><TraceVariable VarName='a'><Values>1,2</Values><Timestamps>1,2</Timestamps></TraceVariable></Trace>",
]


def rigs() -> list[bytes]:
    return [path.read_bytes() for path in sorted((ROOT / "data" / "rigs").glob("*.toml"))]


def containers() -> list[bytes]:
    """Small recordings in the binary formats that are read."""
    rows = "\n".join([",".join(COLUMNS), *(",".join(map(str, row)) for row in zip(*COLUMNS.values(), strict=True))])
    made = [gzip.compress(rows.encode(), mtime=0), bz2.compress(rows.encode()), lzma.compress(rows.encode())]
    for write in (
        lambda file: pq.write_table(pa.table(COLUMNS), file),
        lambda file: np.savez(file, **COLUMNS),
        lambda file: scipy.io.savemat(file, COLUMNS),
        lambda file: _zipped(file, rows),
        _hdf5,
        _tdms,
    ):
        file = io.BytesIO()
        write(file)
        made.append(file.getvalue())
    return made


def _zipped(file: io.BytesIO, rows: str) -> None:
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("run.csv", rows)


def _hdf5(file: io.BytesIO) -> None:
    with h5py.File(file, "w") as store:
        for name, values in COLUMNS.items():
            store[name] = values


def _tdms(file: io.BytesIO) -> None:
    with TdmsWriter(file) as writer:
        writer.write_segment([ChannelObject("axis", name, values) for name, values in COLUMNS.items()])
