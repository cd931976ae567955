import subprocess
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.errors import InputError
from bench.trace.read import read
from bench.trace.stream import stream
from bench.trace.write import write
from tests.fit.motions import recording
from tests.trace.recordings import current, velocity


@pytest.fixture
def parquet(tmp_path):
    """Writes times and signals, or other columns."""

    def write_columns(time=None, columns=None, **how):
        if columns is None:
            columns = {"velocity [deg/s]": velocity(time), "current [mA]": current(time), "spare": time}
        pq.write_table(pa.table({"time [s]": time, **columns}), tmp_path / "run.parquet", **how)
        return tmp_path / "run.parquet"

    return write_columns


TIME = np.arange(1000) * 1e-3


@pytest.mark.parametrize(("samples", "chunk"), [(1000, 300), (901, 300), (600, 300), (50, 300), (7, 2), (301, 300)])
@pytest.mark.parametrize("rows", [97, 5000])
def test_chunks_together_are_the_recording(parquet, samples, chunk, rows):
    path = parquet(TIME[:samples], row_group_size=rows)
    parts, whole = list(stream(path, chunk=chunk)), read(path)
    assert np.array_equal(np.concatenate([part.time for part in parts]), whole.time)
    for name in ("velocity", "current"):
        assert np.array_equal(np.concatenate([part[name] for part in parts]), whole[name])
    assert [part.continues for part in parts] == [False] + [True] * (len(parts) - 1)
    assert max(len(part) for part in parts) <= chunk + 1


def test_other_formats_are_cut(parquet, tmp_path):
    path = parquet(TIME)
    write(read(path), tmp_path / "run.csv")
    for one, other in zip(*(stream(of, chunk=300) for of in (tmp_path / "run.csv", path)), strict=True):
        np.testing.assert_allclose(one["velocity"], other["velocity"], rtol=1e-15)
        assert one.continues == other.continues


def test_a_hole_inside_and_between_chunks(parquet):
    time = TIME[:900] + 0.2 * (TIME[:900] >= 0.45) + 0.3 * (TIME[:900] >= 0.6)
    parts = list(stream(parquet(time), chunk=300))
    assert [len(part.segments) for part in parts] == [1, 2, 1]
    assert [part.continues for part in parts] == [False, True, False]


def test_a_column_is_named_as_for_reading(parquet):
    (part,) = stream(parquet(TIME), {"position": "spare [deg]"})
    assert set(part.signals) == {"position", "velocity", "current"}


def test_moments_count_from_the_first_of_the_file(parquet):
    moments = pa.array((1_700_000_000_000_000 + np.arange(500) * 1000).tolist(), pa.timestamp("us"))
    parts = list(stream(parquet(moments, {"velocity [rad/s]": np.arange(500.0)}), {"time": "time [s]"}, chunk=200))
    np.testing.assert_allclose(np.concatenate([part.time for part in parts]), TIME[:500], atol=1e-12)


@pytest.mark.parametrize("chunk", [300, 10_000])
def test_bad_samples_are_named_by_their_number_in_the_file(parquet, chunk):
    speed = np.where(np.arange(1000) == 777, np.inf, velocity(TIME))
    with pytest.raises(InputError, match=r"sample 777, column 'velocity \[deg/s\]': found inf"):
        list(stream(parquet(TIME, {"velocity [deg/s]": speed}), chunk=chunk))
    with pytest.raises(InputError, match="runs backwards"):
        list(stream(parquet(np.where(TIME < 0.6, TIME, TIME - 0.5)), chunk=chunk))


@pytest.mark.parametrize("cut", [3, 100, -4, -100])
def test_truncated_and_missing_files(parquet, tmp_path, cut):
    path = parquet(TIME)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(InputError):
        list(stream(path))
    with pytest.raises(InputError, match="no such file"):
        list(stream(tmp_path / "no.parquet"))


#: The high-water mark of the process itself: getrusage would count that of the parent before exec.
IDENTIFIED = """
import re, sys
from pathlib import Path
from bench.fit.identify import identify
from bench.trace.stream import stream
from tests.fit.motions import RIG
found = identify(stream(sys.argv[1]), RIG)["moment_of_inertia"].value
print(found, re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1])
"""


@pytest.mark.slow
def test_ten_million_samples_are_identified_in_a_gigabyte(tmp_path):
    path, trace = tmp_path / "long.parquet", recording(np.random.default_rng(1), duration=10_000.0)
    columns = {"time [s]": trace.time, "velocity [rad/s]": trace["velocity"], "current [A]": trace["current"]}
    pq.write_table(pa.table(columns), path)
    line = [sys.executable, "-c", IDENTIFIED, str(path)]
    inertia, kilobytes = map(float, subprocess.run(line, capture_output=True, text=True, check=True).stdout.split())
    assert inertia == pytest.approx(1.5e-3, rel=1e-3)
    assert kilobytes < 1_000_000
