"""A page as data: it comes back from its file as it was, whatever its text holds is text, and damage is reported."""

import base64
import html as entities
import json
import re
import zlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.errors import InputError
from bench.report.document import (
    Chart,
    Document,
    Downloads,
    File,
    Heading,
    HeatMap,
    Intervals,
    ModelRun,
    Moving,
    Panel,
    Paragraph,
    Points,
    Samples,
    Section,
    Series,
    Span,
    Table,
    TimeCurve,
    TimeGraph,
    TimePanel,
)
from bench.report.html import html
from bench.report.publish import DATA, HTML, read_document, write_document

HOSTILE = "<script>alert(1)</script>\"'&{{ 7*7 }}</style>-->"


def full_of(text, kind, **given):
    """A block with this text wherever one can stand that is not given."""
    texts = {name: text for name, field in kind.model_fields.items() if field.annotation is str}
    return kind(**texts | given)


def page_full_of(text):
    """A page with one of everything, and this text wherever a text can stand."""
    grid = {"start": 0.0, "step": 1.0, "count": 2}
    samples = Samples(offset=0.0, scale=1.0, low="AAABAA==", high=None)
    curves = (
        full_of(text, TimeCurve, role="measured", choice=None, samples=samples),
        full_of(text, TimeCurve, role="model", choice=0, samples=samples),
    )
    runs = (full_of(text, ModelRun, apart=samples),) * 2
    moved = {"low": 0.0, "high": 1.0, "position": "AAAAAAAAgD8=", "runs": runs}
    series = full_of(text, Series, style="line", colour="ink", x=(0.0, 1.0), y=(0.0, 1.0))
    span = full_of(text, Span, colour="ink", value=3.0, low=-1.0, high=4.0)
    columns = full_of(text, Heading), full_of(text, Heading, number=True)
    blocks = (
        full_of(text, Paragraph),
        Points(items=(text,)),
        full_of(text, Table, columns=columns, rows=((text, text),)),
        full_of(text, TimeGraph, **grid, choices=(text, text), panels=(full_of(text, TimePanel, curves=curves),)),
        *(full_of(text, Moving, turns=turns, ghost=text, **grid, **moved) for turns in (True, False)),
        full_of(text, Chart, panels=(full_of(text, Panel, series=(series,)),)),
        full_of(text, HeatMap, rows=(text, text), columns=(text,), counts=((1,), (0,))),
        full_of(text, Intervals, right=(-1.0, 1.0), limits=(-2.0, 2.0), spans=(span,)),
        Downloads(files=(full_of(text, File, media="text/plain"),)),
    )
    section = full_of(text, Section, key="all", blocks=blocks)
    return full_of(text, Document, tone="open", answers={text: text}, sections=(section,), origin=(text,))


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
    """Deflated where the page has a script."""
    page = page_full_of("µ <&>\n")
    (found,) = re.findall(r'data-content="([^"]*)" data-media="text/plain"', html(page))
    assert zlib.decompress(base64.b64decode(found)).decode() == "µ <&>\n"
    still = tuple(block for block in page.blocks if block.kind == "downloads")
    section = page.sections[0].model_copy(update={"blocks": still})
    (found,) = re.findall(
        r'href="data:text/plain;base64,([^"]*)"', html(page.model_copy(update={"sections": (section,)}))
    )
    assert base64.b64decode(found).decode() == "µ <&>\n"


@settings(max_examples=30)
@given(text=st.text(max_size=40))
def test_a_page_comes_back_from_its_json(text):
    page = page_full_of(text)
    assert Document.model_validate_json(page.model_dump_json()) == page


