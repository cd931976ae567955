"""The page of a validation: how often intervals hold the truth, with bounds, and whether names are right."""

from dataclasses import replace

import pytest

from bench.report.document import HeatMap, Intervals, Table
from bench.report.html import html
from bench.report.parts import provenance
from bench.report.validation import confusion as matrix_of
from bench.report.validation import validation
from bench.validation.coverage import LEVELS, Coverage, Naming, Share
from bench.validation.validate import Validation
from tests.report.conftest import blocks
from tests.report.test_page import HOSTILE

NONE = Share(0, 0)


def covered(quantity, count, of, by="identify", group="nulls", whole=True):
    inside = tuple(Share(count, of) for _ in LEVELS)
    return Coverage(by, group, quantity, of, of, 0.0, 1e-3, 1e-3, 2e-3, 4e-3, 2.0, inside, whole)


def named(false, of, confusion=None):
    shares = dict.fromkeys(("nulls", "silent", "refused"), NONE)
    return Naming(
        **shares,
        nulls_by_motion={},
        false=Share(false, of),
        exact=Share(of - false, of),
        named={"backlash": Share(of - false, of)},
        falsely={},
        confusion=confusion or {},
    )


def page_of(coverage, naming=None, command="bench validate"):
    return validation(Validation((), tuple(coverage), naming), provenance(None, [], {"seed": 1}), command, own=False)


@pytest.mark.parametrize(
    ("count", "of", "tone"),
    [
        (950, 1000, "sure"),
        (880, 1000, "open"),  # too narrow
        (19, 20, "open"),  # too few
    ],
)
def test_the_tone_is_that_of_the_coverage(count, of, tone):
    page = page_of([covered("inertia", count, of)])
    assert page.tone == tone
    percent = f"{100 * count / of:.0f}"
    assert page.verdict.replace("\N{NO-BREAK SPACE}", " ") == (
        f"Intervals of 95 % contain the true value of inertia in {percent} %, of {of} runs with nothing hidden."
    )


def test_a_false_name_is_reported_in_the_verdict():
    good, bad = (page_of([covered("inertia", 950, 1000)], named(false, 200)) for false in (0, 1))
    assert good.verdict.endswith("none of 200 diagnosed runs have a false name.")
    assert bad.verdict.endswith("1 of 200 diagnosed runs has a false name.")
    assert (good.tone, bad.tone) == ("sure", "open")


def test_the_chart_has_each_quantity_with_its_bounds_by_group():
    groups = [
        covered(quantity, count, 100, group=group, whole=group == "nulls")
        for quantity, count in (("inertia", 95), ("coulomb", 60))
        for group in ("nulls", "motion: chirp")
    ]
    charts = blocks(page_of([*groups, covered("inertia", 90, 100, by="diagnose")]), Intervals)
    assert [chart.title for chart in charts] == ["Inertia, J.", "Coulomb friction, K_0."]
    assert [span.name for span in charts[0].spans] == ["identify: nulls", "identify: motion: chirp", "diagnose: nulls"]
    first = charts[0].spans[0]
    low, high = Share(95, 100).bounds
    assert (first.low, first.value, first.high) == pytest.approx((100 * low, 95.0, 100 * high))
    assert charts[0].limits[0] <= 100 * Share(60, 100).bounds[0]
    assert charts[0].right == (95.0, 95.0)


def test_what_is_reported_in_the_place_of_a_name_is_reported_most_frequent_first():
    page = page_of([], named(1, 9, {"backlash": {"refused": 1, "backlash": 8}, "nothing": {"nothing missing": 5}}))
    confusion = next(table for table in blocks(page, Table) if "is hidden, or none" in table.caption)
    assert confusion.rows == (("backlash", "backlash 8, refused 1"), ("nothing", "nothing missing 5"))
    assert page.verdict.startswith("No run determines a quantity; 1 of 9")
    (by_effect,) = (table for table in blocks(page, Table) if table.caption == "By effect")
    assert [(row[0], row[2:]) for row in by_effect.rows] == [("backlash", ("8/9", "0"))]


def test_names_given_are_a_matrix_whose_right_answers_lie_on_its_diagonal():
    confusion = {
        "backlash": {"refused": 1, "backlash": 8},
        "unbalance": {"backlash": 2, "torque_offset": 1},
        "nothing": {"nothing missing": 5, "backlash": 1},
    }
    matrix = matrix_of(confusion)
    assert matrix.rows == ("backlash", "unbalance", "nothing")
    assert matrix.columns == ("backlash", "unbalance", "nothing missing", "refused", "torque offset")
    assert matrix.counts == ((8, 0, 0, 1, 0), (2, 0, 0, 0, 1), (1, 0, 5, 0, 0))
    (heat,) = blocks(page_of([], named(3, 18, confusion)), HeatMap)
    assert heat == matrix
    made = html(page_of([], named(3, 18, confusion)))
    assert '<td class="right" style="--share: 89%">8</td>' in made
    assert '<td style="--share: 67%">2</td>' in made
    assert '<td class="right" style="--share: 0%"></td>' in made


def test_text_is_text():
    page = page_of([replace(covered("inertia", 9, 10), group=HOSTILE)], command=HOSTILE)
    assert "<script" not in html(page)
