"""A check as annotations of GitHub and GitLab; text from files stays text in both.

GitHub: workflow commands on standard output (https://docs.github.com/actions/reference/workflow-commands-for-github-actions),
at most ten of them, and a table of all in the step's summary. GitLab: a code quality report as JSON
(https://docs.gitlab.com/ci/testing/code_quality/#code-quality-report-format).
"""

from __future__ import annotations

import hashlib
import html
import json
import re
from collections.abc import Mapping
from pathlib import Path

from bench.baseline.check import Checked
from bench.baseline.wording import headline
from bench.comparison.difference import CHANGED, Comparison
from bench.files import read_text
from bench.names import plain
from bench.report.check import sentences

#: Annotations of a step that GitHub shows.
MOST = 10
_LEVELS = {CHANGED: "error"}
_SEVERITIES = {CHANGED: "major"}
#: Characters of Markdown markup and mentions, other than in HTML entities.
_MARKUP = re.compile(r"[\\`*_\[\]|~@!#](?!#?\w+;)")


def github_lines(checked: Checked, baseline: Path) -> list[str]:
    """Workflow commands, worst first."""
    places = _lines(baseline)
    return [
        command(_LEVELS.get(one.result, "warning"), sentence, {"file": str(baseline), "line": str(_place(one, places))})
        for one, sentence in sentences(checked)[:MOST]
    ]


def command(level: str, message: str, properties: Mapping[str, str]) -> str:
    """A workflow command, escaped as GitHub's own toolkit does (`@actions/core`, command.ts)."""
    fields = ",".join(f"{key}={_property(value)}" for key, value in {**properties, "title": "bench check"}.items())
    return f"::{level} {fields}::{_data(message)}"


def _data(text: str) -> str:
    return plain(text).replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")


def summary(checked: Checked, title: str) -> str:
    """Markdown of all comparisons for the step's summary."""
    rows = ["| quantity | baseline | now | margin | unit | |", "|---|---|---|---|---|---|"]
    for one in checked.comparisons:
        numbers = ("-" if value is None else f"{value:.4g}" for value in (one.baseline, one.now, one.margin))
        rows.append(f"| {' | '.join(map(_cell, [one.name, *numbers, one.unit, one.result]))} |")
    items = [f"- {_cell(sentence)}" for _, sentence in sentences(checked)]
    return "\n".join([f"### bench check: {_cell(title)}", "", _cell(headline(checked)), "", *rows, "", *items, ""])


def _cell(text: str) -> str:
    """Text in a cell of a table: no markup, no end of the cell or of the line."""
    flat = html.escape(" ".join(plain(text).split()))
    return _MARKUP.sub(lambda match: f"&#{ord(match[0])};", flat)


def gitlab_report(checked: Checked, baseline: Path) -> str:
    """Code quality report: an issue for each comparison that is not the same."""
    places = _lines(baseline)
    return json.dumps(
        [
            {
                "description": plain(sentence),
                "check_name": f"bench check: {plain(one.name)}",
                "fingerprint": hashlib.sha256(f"{baseline}:{one.name}".encode("utf-8", "backslashreplace")).hexdigest(),
                "severity": _SEVERITIES.get(one.result, "info"),
                "location": {"path": plain(str(baseline)), "lines": {"begin": _place(one, places)}},
            }
            for one, sentence in sentences(checked)
        ],
        indent=2,
    )


def _lines(baseline: Path) -> dict[str, int]:
    """Number of the line at which each table of the baseline begins, by the table's head."""
    lines = read_text(baseline, "a baseline").splitlines()
    return {line: number for number, line in reversed(list(enumerate(lines, start=1))) if line.startswith("[")}


def _place(one: Comparison, places: Mapping[str, int]) -> int:
    return places.get(f"[quantities.{one.name}]", 1)
