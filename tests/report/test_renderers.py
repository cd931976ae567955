"""Renderers know no result: a document as text on a terminal and in Markdown, as a figure, and JSON without nan."""

import json
import math
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import BytesIO, TextIOWrapper

import numpy as np
import pytest

from bench.errors import UndeterminedError
from bench.gate.check import Check
from bench.parameter import Parameter
from bench.report import figures
from bench.report.document import (
    Chart,
    Code,
    Document,
    HeatMap,
    Intervals,
    Panel,
    Paragraph,
    Picture,
    Points,
    Section,
    Span,
    series,
    table,
)
from bench.report.html import MARGIN, Ruler, drawn, line
from bench.report.publish import markdown
from bench.report.serial import known, picked, serialised
from bench.report.terminal import rendered, show, writable

NUMBERS = table(
    "numbers", ("of", "value>", "why~"), [("inertia", "(1.3100 ± 0.0012)·10⁻³", "because"), ("a|b", "−2", "")]
)
LINE = series("speed", "line", "ink", np.array([1.0, 10.0, 100.0]), np.array([1.0, 2.0, 0.0]))


def test_a_terminal_shows_the_headline_the_answers_and_all_but_details(capsys):
    shown = NUMBERS, Paragraph(text="a paragraph"), Points(items=("one", "two")), Code(text="[trace.columns]")
    sections = (
        Section(key="shown", heading="shown", blocks=shown),
        Section(key="left", heading="left", blocks=(Paragraph(text="a detail"),), detail=True),
    )
    said = {"title": "t", "subject": "a subject", "verdict": "A verdict.", "answers": {"How sure?": "Very."}}
    show(Document(**said, tone="sure", sections=sections))
    out = capsys.readouterr().out
    there = (
        "a subject",
        "A verdict.",
        "How sure?",
        "Very.",
        "numbers",
        "inertia",
        "a paragraph",
        "- one",
        "[trace.columns]",
    )
    assert [word for word in (*there, "a detail", "left") if word in out] == [*there]


def test_a_terminal_that_has_ascii_alone_gets_letters():
    with redirect_stdout(TextIOWrapper(BytesIO(), encoding="ascii")):
        assert writable("(1.31 ± 0.01)·10⁻³ kg·m²") == "(1.31 +- 0.01)*10**-3 kg*m**2"
        assert writable("−2\N{NO-BREAK SPACE}Ω") == "-2 ohm"


def test_what_only_a_page_can_show_is_left_out():
    heat = HeatMap(caption="c", corner="hidden", rows=("a",), columns=("a",), counts=((1,),))
    assert rendered(heat, 80) is None
    assert markdown(heat) == ""


def test_markdown_of_a_table_sets_numbers_to_the_right_and_ends_no_cell():
    assert markdown(NUMBERS).splitlines() == [
        "## numbers",
        "",
        "| of | value | why |",
        "| --- | ---: | --- |",
        "| inertia | (1.3100 ± 0.0012)·10⁻³ | because |",
        "| a\\|b | −2 |  |",
    ]
    assert markdown(Code(text="a = 1")) == "```\na = 1\n```"


def test_a_rulers_ends_and_middle():
    across = Ruler(0.0, 10.0, 100.0, 200.0)
    assert [across(value) for value in (0.0, 5.0, 10.0)] == [100.0, 150.0, 200.0]
    log = Ruler(1.0, 100.0, 100.0, 200.0, log=True)
    assert [log(value) for value in (1.0, 10.0, 100.0)] == [100.0, 150.0, 200.0]
    assert [label for _, label in Ruler(0.5, 2000.0, 0.0, 1.0, log=True).ticks()] == ["1", "10", "100", "1000"]
    for values, ends in (((1.0, 100.0), (100.0**-MARGIN, 100.0 * 100.0**MARGIN)), ((3.0,), (1.5, 6.0))):
        found = Ruler.around(values, 0.0, 1.0, log=True)
        assert (found.low, found.high) == pytest.approx(ends)


