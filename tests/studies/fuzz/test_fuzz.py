"""Short fuzzing runs of each target, with a deadline that sees hangs; the long ones are commands (CONTRIBUTING)."""

import os
import random
import subprocess
import sys
import tomllib
from importlib.util import find_spec

import pytest

from tests.hostile import ROOT
from tests.studies.fuzz.grammar import as_toml, changed

TARGETS = ("units", "rig", "model", "readers")


def ran(cwd, *arguments):
    env = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1", "TMPDIR": str(cwd)}
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=cwd, env=env, capture_output=True, text=True, errors="replace", timeout=300, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("runs", [100, pytest.param(1500, marks=pytest.mark.slow)])
def test_nothing_is_found_without_coverage(tmp_path, runs):
    done = ran(tmp_path, "-m", "tests.studies.fuzz.plain", *TARGETS, "--runs", str(runs))
    assert done.returncode == 0, done.stderr[-3000:]


def test_nothing_is_found_by_structure(tmp_path):
    grammars = ("rig", "model", "mjcf", "manifest", "store", "baseline")
    done = ran(tmp_path, "-m", "tests.studies.fuzz.grammar", *grammars, "--runs", "10", "--seconds", "20")
    assert done.returncode == 0, done.stderr[-3000:]
    assert [line.split(":")[0] for line in done.stdout.splitlines()] == list(grammars)


def test_a_tree_is_changed_and_the_good_one_stays(tmp_path):
    """Of a hundred trees most parse again as what they are written as, and hardly two are the same."""
    rng, good = random.Random(0), {"a": {"b": [1.0, "2 kg"]}, "c": "text"}
    made = [as_toml(changed(rng, good, [good])) for _ in range(100)]
    assert good == {"a": {"b": [1.0, "2 kg"]}, "c": "text"}
    assert len(set(made)) > 60 and all(isinstance(tomllib.loads(one.decode()), dict) for one in made)


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        ("if b'1' not in data: {}['x']", "KeyError: 'x'"),
        ("while b'1' not in data: pass", "Timeout (0:00:02)!"),
        ("if b'1' not in data: bytes(1 << 32)", "MemoryError"),
    ],
)
def test_faults_are_found_and_their_input_lies_there(tmp_path, fault, expected):
    (tmp_path / "faulty.py").write_text(
        "from tests.studies.fuzz.plain import fuzz\n"
        f"def target(data):\n    {fault}\nfuzz(target, [b'1 2'], 99, deadline=2)\n"
    )
    done = ran(tmp_path, "faulty.py")
    assert done.returncode != 0
    assert expected in done.stderr and "in target" in done.stderr
    assert b"1" not in (tmp_path / "input").read_bytes()


@pytest.mark.skipif(find_spec("atheris") is None, reason="the extra `fuzz` is not installed")
@pytest.mark.parametrize("target", TARGETS)
def test_nothing_is_found_in_a_short_run(tmp_path, target):
    done = ran(tmp_path, "-m", "tests.studies.fuzz", target, "--runs", "300")
    assert done.returncode == 0, done.stderr[-3000:]
