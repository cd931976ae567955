"""The commands and the example of docs/report.md run as they stand."""

import re
import shlex
from pathlib import Path

from bench.assets import asset
from bench.report.publish import read_document

MANUAL = (Path(__file__).resolve().parents[2] / "docs" / "report.md").read_text(encoding="utf-8")


def test_the_commands_of_the_manual_run(bench, tmp_path):
    (tmp_path / "rig.toml").write_bytes(asset("data", "rigs", "sh30701p.toml").read_bytes())
    (block,) = re.findall(r"```sh\n(.*?)```", MANUAL, re.DOTALL)
    for line in block.splitlines():
        status, _, err = bench(*shlex.split(line)[1:])
        assert status == 0, err
    page = read_document(tmp_path / "found" / "report.json")
    assert page.verdict.startswith("Cogging torque was missing")
    assert "amplitude 0.05" in page.answers["What was missing?"]
    assert page.tone == "sure"
    for written in (
        "found/report.html",
        "result/identification.pdf",
        "replay.html",
        "simulated.html",
        "inspected.html",
        "pages.js",
    ):
        assert (tmp_path / written).stat().st_size > 1000


def test_the_example_of_the_manual_writes_a_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (block,) = re.findall(r"```python\n(.*?)```", MANUAL, re.DOTALL)
    exec(compile(block, "docs/report.md", "exec"), {})
    assert "Nothing has changed." in (tmp_path / "axis7" / "report.html").read_text(encoding="utf-8")