def places(path):
    """Points of a path of steps (n, 2)."""
    start, steps = path.removeprefix("M").split("l")
    every = [[float(value) for value in point.split(",")] for point in (start, *steps.split())]
    return np.cumsum(every, axis=0)


def test_a_path_in_steps_goes_through_its_points():
    points = np.round(np.random.default_rng(1).uniform(0.0, 760.0, (500, 2)), 1)
    points[1] = points[0] + 0.1  # a step below one has no zero before its point, and one of ten has its own
    points[2] = points[1] + [10.0, -0.5]
    np.testing.assert_allclose(places(line([*map(tuple, points)])), points, atol=1e-6)


def test_panels_with_labels_of_their_own_have_scales_of_their_own():
    """On one scale, a panel of 0 to 1 beside one of 0 to 100 takes a hundredth of the height; stacked, all of it."""
    small, large = (series("x", "line", "ink", np.arange(2.0), top * np.arange(2.0)) for top in (1.0, 100.0))

    def heights(*labels):
        panels = tuple(
            Panel(x_label="x", y_label=y, series=(one,)) for y, one in zip(labels, (small, large), strict=True)
        )
        points = [places(placed.marks[0].line) for placed in drawn(Chart(title="t", alternative="a", panels=panels))]
        return [abs(ends[0][1] - ends[1][1]) for ends in points]

    beside, stacked = heights("", ""), heights("one", "other")
    assert beside[0] == pytest.approx(0.01 * beside[1], abs=0.2)
    assert stacked[0] == pytest.approx(stacked[1]) == pytest.approx(beside[1])


def test_a_logarithmic_panel_draws_what_is_positive():
    (placed,) = drawn(Chart(title="t", alternative="a", panels=(Panel(x_label="x", log=True, series=(LINE,)),)))
    assert len(places(placed.marks[0].line)) == 2


def test_a_picture_has_every_part_in_its_place(tmp_path):
    span = Span(name="row", colour="ink", value=2.0, low=1.0, high=3.0)
    intervals = Intervals(
        title="i", alternative="a", label="of it", right=(0.5, 1.5), limits=(0.5, 5.0), spans=(span,), log=True
    )
    stacked = Chart(title="stack", alternative="a", panels=(Panel(x_label="x", y_label="$", series=(LINE,)),))
    beside = Chart(
        title="b", alternative="a", y_label="y", panels=tuple(Panel(x_label=f"x {k}", series=(LINE,)) for k in range(5))
    )
    picture = Picture(name="p", title="a title", rows=((intervals, intervals, NUMBERS), (stacked,), (beside,)))
    figures.save(figures.drawn(picture), tmp_path / "p.svg")
    text = (tmp_path / "p.svg").read_text(encoding="utf-8")
    for words in ("a title", "of it", "stack", "x 4", "(1.3100 ± 0.0012)"):
        assert words in text
    assert text.count(">row<") == 1  # the second of the same rows leaves their names to the first


@dataclass(frozen=True)
class Result:
    """A typed result."""

    checks: tuple[Check, ...]
    parameter: Parameter
    values: np.ndarray
    rest: float


RESULT = Result(
    (Check("a", "pass", "found", "allowed", "advice", unanswerable=True),),
    Parameter(1.0, "N", math.nan, (-math.inf, math.inf)),
    np.array([1.0, 2.0]),
    3.0,
)


def test_a_typed_result_is_its_fields_as_json():
    assert json.loads(serialised({"result": RESULT})) == {
        "result": {
            "checks": [{"name": "a", "status": "pass", "found": "found", "allowed": "allowed", "advice": "advice"}],
            "parameter": {"value": 1.0, "unit": "N", "std_error": None, "ci95": [None, None]},
            "values": [1.0, 2.0],
            "rest": 3.0,
        }
    }
    assert picked(RESULT, "rest", "values") == {"rest": 3.0, "values": [1.0, 2.0]}


def test_only_what_may_be_unknown_is_null():
    assert json.loads(serialised({"x": known(math.nan), "y": known(1.0)})) == {"x": None, "y": 1.0}
    with pytest.raises(UndeterminedError, match=r"x cannot be determined: it came out as nan"):
        serialised({"x": math.nan})
