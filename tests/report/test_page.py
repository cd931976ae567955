"""A page as data: it comes back from its file as it was, whatever its text holds is text, and damage is told."""

import html as entities
import json
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.report.page.blocks import (
    Answer,
    Axes,
    Chart,
    Column,
    Downloads,
    File,
    HeatMap,
    Intervals,
    Page,
    Paragraph,
    Points,
    Section,
    Series,
    Span,
    Table,
)
from bench.report.page.folder import DATA, HTML, read_page, write_page
from bench.report.page.render import html
from bench.report.page.scripted import Curve, Motion, Panel, Samples, TimeGraph

HOSTILE = "<script>alert(1)</script>\"'&{{ 7*7 }}</style>-->"


def page_full_of(text):
    """A page with one of everything, and this text wherever a text can stand."""
    samples = Samples(offset=0.0, scale=1.0, low="AAABAA==", high=None)
    curve = Curve(name=text, role="measured", choice=None, samples=samples)
    chosen = Curve(name=text, role="model", choice=0, samples=samples)
    series = Series(name=text, style="line", colour="ink", x=(0.0, 1.0), y=(0.0, 1.0))
    blocks = (
        Paragraph(text=text),
        Points(items=(text,)),
        Table(caption=text, columns=(Column(heading=text), Column(heading=text, number=True)), rows=((text, text),)),
        TimeGraph(
            title=text,
            alternative=text,
            start=0.0,
            step=1.0,
            count=2,
            choices=(text, text),
            panels=(Panel(label=text, unit=text, curves=(curve, chosen)),),
        ),
        *(
            Motion(
                title=text,
                alternative=text,
                turns=turns,
                unit=text,
                ghost=text,
                start=0.0,
                step=1.0,
                count=2,
                low=0.0,
                high=1.0,
                position="AAAAAAAAgD8=",
                apart="AAAAAAAAAAA=",
            )
            for turns in (True, False)
        ),
        Chart(
            title=text,
            alternative=text,
            y_label=text,
            y_unit=text,
            panels=(Axes(x_label=text, x_unit=text, note=text, series=(series,)),),
        ),
        HeatMap(caption=text, corner=text, rows=(text, text), columns=(text,), counts=((1,), (0,))),
        Intervals(
            title=text,
            alternative=text,
            label=text,
            unit=text,
            right=(-1.0, 1.0),
            limits=(-2.0, 2.0),
            spans=(Span(name=text, colour="ink", value=3.0, low=-1.0, high=4.0),),
        ),
        Downloads(files=(File(name=text, about=text, media="text/plain", content=text),)),
    )
    section = Section(key="all", heading=text, blocks=blocks)
    answer = Answer(question=text, answer=text)
    return Page(
        title=text, subject=text, verdict=text, tone="open", answers=(answer,), sections=(section,), origin=(text,)
    )


def test_text_is_text_wherever_it_stands():
    made = html(page_full_of(HOSTILE))
    assert "<script>alert(1)" not in made
    assert made.count("<script") == 4  # data of the graph and of both motions, and the program
    assert made.count("</style>") == 1
    assert "49" not in re.sub(r"<script.*?</script>|<style.*?</style>", "", made, flags=re.DOTALL)
    assert made.count(entities.escape(HOSTILE, quote=False)[:24]) > 20


def test_what_turns_the_direction_of_text_is_written_out():
    assert "\u202e" not in re.sub(r"<script.*?</script>", "", html(page_full_of("a\u202eb")), flags=re.DOTALL)


def test_a_page_asks_for_nothing_from_anywhere():
    made = html(page_full_of("x"))
    program = re.sub(r"<script>.*?</script>", "", made, flags=re.DOTALL)
    assert "default-src &#39;none&#39;" in made
    assert not re.search(r"(src|href)=\"(?!data:|#)", program)
    assert "http" not in re.sub(r"<meta.*?>", "", program)


def test_a_file_inside_comes_out_as_it_was():
    import base64

    made = html(page_full_of("µ <&>\n"))
    (found,) = re.findall(r'href="data:text/plain;base64,([^"]*)"', made)
    assert base64.b64decode(found).decode() == "µ <&>\n"


@given(text=st.text(max_size=40))
def test_a_page_comes_back_from_its_json(text):
    page = page_full_of(text)
    assert Page.model_validate_json(page.model_dump_json()) == page


def test_a_page_made_anew_is_the_same(bench, tmp_path):
    write_page(tmp_path / "out", page_full_of(HOSTILE))
    before = (tmp_path / "out" / HTML).read_bytes()
    (tmp_path / "out" / HTML).unlink()
    assert bench("report", "out") == (0, "wrote out/report.html\n", "")
    assert (tmp_path / "out" / HTML).read_bytes() == before
    assert read_page(tmp_path / "out" / DATA) == page_full_of(HOSTILE)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda page: page | {"tone": "blue"}, ["report.json: tone", "'blue'", "'sure', 'open' or 'refused'"]),
        (lambda page: page | {"extra": 1}, ["report.json: extra"]),
        (lambda page: {}, ["report.json: ", "required"]),
        (lambda page: page | {"page": "bench.page/9"}, ["report.json: page", "bench.page/1"]),
    ],
)
def test_damage_is_told_in_one_line(bench, tmp_path, change, words):
    write_page(tmp_path / "out", page_full_of("x"))
    content = json.loads((tmp_path / "out" / DATA).read_text(encoding="utf-8"))
    (tmp_path / "out" / DATA).write_text(json.dumps(change(content)), encoding="utf-8")
    status, out, err = bench("report", "out")
    assert (status, out, err.count("\n")) == (2, "", 1)
    for word in words:
        assert word in err


def test_a_folder_without_a_page_is_told(bench, tmp_path):
    (tmp_path / "empty").mkdir()
    status, _, err = bench("report", "empty")
    assert (status, err.count("\n")) == (2, 1)
    assert "found no report.json" in err
    status, _, err = bench("report", "nowhere")
    assert (status, err.count("\n")) == (2, 1)


def test_a_damaged_graph_is_no_page(bench, tmp_path):
    write_page(tmp_path / "out", page_full_of("x"))
    text = (tmp_path / "out" / DATA).read_text(encoding="utf-8").replace('"step":1.0', '"step":0.0')
    (tmp_path / "out" / DATA).write_text(text, encoding="utf-8")
    status, _, err = bench("report", "out")
    assert (status, "step" in err) == (2, True)