def test_a_page_made_anew_is_the_same(bench, tmp_path):
    write_document(tmp_path / "out", page_full_of(HOSTILE))
    before = (tmp_path / "out" / HTML).read_bytes()
    (tmp_path / "out" / HTML).unlink()
    assert bench("report", "out") == (0, "wrote out/report.html\n", "")
    assert (tmp_path / "out" / HTML).read_bytes() == before
    assert read_document(tmp_path / "out" / DATA) == page_full_of(HOSTILE)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda page: page | {"tone": "blue"}, ["report.json: tone", "'blue'", "'sure', 'open' or 'refused'"]),
        (lambda page: page | {"extra": 1}, ["report.json: extra"]),
        (lambda page: {}, ["report.json: ", "required"]),
        (lambda page: page | {"page": "bench.page/9"}, ["report.json: page", "bench.page/1"]),
        (lambda page: json.loads(json.dumps(page).replace('"step": 1.0', '"step": 0.0')), ["step"]),
        # found by fuzzing: whatever stood there stood in the message, line breaks and all
        (lambda page: json.loads(json.dumps(page).replace('"paragraph"', '"a\\nb"')), ["sections.0.blocks.0: found "]),
        (None, ["found no report.json"]),
    ],
)
def test_damage_is_reported_in_one_line(bench, tmp_path, change, words):
    write_document(tmp_path / "out", page_full_of("x"))
    data = tmp_path / "out" / DATA
    changed = change and json.dumps(change(json.loads(data.read_text(encoding="utf-8"))))
    data.unlink() if changed is None else data.write_text(changed, encoding="utf-8")
    status, out, err = bench("report", "out")
    assert (status, out, err.count("\n"), len(err) < 700) == (2, "", 1, True), err
    assert not [word for word in words if word not in err], err
    assert bench("report", "nowhere").status == 2


def test_a_page_of_an_earlier_version_is_read(bench, tmp_path):
    """What its parts came to have since then has a neutral value."""
    write_document(tmp_path / "out", page_full_of("x"))
    since = {"y_label": "x", "log": False, "bins": None}
    content = json.loads((tmp_path / "out" / DATA).read_text(encoding="utf-8"))
    for block in content["sections"][0]["blocks"]:
        for part in (block, *(block.get("panels", ()) if block["kind"] == "chart" else ())):
            for key in since if part is not block or block["kind"] == "intervals" else ():
                part.pop(key, None)
    (tmp_path / "out" / DATA).write_text(json.dumps(content), encoding="utf-8")
    assert bench("report", "out")[0] == 0


CELLS = Table(caption="", columns=(Heading(heading="a"), Heading(heading="b")), rows=(("1", "2"),))
DOTS = Series(name="", style="dots", colour="ink", x=(1.0, 2.0), y=(1.0, 2.0), low=(0.0, 1.0), high=(2.0, 3.0))
GRAPH = Chart(title="", alternative="", panels=(Panel(x_label="", series=(DOTS,)),))
FOREST = Intervals(title="", alternative="", label="", right=(0.0, 0.0), limits=(-1.0, 1.0), spans=())
COUNTS = HeatMap(caption="", corner="", rows=("a",), columns=("a", "b"), counts=((1, 2),))


@pytest.mark.parametrize(
    ("part", "old", "new"),
    [
        (CELLS, '["1","2"]', '["1"]'),
        (GRAPH, '"high":[2.0,3.0]', '"high":[2.0]'),
        (GRAPH, '"y":[1.0,2.0]', '"y":[1.0]'),
        (FOREST, '"limits":[-1.0,1.0]', '"limits":[1.0,1.0]'),
        (FOREST, '"limits":[-1.0,1.0]', '"limits":[-1e308,1e308]'),
        (COUNTS, "[[1,2]]", "[[1]]"),
        (GRAPH, '"panels":[', '"panels":[],"was":['),
    ],
)
def test_data_that_no_page_can_show_is_refused(tmp_path, part, old, new):
    """Each ended with status 70, found by damaging data of pages at random."""
    text = page(part)
    assert old in text
    (tmp_path / DATA).write_text(text)
    html(read_document(tmp_path / DATA))
    (tmp_path / DATA).write_text(text.replace(old, new))
    with pytest.raises(InputError, match="allowed"):
        read_document(tmp_path / DATA)


def test_numbers_that_have_no_place_are_left_out(tmp_path):
    (tmp_path / DATA).write_text(page(GRAPH).replace("[1.0,2.0]", "[1.0,1e308]"))
    assert "<svg" in html(read_document(tmp_path / DATA))


def page(part):
    section = Section(key="a", heading="", blocks=(part,))
    return Document(title="", subject="", verdict="", tone="sure", answers={}, sections=(section,)).model_dump_json()
