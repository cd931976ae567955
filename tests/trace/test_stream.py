import subprocess
import sys
import time as clock

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.errors import InputError
from bench.trace.read import read
from bench.trace.stream import stream
from bench.trace.write import write
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


@pytest.mark.slow
def test_ten_million_samples_at_arrows_speed_in_a_gigabyte(tmp_path):
    path = _parquet(tmp_path / "long.parquet", np.arange(10_000_000) * 1e-3)
    wanted = ["time [s]", "velocity [deg/s]", "current [mA]"]
    reads, streams = [], []
    for _ in range(5):
        start = clock.perf_counter()
        pq.read_table(path, columns=wanted)
        reads.append(clock.perf_counter() - start)
        start = clock.perf_counter()
        assert sum(len(part) for part in stream(path)) == 10_000_000
        streams.append(clock.perf_counter() - start)
    print(f"read_table {min(reads):.3f} s, stream {min(streams):.3f} s, {min(streams) / min(reads):.2f} times")
    # the high-water mark of the process itself: getrusage would count that of the parent before exec
    code = f"from bench.trace.stream import stream\nfor part in stream({str(path)!r}): pass\n"
    code += "print(next(line for line in open('/proc/self/status') if line.startswith('VmHWM')).split()[1])"
    peak = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    print(f"peak memory {int(peak.stdout) / 1e6:.2f} GB")
    assert int(peak.stdout) < 1_000_000
