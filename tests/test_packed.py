"""A result in one file: what comes out is what went in, and a file names nothing that is run."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.comparison.spread import Between
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.packed import pack, unpack
from bench.parameter import Parameter


def test_it_is_what_it_was_with_arrays_effects_and_what_is_not_known(tmp_path):
    parts = {"a": (1, 2.5, None, True), frozenset({"b"}): [np.arange(3.0), catalogue()["backlash"], np.float64(2.0)]}
    pack(tmp_path / "x.npz", Parameter(parts, "N*m", float("inf"), (float("-inf"), 0.1 + 0.2)))
    found = unpack(tmp_path / "x.npz", Parameter)
    assert (found.unit, found.std_error, found.ci95) == ("N*m", float("inf"), (float("-inf"), 0.1 + 0.2))
    array, effect, number = found.value[frozenset({"b"})]
    assert (array.tolist(), effect, number) == ([0.0, 1.0, 2.0], catalogue()["backlash"], 2.0)
    assert found.value["a"] == (1, 2.5, None, True)


@pytest.mark.parametrize(
    "named",
    ["os:system", "subprocess:Popen", "bench.files:write_text", "bench.files:Path", "bench.parameter:nothing", "x"],
)
def test_what_is_no_dataclass_of_the_bench_is_not_made(named, tmp_path):
    content = json.dumps({"class": named, "fields": {"args": "touch ran"}})
    np.savez(tmp_path / "x.npz", result=np.array(content))
    with pytest.raises(InputError, match="contains no result of this version"):
        unpack(tmp_path / "x.npz", Parameter)


@pytest.mark.parametrize("content", [b"", b"PK", b"\x93NUMPY", b"x" * 100])
def test_another_file_is_reported(content, tmp_path):
    Path(tmp_path / "x.npz").write_bytes(content)
    with pytest.raises(InputError, match=r"x\.npz: "):
        unpack(tmp_path / "x.npz", Parameter)


def test_another_result_is_reported(tmp_path):
    pack(tmp_path / "x.npz", Between(1.0, (0.0, 2.0)))
    with pytest.raises(InputError, match="contains another result"):
        unpack(tmp_path / "x.npz", Parameter)


def test_what_cannot_be_stored_leaves_no_file(tmp_path):
    with pytest.raises(TypeError, match="found object"):
        pack(tmp_path / "x.npz", Parameter(object(), "", 0.0, (0.0, 0.0)))
    assert not list(tmp_path.iterdir())
