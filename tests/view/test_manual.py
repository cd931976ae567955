"""The commands of docs/view.md run as they stand."""

import shlex

import pytest

from bench.assets import asset
from tests.docs.pages import PAGES, bench_commands, run_commands
from tests.view.test_command import run_alone


def brief(line):
    """A motion of 2 s in place of 7; the video is made in a process of its own."""
    line += " --profile fast_reversals" * line.startswith("bench simulate")
    return "" if "--video" in line else line


def test_the_commands_of_the_manual_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.toml").write_bytes(asset("data", "rigs", "sh30701p.toml").read_bytes())
    done = run_commands(PAGES["docs/view.md"], brief)
    assert {one.err for one in done} == {""}
    (video,) = (shlex.split(line)[1:] for line in bench_commands(PAGES["docs/view.md"]) if "--video" in line)
    for written in ("view.html", "demanded.html"):
        assert 100_000 < (tmp_path / written).stat().st_size < 1_000_000
    pytest.importorskip("av", reason="needs PyAV (pip install 'servobench[video]')")
    done = run_alone(tmp_path, video[1:])
    if "MuJoCo finds nothing to render with" in done.stderr:
        pytest.skip("this machine renders nothing (apt-get install libegl1 libgl1-mesa-dri)")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "reversal.mp4").stat().st_size > 5_000
