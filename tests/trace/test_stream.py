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


def _parquet(path, time, **kwargs):
    table = pa.table(
        {"time [s]": time, "velocity [deg/s]": velocity(time), "current [mA]": current(time), "spare": time}
    )
    pq.write_table(table, path, **kwargs)
    return path


@pytest.mark.parametrize(("samples", "chunk"), [(1000, 300), (901, 300), (600, 300), (50, 300), (7, 2), (301, 300)])
@pytest.mark.parametrize("rows", [97, 5000])
def test_chunks_together_are_the_recording(tmp_path, samples, chunk, rows):
    path = _parquet(tmp_path / "run.parquet", np.arange(samples) * 1e-3, row_group_size=rows)
    parts, whole = list(stream(path, chunk=chunk)), read(path)
    assert np.array_equal(np.concatenate([part.time for part in parts]), whole.time)
    for name in ("velocity", "current"):
        assert np.array_equal(np.concatenate([part[name] for part in parts]), whole[name])
    assert [part.continues for part in parts] == [False] + [True] * (len(parts) - 1)
    assert max(len(part) for part in parts) <= chunk + 1


def test_other_formats_are_cut(tmp_path):
    path = _parquet(tmp_path / "run.parquet", np.arange(1000) * 1e-3)
    write(read(path), tmp_path / "run.csv")
    of_csv, of_parquet = (list(stream(tmp_path / f"run.{ending}", chunk=300)) for ending in ("csv", "parquet"))
    for one, other in zip(of_csv, of_parquet, strict=True):
        np.testing.assert_allclose(one["velocity"], other["velocity"], rtol=1e-15)
        assert one.continues == other.continues


def test_a_hole_inside_and_between_chunks(tmp_path):
    time = np.arange(900) * 1e-3
    time[450:] += 0.2
    time[600:] += 0.3
    parts = list(stream(_parquet(tmp_path / "run.parquet", time), chunk=300))
    assert [len(part.segments) for part in parts] == [1, 2, 1]
    assert [part.continues for part in parts] == [False, True, False]


def test_a_column_is_named_as_for_reading(tmp_path):
    path = _parquet(tmp_path / "run.parquet", np.arange(100) * 1e-3)
    (part,) = stream(path, {"position": "spare [deg]"})
    assert set(part.signals) == {"position", "velocity", "current"}


def test_moments_count_from_the_first_of_the_file(tmp_path):
    moments = pa.array((1_700_000_000_000_000 + np.arange(500) * 1000).tolist(), pa.timestamp("us"))
    pq.write_table(pa.table({"time": moments, "velocity [rad/s]": np.arange(500.0)}), tmp_path / "run.parquet")
    parts = list(stream(tmp_path / "run.parquet", chunk=200))
    np.testing.assert_allclose(np.concatenate([part.time for part in parts]), np.arange(500) * 1e-3, atol=1e-12)


@pytest.mark.parametrize("chunk", [300, 10_000])
def test_bad_samples_are_named_by_their_number_in_the_file(tmp_path, chunk):
    time = np.arange(1000) * 1e-3
    speed = velocity(time)
    speed[777] = np.inf
    pq.write_table(pa.table({"time [s]": time, "velocity [deg/s]": speed}), tmp_path / "inf.parquet")
    with pytest.raises(InputError, match=r"sample 777, column 'velocity \[deg/s\]': found inf"):
        list(stream(tmp_path / "inf.parquet", chunk=chunk))
    back = time.copy()
    back[600:] -= 0.5
    with pytest.raises(InputError, match="runs backwards"):
        list(stream(_parquet(tmp_path / "back.parquet", back), chunk=chunk))


@pytest.mark.parametrize("cut", [3, 100, -4, -100])
def test_truncated_parquet(tmp_path, cut):
    path = _parquet(tmp_path / "run.parquet", np.arange(1000) * 1e-3)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(InputError):
        list(stream(path))


def test_missing_file(tmp_path):
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
