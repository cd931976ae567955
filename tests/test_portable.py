"""The bench runs where the modules and calls of POSIX are missing, as on Windows."""

import json
import subprocess
import sys

import matplotlib as mpl
import pytest

from tests.hostile import ROOT

#: Modules and calls of POSIX are missing for the bench and for filelock; other libraries ask for the platform.
WITHOUT_POSIX = """
import builtins, os, signal

HIDDEN = {"fcntl", "resource", "pwd", "grp", "termios", "pty", "tty", "syslog", "readline"}
CALLS = {
    os: ("fork", "getuid", "geteuid", "getgid", "fstatvfs", "statvfs", "confstr", "mkfifo", "killpg", "setsid", "nice"),
    signal: ("SIGHUP", "SIGALRM", "SIGPROF", "setitimer", "alarm"),
}
found = builtins.__import__

def hiding(name, globals=None, locals=None, fromlist=(), level=0):
    importer = (globals or {}).get("__name__", "").partition(".")[0]
    if importer in ("bench", "filelock") and name in HIDDEN:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    return found(name, globals, locals, fromlist, level)

builtins.__import__ = hiding
for module, names in CALLS.items():
    for name in names:
        delattr(module, name)
from bench.__main__ import main
main()
"""


def without_posix(*arguments, cwd):
    command = [sys.executable, "-c", WITHOUT_POSIX, *map(str, arguments)]
    # the list of fonts is not made anew in a home of its own
    env = {"PATH": "", "PYTHONPATH": str(ROOT), "HOME": str(cwd), "MPLCONFIGDIR": mpl.get_cachedir()}
    return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, timeout=300, check=False)


def test_the_demo_hides_an_effect_finds_it_and_ends_with_what_is_next(tmp_path):
    done = without_posix("demo", "--out", "here", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "truth" in done.stdout and "moment of inertia" in done.stdout
    *lines, page, yours = done.stdout.splitlines()
    named = [tmp_path / line.removeprefix("wrote ") for line in lines if line.startswith("wrote ")]
    made = {"trace.csv.gz", "identification.png", "identify.json", "diagnosis.json", "model.toml", "model.xml"}
    assert {path.name for path in named} >= made
    assert all(path.stat().st_size > 500 for path in named)
    assert not [path for path in (tmp_path / "here").iterdir() if path.name.startswith(".bench")]
    (hidden,) = json.loads((tmp_path / "here" / "trace.csv.gz.truth.json").read_text())["effects"]
    (found,) = json.loads((tmp_path / "here" / "diagnosis.json").read_text())["effects"]
    assert found["name"] == hidden["name"]
    for name, true in hidden["parameters"].items():
        assert found["parameters"][name]["value"] == pytest.approx(true["value"], rel=0.02), name
    assert page == "the page: here/report.html"
    assert yours.startswith("your recording: bench diagnose ")


def test_a_worker_process(tmp_path):
    """MDF4 is read in a process of its own; here a damaged one."""
    (tmp_path / "x.mf4").write_bytes(b"MDF     4.10    " + bytes(200))
    done = without_posix("inspect", "x.mf4", cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert "damaged" in done.stderr
