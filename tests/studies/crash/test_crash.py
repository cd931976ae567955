"""A few kills of one command, and what the long run (`python -m tests.studies.crash`) judges by."""

import gzip
import re
import shlex

import pytest

from tests.hostile import ROOT
from tests.studies.crash.__main__ import options
from tests.studies.crash.commands import COMMANDS
from tests.studies.crash.kills import EACH, Trial
from tests.studies.crash.look import left, whole


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    (tmp_path / "trial").mkdir()
    return tmp_path / "trial"


def test_kills_leave_whole_files_and_a_run_to_the_end_puts_everything_right(folder):
    tally = Trial(COMMANDS["export"], folder).killed(EACH, float("inf"))
    assert tally.faults == []
    assert tally.kills.total() + tally.missed >= EACH
    assert tally.ended > 0


def test_a_kill_just_before_the_output_takes_its_name_leaves_it_under_way_and_the_next_run_removes_it(folder):
    trial = Trial(COMMANDS["export"], folder)
    naming = trial.pace.steps - 1  # the last one removes what is not there any more
    assert trial.kill("step", (naming - 0.5) / trial.pace.steps)
    assert len(left(trial.out)) == 2  # the file and its lock
    trial.end(clear=False)
    assert trial.tally.faults == []


def test_the_page_has_commands_that_there_are():
    page = (ROOT / "docs" / "robustness.md").read_text(encoding="utf-8")
    lines = re.findall(r"^python -m tests\.studies\.crash(.*)$", page, re.MULTILINE)
    assert lines
    for line in lines:
        options().parse_args(shlex.split(line))
    for name in COMMANDS:
        assert f"| `{name}` |" in page


@pytest.mark.parametrize(
    ("name", "good"),
    [
        ("x.json", b'{"a": 1}'),
        ("x.toml", b"a = [\n1]"),
        ("x.xml", b"<a>1</a>"),
        ("x.csv.gz", gzip.compress(b"1\n", mtime=0)),
        ("x.png", b"\x89PNG IEND\xaeB`\x82"),
        ("x.pdf", b"%PDF\n%%EOF"),
        ("x.html", b"<html></html>"),
        ("x.py", b"print(1)"),
        ("x.csv", b"1,2\n"),
    ],
)
def test_half_a_file_is_distinguished_from_a_whole_one(tmp_path, name, good):
    path = tmp_path / name
    for content, is_whole in ((good, True), (good[:-1], False), (b"", False)):
        path.write_bytes(content)
        assert whole(path) is is_whole
