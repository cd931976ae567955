"""The command where it may have to run: no display, no home, locale C and ASCII, folders that may only be read."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.hostile import DEADLINE, RIG, ROOT, assert_one_line, columns, csv_of
from tests.hostile import bound_by_permissions as bound

#: Of the environment, what belongs to somebody.
PERSONAL = ("DISPLAY", "WAYLAND_DISPLAY", "XAUTHORITY", "HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR")
ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": "ascii"}
NAME = "Ächse 軸"
IDENTIFY = ("identify", "run.csv", "--rig", "rig.toml", "--cutoff", "60")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "rig.toml").write_text(RIG.replace("axis", NAME), encoding="utf-8")
    (tmp_path / "run.csv").write_text(csv_of(*columns()))
    return tmp_path


def bench(*arguments, cwd, before=(), install=ROOT, **environment):
    """`bench` with nothing personal in its environment; `before` is the command that starts it."""
    kept = {name: value for name, value in os.environ.items() if name not in PERSONAL}
    return subprocess.run(
        [*before, sys.executable, "-m", "bench", *arguments],
        cwd=cwd, env={**kept, "PYTHONPATH": str(install), **environment},
        capture_output=True, text=True, encoding="utf-8", timeout=DEADLINE, check=False,
    )  # fmt: skip


@pytest.fixture
def bound_by_permissions():
    """Command that starts another without root's right to read and write whatever permissions say."""
    found = bound()
    if found is None:
        pytest.skip("root is stopped by no permission, and setpriv cannot drop that right here")
    return found


@pytest.fixture
def read_only(folder):
    """The folder, which may be read and not written to."""
    folder.chmod(0o555)
    yield folder
    folder.chmod(0o755)


def content(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_without_display_and_with_a_home_that_is_not_there(folder):
    """Every other run here has no home at all, but draws no figures, whose library wants one."""
    done = bench(*IDENTIFY, "--out", "found", cwd=folder, HOME="/nonexistent")
    assert (done.returncode, done.stderr) == (0, "")
    assert {"identification.png", "identify.json", "report.html"} <= {
        path.name for path in (folder / "found").iterdir()
    }


def test_where_nothing_but_ascii_can_be_written(folder):
    (folder / "run.csv").rename(folder / NAME)
    done = bench("inspect", NAME, "--rig", "rig.toml", "--json", "found.json", cwd=folder, **ASCII)
    assert (done.returncode, done.stderr, done.stdout.isascii(), "chse" in done.stdout) == (0, "", True, True)
    assert json.loads((folder / "found.json").read_text(encoding="utf-8"))["schema"] == "bench.inspect/1"
    refused = bench("inspect", "ä.csv", cwd=folder, **ASCII)
    assert_one_line(refused, "no such file")
    assert refused.stderr.isascii()


def test_a_folder_that_may_only_be_read(read_only, bound_by_permissions):
    """What is read there is answered; what would be written there is refused, and nothing of it stays."""
    before = content(read_only)
    done = bench("inspect", "run.csv", "--json", "-", cwd=read_only, before=bound_by_permissions)
    assert (done.returncode, done.stderr) == (0, "")
    refused = bench(*IDENTIFY, "--out", "found", cwd=read_only, before=bound_by_permissions)
    assert_one_line(refused, "found", "Permission denied")
    assert content(read_only) == before


@pytest.mark.parametrize(
    ("name", "words"), [("run.csv", "not readable"), ("rig.toml", "cannot be read (Permission denied)")]
)
def test_a_file_that_may_not_be_read(folder, name, words, bound_by_permissions):
    (folder / name).chmod(0o000)
    assert_one_line(bench(*IDENTIFY, cwd=folder, before=bound_by_permissions), name, words)


def test_an_installation_that_may_only_be_read(folder, bound_by_permissions):
    install = folder / "install"
    for part in ("bench", "data", "mjcf"):
        shutil.copytree(ROOT / part, install / part, ignore=shutil.ignore_patterns("__pycache__"))
    there = [install, *install.rglob("*")]
    modes = {path: path.stat().st_mode for path in there}
    for path in there:
        path.chmod(modes[path] & ~0o222)
    before = content(install)
    try:
        done = bench("list", "effects", cwd=folder, before=bound_by_permissions, install=install)
        assert (done.returncode, done.stderr) == (0, "")
        where = [*bound_by_permissions, sys.executable, "-c", "import bench; print(bench.__file__)"]
        env = {**os.environ, "PYTHONPATH": str(install)}
        found = subprocess.run(where, cwd=folder, env=env, capture_output=True, text=True, check=True).stdout
        assert Path(found.strip()).is_relative_to(install)
        assert content(install) == before
    finally:
        for path in there:
            path.chmod(modes[path])
