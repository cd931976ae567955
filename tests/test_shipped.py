"""What is shipped beside the package: scripts of continuous integration run as they stand, and versions agree."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

import bench as package
from bench.report.publish import write_document
from bench.trace.write import write
from tests.baseline.test_command import AS_IT_WAS, again
from tests.diagnosis.conftest import bench
from tests.fit.motions import Truth
from tests.report.test_page import page_full_of

yaml = pytest.importorskip("yaml", reason="needs PyYAML (pip install -e '.[docs]')")
ROOT = Path(__file__).resolve().parents[1]
__all__ = ["bench"]


def loaded(*parts):
    return yaml.safe_load(ROOT.joinpath(*parts).read_text(encoding="utf-8"))


@pytest.fixture
def shell(bench, tmp_path):
    """Runs a script in a folder with a baseline, where `bench` is this one."""
    write(again(1), Path("before.csv"))
    files = ("--rig", "rig.toml", "--baseline", "base.toml")
    assert bench("check", "before.csv", *files, "--update", "--without-names")[0] == 0
    programs = tmp_path / "programs"
    programs.mkdir()
    for name, does in (("bench", "-P -m bench"), ("python", "-P"), ("pip", "-c pass")):
        (programs / name).write_text(f'#!/bin/sh\nexec {sys.executable} {does} "$@"\n')
        (programs / name).chmod(0o755)

    def run(script, **variables):
        whole = os.environ | variables | {"PATH": f"{programs}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
        return subprocess.run(["bash", "-eo", "pipefail", "-c", script], env=whole, check=False, timeout=300).returncode

    return run


ACTION, JOB = loaded(".github", "actions", "check", "action.yml"), loaded(".ci", "gitlab-check.yml")[".bench-check"]
(STEP,) = (step for step in ACTION["runs"]["steps"] if step.get("id") == "check")
INPUTS = {"RECORDINGS": "now.csv", "RIG": "rig.toml", "BASELINE": "base.toml", "UNDECIDED": "pass"}
INPUTS |= {"RATE": ACTION["inputs"]["false-alarm-rate"]["default"], "GITHUB_OUTPUT": "outputs"}


@pytest.mark.parametrize(
    ("truth", "result", "status"), [(AS_IT_WAS, "same", 0), (Truth(coulomb=1.5 * Truth.coulomb), "changed", 3)]
)
def test_the_action_checks_an_axis(shell, truth, result, status):
    write(again(2, truth), Path("now.csv"))
    assert set(STEP["env"].values()) <= {f"${{{{ inputs.{name} }}}}" for name in ACTION["inputs"]}
    assert shell(STEP["run"], **INPUTS, GITHUB_STEP_SUMMARY="summary.md") == status
    assert Path("outputs").read_text() == f"result={result}\n"
    assert "kg&#42;m&#42;&#42;2 | same |" in Path("summary.md").read_text()
    assert {path.name for path in Path("bench-check").iterdir()} == {"check.json", "check.xml", "check.html"}


def test_the_template_checks_an_axis(shell):
    write(again(2), Path("now.csv"))
    variables = JOB["variables"] | {"RECORDINGS": "now.csv", "BASELINE": "base.toml"}
    assert shell("\n".join(JOB["script"]), **variables) == 0
    reports = JOB["artifacts"]["reports"].values()
    assert all(Path(name).stat().st_size for name in (*reports, *JOB["artifacts"]["paths"]))


OPTIONS = ("now.csv --help", "--version", "now.csv --update")


def test_no_word_among_the_recordings_is_an_option(shell):
    """`--help` in the place of a file ended well, without a result."""
    write(again(2), Path("now.csv"))
    before = Path("base.toml").read_bytes()
    Path("outputs").touch()
    for given in OPTIONS:
        assert shell(STEP["run"], **{**INPUTS, "RECORDINGS": given}) == 2, given
    for given in OPTIONS[:1]:
        assert shell("\n".join(JOB["script"]), **{**JOB["variables"], **INPUTS, "RECORDINGS": given}) == 2, given
    assert Path("outputs").read_text() == ""
    assert Path("base.toml").read_bytes() == before


def test_the_action_without_a_result_fails(shell, tmp_path):
    """Whatever ended the run with status 0: an old result, or none, is no success."""
    (tmp_path / "programs" / "bench").write_text("#!/bin/sh\nexit 0\n")
    Path("bench-check").mkdir()
    Path("bench-check/check.json").write_text('{"result": "same"}')
    Path("check.xml").write_text("old")
    given = {name: value for name, value in INPUTS.items() if name != "GITHUB_OUTPUT"}
    assert shell(STEP["run"], **given) == 70
    assert shell("\n".join(JOB["script"]), **JOB["variables"]) == 1


def test_the_citation_is_of_this_version():
    assert loaded("docs", "CITATION.cff")["version"] == package.__version__


@pytest.mark.filterwarnings("ignore:subprocess:ResourceWarning")  # nobody waits for a browser
def test_pages_open_in_the_browser_where_asked(bench, monkeypatch):
    opener = Path("bin") / "xdg-open"
    opener.parent.mkdir()
    opener.write_text('#!/bin/sh\nprintf %s "$1" > opened\n')
    opener.chmod(0o755)
    monkeypatch.setenv("PATH", f"{opener.parent.resolve()}{os.pathsep}{os.environ['PATH']}")
    write_document(Path("out"), page_full_of("x"))
    assert bench("report", "out", "--script", "pages.js", "--open")[0] == 0
    until = time.monotonic() + 20.0
    while not Path("opened").exists() and time.monotonic() < until:
        time.sleep(0.02)
    assert Path("opened").read_text() == str((Path("out") / "report.html").resolve())
