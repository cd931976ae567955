import math

import numpy as np
import pytest
from servobench_reader.drive_dump import MAGIC, RECORD

import bench
from bench.errors import InputError


def dump(samples=1000):
    """A drive that turns ever faster at 2 A, by 1 rpm a millisecond."""
    count = np.arange(samples)
    columns = 1000 * count, count, np.full(samples, 2.0)
    return MAGIC + np.array(list(zip(*columns, strict=True)), RECORD).tobytes()


def test_it_is_read(tmp_path):
    (tmp_path / "run.bin").write_bytes(dump())
    trace = bench.read(tmp_path / "run.bin")
    assert trace.metadata["format"] == "drive's memory"
    assert trace.sample_period == pytest.approx(1e-3)
    assert trace["velocity"] == pytest.approx(math.pi / 30.0 * np.arange(1000))
    assert trace["current"] == pytest.approx(np.full(1000, 2.0))


def test_half_a_record_is_refused(tmp_path):
    (tmp_path / "run.dump").write_bytes(dump()[:-5])
    with pytest.raises(InputError, match=r"run\.dump: found 11995 bytes of records.*cut off"):
        bench.read(tmp_path / "run.dump")
