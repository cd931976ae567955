"""Flipped bits: seen where a file has sums, and never the end of the process."""

import contextlib

import numpy as np
import pytest

import bench
from bench.errors import InputError
from tests.studies.corrupt import files
from tests.studies.corrupt.flips import SUMMED, flipped


@pytest.mark.parametrize("kept", ["parquet with sums", "mcap", "h5 with sums"])
def test_a_bit_that_flips_among_the_samples_is_seen_where_the_file_has_sums(tmp_path, kept):
    """The number is as good as it was: of a text a digit, of an array a bit of the mantissa."""
    time, velocity = 1e-3 * np.arange(400), np.random.default_rng(0).normal(size=400)
    content = bytearray({**files.KEPT, **files.SUMMED}[kept]((time, velocity, velocity)))
    text, binary = (content.find(one) for one in (repr(float(velocity[200])).encode(), velocity[200].tobytes()))
    content[max(text + 6, binary)] ^= 1
    path = tmp_path / f"run.{kept.split()[0]}"
    path.write_bytes(content)
    with pytest.raises(InputError, match="truncated or damaged"):
        bench.read(path, files.COLUMNS.get(kept, {"time": "time [s]", "velocity": "velocity [rad/s]"}))


@pytest.mark.parametrize("kept", ["parquet", "parquet with sums"])
def test_a_bit_that_flips_ends_no_process_and_changes_no_number_that_has_a_sum(tmp_path, monkeypatch, kept):
    """Of 150 Parquet files one ended the process: Arrow was asked what a damaged column is said to hold."""
    monkeypatch.chdir(tmp_path)
    found = flipped(kept, 150, 0, tmp_path)
    assert found.total() == 150 and found["refused"] > 10
    assert not (found["another number"] and kept in SUMMED)


def test_a_parquet_that_tells_of_fewer_rows_than_its_columns_hold_is_damaged(tmp_path):
    """One bit where the rows are counted lost half of the samples without a word."""
    content = files.as_parquet((1e-3 * np.arange(60), np.ones(60), np.ones(60)), checksums=True)
    places = [k for k in range(len(content) // 2, len(content)) if content[k] == 2 * 60]  # a count, as Thrift has it
    refused = 0
    for place in places:
        (tmp_path / "run.parquet").write_bytes(content[:place] + bytes([2 * 28]) + content[place + 1 :])
        with contextlib.suppress(InputError):
            assert bench.read(tmp_path / "run.parquet").time.size == 60
            continue
        refused += 1
    assert refused > 1
