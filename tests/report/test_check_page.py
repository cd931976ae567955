"""The page of a check: the verdict first, every comparison worst first, and by how many margins it differs."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from bench.report.check import check_document
from bench.report.document import Intervals, Paragraph, Points, Table
from bench.report.html import html
from bench.trace.write import write
from tests.baseline.states import named, state
from tests.baseline.test_command import again
from tests.baseline.test_compare import checked
from tests.report.test_page import HOSTILE

BASE = ("--rig", "rig.toml", "--baseline", "base.toml")
COGGING = named("cogging_torque", 0.03, amplitude=0.05, harmonic=6.0)


def blocks(page, kind):
    return [block for section in page.sections for block in section.blocks if isinstance(block, kind)]


@pytest.mark.parametrize(
    ("now", "verdict", "tone"),
    [
        (state(), "The same: ", "sure"),
        (
            state({"coulomb_friction_torque": 1.1}),
            "Changed: Coulomb friction torque rose from 0.06 ",
            "refused",
        ),
        (state({"coulomb_friction_torque": 1.035}), "Undecided: ", "open"),
        (state(effects=[COGGING], verdict="explained"), "Changed: Cogging torque (harmonic 6) appeared", "refused"),
    ],
)
def test_the_verdict_comes_first(now, verdict, tone):
    page = check_document(checked(state(), now), "now against before")
    assert page.verdict.startswith(verdict)
    assert page.tone == tone


def test_comparisons_stand_worst_first_and_the_chart_counts_in_margins():
    found = checked(state(), state({"moment_of_inertia": 0.98}))
    page = check_document(found, "x")
    (chart,), table = blocks(page, Intervals), blocks(page, Table)[0]
    assert (table.rows[0][0], table.rows[0][-1], table.marked) == ("moment of inertia", "changed", (0,))
    assert len(table.rows) == len(found.comparisons)
    first = chart.spans[0]
    assert first.name == "moment of inertia"
    assert first.value == pytest.approx(-0.02 / 0.005)  # 2 % less, and half a per cent does not matter
    assert first.low < first.value < first.high < -1.0


def test_what_lies_far_beyond_its_margin_does_not_hide_the_rest():
    page = check_document(checked(state(), state({"moment_of_inertia": 3.0})), "x")
    (chart,) = blocks(page, Intervals)
    assert chart.spans[0].value > chart.limits[1]
    assert html(page).count('class="hole"') == 1


def test_what_differs_beside_the_axis_is_reported():
    same = check_document(checked(state(), state()), "x")
    other = check_document(checked(state(), state(duration=3.0)), "x")
    rig = check_document(
        checked(state(), replace(state(), rig={"kind": "rotary", "motor.torque_constant": "0.9"})), "x"
    )
    assert any("are those of the baseline" in one.text for one in blocks(same, Paragraph))
    assert any("duration" in item for one in blocks(other, Points) for item in one.items)
    assert any("torque_constant" in item for one in blocks(rig, Points) for item in one.items)
    assert list(rig.answers.values())[-1].startswith("Make a new baseline")


def test_text_of_a_baseline_is_text():
    before = replace(state(), provenance={HOSTILE: [HOSTILE, {"file": HOSTILE, "sha256": None}]}, verdict=HOSTILE)
    made = html(check_document(checked(before, state()), HOSTILE))
    assert "<script" not in made
    assert re.search("baseline: .*&lt;script&gt;", made)


def test_the_command_writes_it(bench):
    write(again(1), "before.csv")
    assert bench("check", "before.csv", *BASE, "--update", "--without-names")[0] == 0
    write(again(2), "now.csv")
    status, out, _ = bench("check", "now.csv", *BASE, "--report", "check.html")
    assert status == 0
    assert "wrote check.html" in out
    page = Path("check.html").read_text(encoding="utf-8")
    assert "The same: " in page
    assert "before.csv" in page
    assert bench("check", "now.csv", *BASE, "--report", "check.txt")[0] == 2
    assert bench("check", "now.csv", *BASE, "--update", "--report", "check.html")[0] == 2


def test_models_are_reported_without_recordings():
    found = checked(state(), state())
    model = replace(found.now, gaps={}, conditions={}, source="model")
    page = check_document(replace(found, baseline=model, now=model, false_alarm_rate=0.0), "x")
    assert [section.key for section in page.sections] == ["comparisons", "conditions"]
    assert any("neither is fitted to a recording" in one.text for one in blocks(page, Paragraph))
    assert "without noise" in list(page.answers.values())[2]
