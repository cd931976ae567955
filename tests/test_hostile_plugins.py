"""Packages that offer something to the bench: whatever their code does, status 0 means that a result was written."""

import pytest

from bench.effects.catalogue import catalogue
from bench.errors import InputError, Stopped
from tests.hostile import RIG, ROOT, TABLE, assert_one_line, run

ENDS = ["sys.exit(0)", "sys.exit()", "raise SystemExit", "raise BaseException('x')", "raise GeneratorExit", "1 / 0"]


def package(folder, group, code, offered="evilplug:OFFERED"):
    """A package in a folder, as pip installs it."""
    info = folder / "evil-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: evil\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[servobench.{group}]\nx = {offered}\n")
    (folder / "evilplug.py").write_text(code)
    return {"PYTHONPATH": f"{folder}:{ROOT}"}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "x.csv").write_text(TABLE)
    return tmp_path


@pytest.mark.parametrize("group", ["effects", "readers", "commands"])
def test_an_import_that_ends_the_run_is_no_success(folder, group):
    own = package(folder / "plug", group, "import sys; sys.exit(0)")
    done = run("diagnose", "x.csv", "--rig", "rig.toml", "--json", "d.json", cwd=folder, **own)
    assert_one_line(done, f"servobench.{group}: evilplug:OFFERED of evil", "SystemExit: 0", "pip uninstall evil")
    assert not (folder / "d.json").exists()


@pytest.mark.parametrize(
    ("code", "raised", "words"),
    [
        *((code, InputError, r"servobench.effects: evilplug:OFFERED of evil: cannot be imported") for code in ENDS),
        *((f"raise {stop.__name__}", stop, None) for stop in (KeyboardInterrupt, Stopped)),
    ],
)
def test_an_import_that_fails_names_its_package_and_one_that_a_person_stops_is_stopped(
    tmp_path, monkeypatch, code, raised, words
):
    package(tmp_path, "effects", f"import sys\nfrom bench.errors import Stopped\n{code}")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(raised, match=words):
        catalogue.__wrapped__()


READER = """
import sys
class Reader:
    format, endings = "mine", (".csv",)
    def recognises(self, source): sys.exit(0)
    def read(self, source): sys.exit(0)
OFFERED = Reader()
"""
COMMAND = """
import sys
def OFFERED():
    "A command."
    sys.exit(0)
"""


@pytest.mark.parametrize(
    ("group", "code", "line"),
    [("readers", READER, "identify x.csv --rig rig.toml --json d.json"), ("commands", COMMAND, "x")],
)
def test_code_that_ends_the_run_later_is_a_fault_of_its_package(folder, group, code, line):
    own = package(folder / "plug", group, code)
    done = run(*line.split(), cwd=folder, **own)
    assert (done.returncode, done.stdout) == (70, "")
    assert "a fault of evil, not of your input (SystemExit: 0" in done.stderr


def test_shell_completion_still_ends_well(folder):
    done = run("--show-completion", "bash", cwd=folder)
    assert (done.returncode, "COMP_WORDS" in done.stdout) == (0, True)
