"""The page of a check: the verdict first, every comparison worst first, and by how many margins it differs."""

import re
from dataclasses import replace

import pytest
from matplotlib import pyplot

from bench.errors import InputError
from bench.report.check import check_document
from bench.report.document import Chart, Intervals, Paragraph, Points, Table
from bench.report.html import html
from tests.baseline.states import named, state
from tests.baseline.test_compare import checked
from tests.report.conftest import blocks
from tests.report.test_page import HOSTILE

COGGING = named("cogging_torque", 0.03, amplitude=0.05, harmonic=6.0)


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


def with_runs(of, name, each):
    """A state whose quantity is of several recordings."""
    known = replace(of.quantities[name], value=sum(each) / len(each), recordings=len(each), spread=1e-4, each=each)
    return replace(of, quantities={**of.quantities, name: known})


def test_each_quantity_is_drawn_over_the_runs_against_the_bounds_of_the_baseline():
    name, before, after = "coulomb_friction_torque", (0.0601, 0.0599, 0.06, 0.0602, 0.0598), (0.07, 0.072)
    found = checked(with_runs(state(), name, before), with_runs(state(), name, after))
    page = check_document(found, "x")
    (chart,) = blocks(page, Chart)
    assert len(chart.panels) == len([one for one in found.comparisons if one.margin > 0.0])
    first = chart.panels[0]
    assert (first.y_label, first.note, first.counted) == ("Coulomb friction torque / N·m", "changed", True)
    drawn = {one.name: one for one in first.series}
    band, judged = drawn["baseline ± margin"], drawn["judged, with its interval"]
    assert (band.low[0], band.high[0]) == pytest.approx((0.06 * 0.97, 0.06 * 1.03))
    assert (drawn["its runs"].x, drawn["its runs"].y) == ((1.0, 2.0, 3.0, 4.0, 5.0), before)
    assert (drawn["runs now"].x, drawn["runs now"].y) == ((6.0, 7.0), after)
    (worst,) = (one for one in found.comparisons if one.name == name)
    assert (judged.x, judged.y) == ((6.5,), pytest.approx((0.071,)))
    assert (judged.low[0], judged.high[0]) == pytest.approx([0.06 + end for end in worst.difference95])
    assert judged.low[0] > band.high[0]  # which is why it is called changed
    single = {one.name for one in chart.panels[1].series}
    assert "its runs" not in single and "judged, with its interval" in single


def test_a_check_is_plotted_by_quantity():
    found, axes = checked(state(), state({"moment_of_inertia": 0.98})), pyplot.figure().subplots()
    assert found.plot("moment_of_inertia", ax=axes) is axes
    assert axes.get_ylabel() == "moment of inertia / kg·m²"
    assert len(found.plot("runs")) == len(found.plot("differences", "runs")) - 1
    assert found.plot().get_xlabel() == "difference over margin"
    with pytest.raises(InputError, match="allowed: differences, moment_of_inertia, "):
        found.plot("inertia", ax=axes)
    pyplot.close("all")


def test_what_lies_far_beyond_its_margin_does_not_hide_the_rest():
    page = check_document(checked(state(), state({"moment_of_inertia": 3.0})), "x")
    (chart,) = blocks(page, Intervals)
    assert chart.spans[0].value > chart.limits[1]
    assert html(page).count('class="hole"') == 1


def test_what_differs_beside_the_axis_is_reported():
    other_rig = replace(state(), rig={"kind": "rotary", "motor.torque_constant": "0.9"})
    same, other, rig = (check_document(checked(state(), now), "x") for now in (state(), state(duration=3.0), other_rig))
    assert any("are those of the baseline" in one.text for one in blocks(same, Paragraph))
    assert any("duration" in item for one in blocks(other, Points) for item in one.items)
    assert any("torque_constant" in item for one in blocks(rig, Points) for item in one.items)
    assert list(rig.answers.values())[-1].startswith("Make a new baseline")


def test_text_of_a_baseline_is_text():
    before = replace(state(), provenance={HOSTILE: [HOSTILE, {"file": HOSTILE, "sha256": None}]}, verdict=HOSTILE)
    made = html(check_document(checked(before, state()), HOSTILE))
    assert "<script" not in made
    assert re.search("baseline: .*&lt;script&gt;", made)


def test_models_are_reported_without_recordings():
    found = checked(state(), state())
    model = replace(found.now, gaps={}, conditions={}, source="model")
    page = check_document(replace(found, baseline=model, now=model, false_alarm_rate=0.0), "x")
    assert [section.key for section in page.sections] == ["comparisons", "conditions"]
    assert any("neither is fitted to a recording" in one.text for one in blocks(page, Paragraph))
    assert "without noise" in list(page.answers.values())[2]
