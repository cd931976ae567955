"""A motion shown as a user meets it: a page, a video where this machine renders, and one line for what is wrong."""

import os
import shlex
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from bench.assets import asset
from bench.trace.write import write
from tests.diagnosis.test_commands import only
from tests.docs.pages import PAGES, bench_commands, run_commands

ROOT = Path(__file__).resolve().parents[2]


def test_a_page_is_written_and_said(bench, folder, tmp_path):
    arguments = ("replay", folder / "model.toml", folder / "run.csv", "--rig", "rig.toml", "--page", "view.html")
    assert bench(*arguments) == (0, "wrote view.html\n", "")
    page = (tmp_path / "view.html").read_text(encoding="utf-8")
    for words in ("The simulated axis stays within", "And free-running?", "5 windows begin at the sensors"):
        assert words in page


def test_a_recording_without_position_is_shown_with_a_warning(bench, folder, trace, tmp_path):
    write(only(trace, "velocity", "current"), tmp_path / "blind.csv")
    done = bench("replay", folder / "model.toml", "blind.csv", "--rig", "rig.toml", "--page", "view.html")
    assert done.status == 0
    assert "warning: blind.csv contains no position; the page shows the integral of its speed" in done.err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ("", "TRACE: missing; allowed: a recording; or --rig with [drive]"),
        ("--rig rig.toml", "drive: missing"),
        ("run.csv --rig rig.toml --from 9", "--from, --to: found 9 s to 3.999 s; allowed: a part of"),
        ("run.csv --rig rig.toml --from nan", "--from, --to: found nan s to"),
        ("run.csv --rig rig.toml --page view.txt", "view.txt: found the ending '.txt'; allowed: .html"),
        ("run.csv --rig rig.toml --video view.gif", "view.gif: found the ending '.gif'; allowed: .mp4"),
        ("run.csv --rig rig.toml --video v.mp4 --slowed 1e4", "allowed: up to 18000"),
        ("run.csv --rig rig.toml --video v.mp4 --slowed inf", "inf frames; allowed: up to"),
        ("run.csv --rig rig.toml --video v.mp4 --slowed nan", "greater than or equal to 1"),
        ("run.csv --rig rig.toml --video run.csv", "is an input of this command"),
    ],
)
def test_what_is_wrong_is_one_line(bench, folder, tmp_path, arguments, says):
    (tmp_path / "run.csv").write_bytes((folder / "run.csv").read_bytes())
    done = bench("view", folder / "model.toml", *arguments.split())
    assert (done.status, done.err.count("\n")) == (2, 1)
    assert says in done.err


def run_alone(folder, arguments, **environment):
    """The command in a process of its own: MuJoCo decides how it renders when it is imported."""
    command = [sys.executable, "-m", "bench", *map(str, arguments)]
    variables = {name: value for name, value in os.environ.items() if name not in ("MUJOCO_GL", "DISPLAY")}
    variables |= {"PYTHONPATH": str(ROOT), **environment}
    return subprocess.run(command, cwd=folder, env=variables, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("chosen", ["osmesa", "glfw"])
def test_where_nothing_renders_there_is_one_line_and_no_video(folder, tmp_path, chosen):
    pytest.importorskip("av", reason="needs PyAV (pip install 'servobench[video]')")
    (tmp_path / "rig.toml").write_bytes(asset("data", "rigs", "sh30701p.toml").read_bytes())
    what = (folder / "model.toml", folder / "run.csv", "--rig", "rig.toml", "--video", "v.mp4", "--to", "0.1")
    done = run_alone(tmp_path, ("replay", *what), MUJOCO_GL=chosen)
    if done.returncode == 0:
        pytest.skip(f"this machine renders by {chosen}")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert f"MuJoCo finds nothing to render with (MUJOCO_GL is {chosen})" in done.stderr
    assert not (tmp_path / "v.mp4").exists()


def brief(line):
    """A motion of 2 s in place of 7; the video is made in a process of its own."""
    line += " --profile fast_reversals" * line.startswith("bench simulate")
    return "" if "--video" in line else line


def test_the_commands_of_the_manual_run_and_their_video_shows_the_motion(tmp_path, monkeypatch):
    """docs/view.md: 0.05 s, slowed 8 times, at 30 frames a second, both ends."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.toml").write_bytes(asset("data", "rigs", "sh30701p.toml").read_bytes())
    done = run_commands(PAGES["docs/view.md"], brief)
    assert {one.err for one in done} == {""}
    for written in ("view.html", "demanded.html"):
        assert 100_000 < (tmp_path / written).stat().st_size < 1_000_000
    av = pytest.importorskip("av", reason="needs PyAV (pip install 'servobench[video]')")
    (video,) = (shlex.split(line)[1:] for line in bench_commands(PAGES["docs/view.md"]) if "--video" in line)
    done = run_alone(tmp_path, video)
    if "MuJoCo finds nothing to render with" in done.stderr:
        assert not (tmp_path / "reversal.mp4").exists()
        pytest.skip("this machine renders nothing (apt-get install libegl1 libgl1-mesa-dri)")
    assert (done.returncode, done.stderr) == (0, "")
    assert "wrote reversal.mp4" in done.stdout
    with av.open(str(tmp_path / "reversal.mp4")) as container:
        frames = [frame.to_ndarray(format="rgb24").astype(float) for frame in container.decode(video=0)]
    assert len(frames) == 13
    assert frames[0].std() > 20.0
    assert all(np.abs(after - before).max() > 20.0 for before, after in pairwise(frames))
