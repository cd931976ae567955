"""The commands of docs/view.md run as they stand."""

import re
import shlex
from pathlib import Path

import pytest

from bench.assets import asset
from tests.diagnosis.conftest import bench
from tests.view.test_command import run_alone

__all__ = ["bench"]
MANUAL = (Path(__file__).resolve().parents[2] / "docs" / "view.md").read_text(encoding="utf-8")


def test_the_commands_of_the_manual_run(bench, tmp_path):
    (tmp_path / "rig.toml").write_bytes(asset("data", "rigs", "sh30701p.toml").read_bytes())
    (block,) = re.findall(r"```sh\n(.*?)```", MANUAL, re.DOTALL)
    *pages, video = [shlex.split(line)[1:] for line in block.splitlines()]
    for arguments in pages:
        status, _, err = bench(*arguments)
        assert (status, err) == (0, "")
    for written in ("view.html", "asked.html"):
        assert 100_000 < (tmp_path / written).stat().st_size < 1_000_000
    pytest.importorskip("av", reason="needs PyAV (pip install 'servobench[video]')")
    done = run_alone(tmp_path, video[1:])
    if "MuJoCo finds nothing to render with" in done.stderr:
        pytest.skip("this machine renders nothing (apt-get install libegl1 libgl1-mesa-dri)")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "reversal.mp4").stat().st_size > 5_000
