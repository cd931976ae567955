"""Every page answers on its first screen what to do next, by commands that tests/faults/test_advice.py runs."""

import ast

import numpy as np
import pytest

from bench.effects.present import Present
from bench.friction_map import friction_map
from bench.plant.simulate import simulate
from bench.report.document import Document
from bench.report.drive import limits
from bench.report.fleet import NEXT, FleetPages
from bench.report.friction import friction
from bench.report.html import html
from bench.rig.rig import load_rig
from tests.faults.advised import SPEEDS
from tests.report.test_fleet_page import BASIS, MISSING, fleet_of, page_of, stepped
from tests.sources import ROOT, nodes

FLEET = fleet_of(stepped(2, 10, [1]), {0: MISSING})
PAGES = FleetPages(FLEET, BASIS)


def lab():
    return load_rig("sh30701p")


def steady_speeds(folder):
    for name, text in SPEEDS.items():
        (folder / name).write_text(text)
    return friction_map([str(folder / name) for name in SPEEDS], lab())


def weighted():
    return simulate(lab(), "fast_reversals", effects=[Present.of("unbalance", {"amplitude": 0.1})], duration=1.0)


DOCUMENTS = {
    "fleet": lambda _: page_of(FLEET),
    "axis that changed": lambda _: PAGES.axis(FLEET.summary.by_need()[0]),
    "axis with a concern": lambda _: PAGES.axis(FLEET.summary.by_need()[1]),
    "recording": lambda _: PAGES.recording(1),
    "recording without a result": lambda _: PAGES.recording(0),
    "friction": lambda folder: friction(steady_speeds(folder), "axis", "`bench plan --rig rig.toml --out motion.csv`"),
    "limits": lambda _: limits(weighted().trace, lab()),
}


@pytest.mark.parametrize("kind", DOCUMENTS)
def test_a_page_answers_what_was_missing_how_sure_and_what_next(kind, tmp_path):
    answers = DOCUMENTS[kind](tmp_path).answers
    assert answers["What next?"].endswith((".", "`"))
    if kind not in ("recording without a result", "axis with a concern"):
        assert "How sure?" in answers


def test_who_needs_attention_first_is_what_to_look_at_next():
    changed, missing = FLEET.summary.by_need()
    assert (changed.name, missing.name) == ("axis 1", "axis 0")
    assert page_of(FLEET).answers["What next?"] == PAGES.following(changed)
    assert "`bench diagnose 15.csv --rig rig.toml --out found`" in PAGES.following(changed)
    assert PAGES.following(missing) == NEXT["missing"]
    assert "run the same command again" in page_of(fleet_of(np.ones((2, 3)))).answers["What next?"]


def test_no_page_of_a_result_is_without_answers():
    empty = [
        path.name
        for path in sorted((ROOT / "bench" / "report").glob("*.py"))
        for node in nodes(path)
        if isinstance(node, ast.keyword) and node.arg == "answers" and ast.unparse(node.value) == "{}"
    ]
    assert empty == []


def test_what_can_be_typed_is_shown_as_code_and_any_other_text_as_it_is():
    answers = {"What next?": "`bench fleet <m>.csv` again, or ` alone"}
    page = html(Document(title="t", subject="s", verdict="v", tone="open", answers=answers, sections=()))
    assert "<dd><code>bench fleet &lt;m&gt;.csv</code> again, or ` alone</dd>" in page
