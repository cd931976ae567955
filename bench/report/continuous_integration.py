"""A check for servers that run checks: JUnit XML, GitHub's annotations and summary, GitLab's code quality report.

JUnit: a test case for each comparison, which every CI server reads; `changed` is a failure, `undecided` is skipped with
the reason, `same` passes. GitHub: workflow commands on standard output
(https://docs.github.com/actions/reference/workflow-commands-for-github-actions), at most ten of them, and a table of
all in the step's summary. GitLab: JSON (https://docs.gitlab.com/ci/testing/code_quality/#code-quality-report-format).
Text from files stays text in all of them.
"""

from __future__ import annotations

import hashlib
import html
import json
import re
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

from bench.baseline.check import Checked
from bench.comparison.difference import CHANGED, SAME, UNDECIDED, Comparison
from bench.files import read_text
from bench.names import plain
from bench.report.check import described, headline

#: Characters that XML 1.0 does not have at all, escaped or not.
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
#: Annotations of a step that GitHub shows.
MOST = 10
#: Characters of Markdown markup and mentions, other than in HTML entities.
_MARKUP = re.compile(r"[\\`*_\[\]|~@!#](?!#?\w+;)")
#: What ends a workflow command, and in addition what ends one of its properties.
_ESCAPED = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A"})
_ENDING = str.maketrans({":": "%3A", ",": "%2C"})


def junit(checked: Checked, title: str) -> str:
    """Every comparison, and all of it in a sentence, as JUnit XML."""
    results = [one.result for one in checked.comparisons]
    failures, skipped = str(results.count(CHANGED)), str(results.count(UNDECIDED))
    numbers = {"tests": str(len(results)), "failures": failures, "errors": "0", "skipped": skipped}
    suites = ElementTree.Element("testsuites", {"name": "bench check", **numbers})
    suite = ElementTree.SubElement(suites, "testsuite", {"name": xml_text(title), **numbers})
    for one in checked.comparisons:
        case = ElementTree.SubElement(suite, "testcase", {"classname": "bench.check", "name": xml_text(one.name)})
        sentence = xml_text(described(one, checked))
        if one.result == CHANGED:
            ElementTree.SubElement(case, "failure", {"message": sentence, "type": "changed"}).text = sentence
        elif one.result == UNDECIDED:
            ElementTree.SubElement(case, "skipped", {"message": sentence})
    ElementTree.SubElement(suite, "system-out").text = xml_text(headline(checked))
    ElementTree.indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, encoding="unicode") + "\n"


def xml_text(given: str) -> str:
    """Text that XML can hold: control characters written out."""
    return _NO_XML.sub("", plain(given))


def github_lines(checked: Checked, baseline: Path) -> list[str]:
    """Workflow commands for what is not the same, worst first, at the baseline's lines."""
    levels = {CHANGED: "error", UNDECIDED: "warning"}
    return [
        command(levels[one.result], sentence, {"file": str(baseline), "line": str(line)})
        for one, sentence, line in _not_same(checked, baseline)[:MOST]
    ]


def command(level: str, message: str, properties: Mapping[str, str]) -> str:
    """A workflow command, escaped as GitHub's own toolkit does (`@actions/core`, command.ts)."""
    given = {**properties, "title": "bench check"}.items()
    fields = ",".join(f"{key}={plain(value).translate(_ESCAPED | _ENDING)}" for key, value in given)
    return f"::{level} {fields}::{plain(message).translate(_ESCAPED)}"


def github_summary(checked: Checked, title: str) -> str:
    """Markdown of all comparisons for the step's summary."""
    rows = ["| quantity | baseline | now | margin | unit | |", "|---|---|---|---|---|---|"]
    for one in checked.comparisons:
        numbers = ("-" if value is None else f"{value:.4g}" for value in (one.baseline, one.now, one.margin))
        rows.append(f"| {' | '.join(map(_cell, [one.name, *numbers, one.unit, one.result]))} |")
    items = [f"- {_cell(described(one, checked))}" for one in checked.comparisons if one.result != SAME]
    return "\n".join([f"### bench check: {_cell(title)}", "", _cell(headline(checked)), "", *rows, "", *items, ""])


def _cell(text: str) -> str:
    """Text in a cell of a table: no markup, no end of the cell or of the line."""
    flat = html.escape(" ".join(plain(text).split()))
    return _MARKUP.sub(lambda match: f"&#{ord(match[0])};", flat)


def gitlab_report(checked: Checked, baseline: Path) -> str:
    """Code quality report: an issue for each comparison that is not the same."""
    issues = [
        {
            "description": plain(sentence),
            "check_name": f"bench check: {plain(one.name)}",
            "fingerprint": hashlib.sha256(f"{baseline}:{one.name}".encode("utf-8", "backslashreplace")).hexdigest(),
            "severity": "major" if one.result == CHANGED else "info",
            "location": {"path": plain(str(baseline)), "lines": {"begin": line}},
        }
        for one, sentence, line in _not_same(checked, baseline)
    ]
    return json.dumps(issues, indent=2)


def _not_same(checked: Checked, baseline: Path) -> list[tuple[Comparison, str, int]]:
    """What to look at, in words, and the line of the baseline at which its table begins."""
    lines = read_text(baseline, "a baseline").splitlines()
    heads = {line: number for number, line in reversed(list(enumerate(lines, start=1))) if line.startswith("[")}
    return [
        (one, described(one, checked), heads.get(f"[quantities.{one.name}]", 1))
        for one in checked.comparisons
        if one.result != SAME
    ]
