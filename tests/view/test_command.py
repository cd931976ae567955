"""`bench view` as a user meets it: a page, a video where this machine renders, and one line for what is wrong."""

import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from bench.trace.write import write
from tests.diagnosis.conftest import bench
from tests.diagnosis.test_commands import diagnosed, only, run_of

__all__ = ["bench", "diagnosed"]
ROOT = Path(__file__).resolve().parents[2]


def test_a_page_is_written_and_said(bench, diagnosed, tmp_path):
    model, trace = diagnosed / "found" / "model.toml", diagnosed / "run2.csv"
    status, out, err = bench("replay", model, trace, "--rig", "rig.toml", "--page", "view.html")
    assert (status, out, err) == (0, "wrote view.html\n", "")
    page = (tmp_path / "view.html").read_text(encoding="utf-8")
    assert "The simulated axis stays within" in page
    assert "And free-running?" in page
    assert "5 windows begin at the sensors" in page


def test_a_recording_without_position_is_shown_with_a_warning(bench, diagnosed, tmp_path):
    write(only(run_of(seed=2), "velocity", "current"), tmp_path / "blind.csv")
    status, _, err = bench(
        "replay", diagnosed / "found" / "model.toml", "blind.csv", "--rig", "rig.toml", "--page", "view.html"
    )
    assert status == 0
    assert "warning: blind.csv contains no position; the page shows the integral of its speed" in err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((), "TRACE: missing; allowed: a recording; or --rig with [drive]"),
        (("--rig", "rig.toml"), "drive: missing"),
        (("run2.csv", "--rig", "rig.toml", "--from", "9"), "--from, --to: found 9 s to 3.999 s; allowed: a part of"),
        (("run2.csv", "--rig", "rig.toml", "--page", "view.txt"), "view.txt: found the ending '.txt'; allowed: .html"),
        (("run2.csv", "--rig", "rig.toml", "--video", "view.gif"), "view.gif: found the ending '.gif'; allowed: .mp4"),
        (("run2.csv", "--rig", "rig.toml", "--video", "v.mp4", "--slowed", "1e4"), "allowed: up to 18000"),
        (("run2.csv", "--rig", "rig.toml", "--video", "v.mp4", "--slowed", "inf"), "inf frames; allowed: up to"),
        (("run2.csv", "--rig", "rig.toml", "--video", "v.mp4", "--slowed", "nan"), "greater than or equal to 1"),
        (("run2.csv", "--rig", "rig.toml", "--from", "nan"), "--from, --to: found nan s to"),
        (("run2.csv", "--rig", "rig.toml", "--video", "run2.csv"), "is an input of this command"),
    ],
)
def test_what_is_wrong_is_one_line(bench, diagnosed, tmp_path, arguments, says):
    (tmp_path / "run2.csv").write_bytes((diagnosed / "run2.csv").read_bytes())
    status, _, err = bench("view", diagnosed / "found" / "model.toml", *arguments)
    assert status == 2
    assert err.count("\n") == 1
    assert says in err


def run_alone(folder, arguments, **environment):
    """The command in a process of its own: MuJoCo decides how it renders when it is imported."""
    command = [sys.executable, "-m", "bench", "replay", *map(str, arguments)]
    variables = {name: value for name, value in os.environ.items() if name not in ("MUJOCO_GL", "DISPLAY")}
    variables |= {"PYTHONPATH": str(ROOT), **environment}
    return subprocess.run(command, cwd=folder, env=variables, capture_output=True, text=True, check=False)


def test_a_video_shows_the_motion(diagnosed, tmp_path):
    av = pytest.importorskip("av", reason="needs PyAV (pip install 'servobench[video]')")
    model, trace, rig = diagnosed / "found" / "model.toml", diagnosed / "run2.csv", diagnosed / "rig.toml"
    part = ("--from", "0.5", "--to", "0.6", "--slowed", "2")
    done = run_alone(tmp_path, (model, trace, "--rig", rig, "--video", "view.mp4", *part))
    if "MuJoCo finds nothing to render with" in done.stderr:
        assert not (tmp_path / "view.mp4").exists()
        pytest.skip("this machine renders nothing (apt-get install libegl1 libgl1-mesa-dri)")
    assert (done.returncode, done.stderr) == (0, "")
    assert "wrote view.mp4" in done.stdout
    with av.open(str(tmp_path / "view.mp4")) as container:
        frames = [frame.to_ndarray(format="rgb24").astype(float) for frame in container.decode(video=0)]
    assert len(frames) == 7  # 0.1 s, slowed twice, at 30 a second, both ends
    assert frames[0].std() > 20.0
    assert all(np.abs(after - before).max() > 60.0 for before, after in pairwise(frames))


@pytest.mark.parametrize("chosen", ["osmesa", "glfw"])
def test_where_nothing_renders_there_is_one_line_and_no_video(diagnosed, tmp_path, chosen):
    pytest.importorskip("av", reason="needs PyAV (pip install 'servobench[video]')")
    model, trace, rig = diagnosed / "found" / "model.toml", diagnosed / "run2.csv", diagnosed / "rig.toml"
    part = ("--to", "0.1")
    done = run_alone(tmp_path, (model, trace, "--rig", rig, "--video", "v.mp4", *part), MUJOCO_GL=chosen)
    if done.returncode == 0:
        pytest.skip(f"this machine renders by {chosen}")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert f"MuJoCo finds nothing to render with (MUJOCO_GL is {chosen})" in done.stderr
    assert not (tmp_path / "v.mp4").exists()
