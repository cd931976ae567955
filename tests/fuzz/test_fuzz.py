"""A short fuzzing run of each target, with a deadline that sees hangs; the long ones are commands (CONTRIBUTING)."""

import os
import subprocess
import sys

import pytest

from tests.hostile import ROOT

pytest.importorskip("atheris", reason="the extra `fuzz` is not installed")


@pytest.mark.parametrize("target", ["units", "rig", "model", "readers"])
def test_nothing_is_found_in_a_short_run(tmp_path, target):
    env = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz", target, "--runs", "300"],
        cwd=tmp_path, env=env, capture_output=True, text=True, errors="replace", timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
