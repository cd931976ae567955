"""Pages in a browser, opened from a file without a network: they zoom, tell, are heard, and run nothing of a name."""

import json
import re

import numpy as np
import pytest

from bench.report import document as doc
from bench.report.over_time import Plotted, numbers_over, time_graph
from bench.report.publish import write_html
from tests.conftest import opening
from tests.report.conftest import RIG_NAME, TRACE_NAME


def range_of(page, graph=0):
    """First and last time in sight - s."""
    first, last = page.locator(".range").nth(graph).inner_text().removesuffix(" s").split(" to ")
    return float(first), float(last)


@pytest.fixture(scope="module")
def still(browser, found):
    """The page as it opens in a wide window, for tests that only read it."""
    with opening(browser) as opened:
        yield opened(found / "report.html", 1280)


def settled(page):
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def test_a_page_opens_without_a_complaint_in_either_scheme_and_names_are_text_everywhere(sound, found):
    page = sound(found / "report.html")
    assert page.locator(".graph canvas").count() == 8
    paper = "getComputedStyle(document.body).backgroundColor"
    assert page.evaluate(paper) == "rgb(255, 255, 255)"
    page.emulate_media(color_scheme="dark")
    assert page.evaluate(paper) != "rgb(255, 255, 255)"
    text = page.locator("body").inner_text()
    assert RIG_NAME in text
    assert TRACE_NAME in text
    assert page.title().startswith(RIG_NAME)
    assert page.locator("img").count() == 0
    assert page.locator("script:not([type])").count() == 1


def test_buttons_zoom_and_move_all_panels_together(opened, found):
    page = opened(found / "report.html")
    whole = range_of(page)
    assert whole == (0.0, pytest.approx(3.999))
    page.get_by_role("button", name="Zoom in").first.click()
    settled(page)
    inside = range_of(page)
    assert inside[1] - inside[0] == pytest.approx(2.0, abs=0.01)
    page.get_by_role("button", name="Later").first.click()
    settled(page)
    assert range_of(page)[0] == pytest.approx(inside[0] + 0.2 * 2.0, abs=0.01)
    assert range_of(page, 1) == pytest.approx((0.0, 3.999))
    page.get_by_role("button", name="whole").first.click()
    settled(page)
    assert range_of(page) == whole


def test_keys_do_what_buttons_do_and_tab_reaches_the_graph(opened, found):
    page = opened(found / "report.html")
    reached = []
    for _ in range(40):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.className || document.activeElement.tagName"))
        if reached[-1] == "graph":
            break
    assert reached[0] == "skip"
    assert reached[-1] == "graph"
    assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    for key, width in (("+", 2.0), ("+", 1.0), ("-", 2.0)):
        page.keyboard.press(key)
        settled(page)
        first, last = range_of(page)
        assert last - first == pytest.approx(width, abs=0.01)
    page.keyboard.press("ArrowRight")
    settled(page)
    assert range_of(page)[0] > first
    page.keyboard.press("0")
    settled(page)
    assert range_of(page) == (0.0, pytest.approx(3.999))


def test_the_mouse_zooms_moves_and_tells(opened, found):
    page = opened(found / "report.html")
    plot = page.locator(".u-over").first
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    x, y, wide = box["x"], box["y"] + 40, box["width"]
    page.mouse.move(x + 0.5 * wide, y)
    readouts = [page.locator(".readout").nth(k).inner_text() for k in range(4)]
    assert all("at 2.0" in readout or "at 1.99" in readout for readout in readouts)
    assert "simulated" in readouts[0]
    page.mouse.move(x + 0.25 * wide, y)
    page.mouse.down()
    page.mouse.move(x + 0.5 * wide, y, steps=4)
    page.mouse.up()
    settled(page)
    first, last = range_of(page)
    assert (first, last) == pytest.approx((1.0, 2.0), abs=0.02)
    page.keyboard.down("Shift")
    page.mouse.move(x + 0.5 * wide, y)
    page.mouse.down()
    page.mouse.move(x + 0.25 * wide, y, steps=4)
    page.mouse.up()
    page.keyboard.up("Shift")
    settled(page)
    assert range_of(page) == pytest.approx((1.25, 2.25), abs=0.02)
    page.mouse.wheel(0, -100)  # the graph has the focus, so that the page does not scroll
    settled(page)
    assert range_of(page)[1] - range_of(page)[0] == pytest.approx(0.8, abs=0.02)
    plot.dblclick()
    settled(page)
    assert range_of(page) == (0.0, pytest.approx(3.999))


def test_bins_that_are_dragged_over_or_reached_by_keys_shade_their_time_ranges(opened, found):
    """Of the time itself: bins of its panel are the time range."""
    page = opened(found / "report.html")
    panel, output = page.locator("svg[data-of=time]"), page.locator("form.bins output")
    page.locator("form.bins").wait_for(state="visible")
    assert output.inner_text() == ""
    share = """() => { // of the first graph's width that is shaded, at its top
        const canvas = document.querySelector(".graph canvas"), at = canvas.getBoundingClientRect();
        const over = document.querySelector(".u-over").getBoundingClientRect();
        const row = [over.left - at.left, over.top - at.top + 3, over.width, 1].map(Math.round);
        const pixels = canvas.getContext("2d").getImageData(...row).data;
        return pixels.filter((value, k) => k % 4 === 0 && value < 240 && pixels[k + 3] > 0).length / row[2];
    }"""
    panel.scroll_into_view_if_needed()
    place = panel.bounding_box()
    scale = place["width"] / 380.0
    ends = float(panel.get_attribute("data-low")), float(panel.get_attribute("data-high"))
    at = [place["x"] + scale * (58.0 + 310.0 * (t - ends[0]) / (ends[1] - ends[0])) for t in (1.0, 2.0)]
    page.mouse.move(at[0], place["y"] + 100.0)
    page.mouse.down()
    page.mouse.move(at[1], place["y"] + 100.0, steps=4)
    page.mouse.up()
    settled(page)
    text = re.fullmatch(r"time ([\d.]+) to ([\d.]+) s: ([\d.]+) s in \d+ time ranges?", output.inner_text())
    low, high, total = map(float, text.groups())
    assert (low, high) == pytest.approx((1.0, 2.0), abs=0.05)
    assert total == pytest.approx(1.0, abs=0.15)  # less the rows about standstill
    assert page.evaluate(share) == pytest.approx(total / 4.0, abs=0.07)
    panel.press("Enter")
    settled(page)
    first, last = range_of(page)
    assert low - 0.5 < first < last < high + 0.5
    assert page.evaluate("document.activeElement.className") == "graph"
    panel.press("Escape")
    settled(page)
    assert output.inner_text() == ""
    panel.press("End")
    assert panel.get_attribute("aria-valuetext") == output.inner_text() != ""
    assert panel.get_attribute("aria-valuenow") == panel.get_attribute("aria-valuemax")


def test_a_time_range_marks_its_bins(opened, found):
    page = opened(found / "report.html")
    marked = "() => [...document.querySelectorAll('svg[data-of=time] .shown')].map(one => one.getAttribute('d'))[0]"
    page.locator("svg[data-of=time] .shown[d='']").wait_for(state="attached")  # once numbers of bins are unpacked
    page.locator(".graph").first.press("+")
    settled(page)
    panel, (first, last) = page.locator("svg[data-of=time]"), range_of(page)
    low, high = float(panel.get_attribute("data-low")), float(panel.get_attribute("data-high"))
    times = [low + (float(x) - 58.0) / 310.0 * (high - low) for x in re.findall(r"M([\d.]+),", page.evaluate(marked))]
    assert len(times) > 10
    assert (min(times), max(times)) == pytest.approx((first, last), abs=0.1)
    page.locator(".graph").first.press("0")
    settled(page)
    assert page.evaluate(marked) == ""


def test_bins_of_a_section_mark_the_graph_of_that_section(opened, tmp_path):
    """As the joints of a robot have, in whose page each has a graph."""
    time, sections = np.arange(100.0), []
    for k in (1, 2):
        graph = time_graph("r", "a", time, [Plotted("speed", "rad/s", time, np.zeros(100))])
        dots = doc.series("gap", "dots", "ink", np.arange(4.0), np.arange(4.0))
        bins = numbers_over(graph, time, np.arange(100) // 25)
        chart = doc.Chart(title="t", alternative="a", panels=(doc.Panel(x_label="x", series=(dots,), bins=bins),))
        sections.append(doc.section(f"joint-{k}", f"joint {k}", chart, graph))
    page = doc.Document(title="t", subject="s", verdict="v", tone="sure", answers={}, sections=tuple(sections))
    write_html(tmp_path / "page.html", page)
    shown = opened(tmp_path / "page.html")
    shown.locator("#joint-2 svg[role=slider]").press("Home")
    shown.locator("#joint-2").get_by_role("button", name="next time range").click()
    settled(shown)
    assert range_of(shown, 0) == (0.0, 99.0)
    assert range_of(shown, 1)[1] < 80.0


def test_another_model_can_be_chosen_and_is_downloaded_as_it_was_written(opened, found):
    page = opened(found / "report.html", accept_downloads=True)
    residual = page.locator(".readout").nth(1)
    assert residual.inner_text().count("+ unbalance") == 1
    page.get_by_label("inertia and friction").first.check()
    assert ("+ unbalance" in residual.inner_text(), "inertia and friction" in residual.inner_text()) == (False, True)
    for name in ("model.toml", "model.xml", "diagnosis.json"):
        with page.expect_download() as download:
            page.get_by_role("link", name=name).click()
        assert download.value.suggested_filename == name
        assert download.value.path().read_bytes() == (found / name).read_bytes()


def test_every_picture_has_words_and_headings_are_in_order(still):
    page = still
    assert page.get_by_role("application").count() == 2
    assert page.get_by_role("slider").count() == 4
    for graph in page.get_by_role("application").all():
        assert "RMS" in graph.get_attribute("aria-label")
    for panel in page.locator("section .panels svg").all():
        assert "% of the gap" in panel.get_attribute("aria-label").replace("\N{NO-BREAK SPACE}", " ")
    levels = page.eval_on_selector_all("h1, h2, h3", "all => all.map(one => Number(one.tagName[1]))")
    assert levels[0] == 1
    assert set(levels[1:]) == {2}
    assert page.locator("table").count() == page.locator("table > caption").count()


def test_a_printed_page_is_light_with_its_graphs_on_paper(opened, found):
    """They are as high as on paper before its pages are counted: else as much as they shrink by comes out empty."""
    page = opened(found / "report.html", color_scheme="dark")
    heights = "[...document.querySelectorAll('.uplot')].map(one => one.offsetHeight)"
    tall = page.evaluate(heights)
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    low = page.evaluate(heights)
    page.emulate_media(media="print", color_scheme="dark")
    page.wait_for_timeout(200)
    assert page.evaluate(heights) == low
    assert sum(low) < 0.8 * sum(tall)
    assert page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--paper').trim()") == "#ffffff"
    assert not page.locator(".buttons").first.is_visible()
    assert page.locator(".graph canvas").first.is_visible()
    assert page.pdf(format="A4")[:4] == b"%PDF"


def test_pages_that_share_a_script_work_beside_it(opened, found, bench, tmp_path):
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "report.json").write_bytes((found / "report.json").read_bytes())
    status, out, err = bench("report", "one", "other", "--script", "shared.js")
    assert (status, err) == (0, "")
    assert out.splitlines() == ["wrote shared.js", "wrote one/report.html", "wrote other/report.html"]
    page = opened(tmp_path / "one" / "report.html")
    assert page.locator(".graph canvas").count() == 8
    alone = (found / "report.html").stat().st_size
    assert (tmp_path / "one" / "report.html").stat().st_size < alone - 50_000


def test_numbers_on_the_page_are_those_of_the_json(still, found):
    content = json.loads((found / "diagnosis.json").read_text(encoding="utf-8"))
    heading = still.get_by_role("heading", level=1).inner_text().replace("\N{NO-BREAK SPACE}", " ")
    gap = content["gap"]["torque"]["identify"]
    assert heading.startswith("Unbalance was missing; adding it removes ")
    assert f"{100 * (1 - gap['after'] / gap['before']):.0f} % of the torque gap" in heading
    text = still.locator("dl").inner_text().replace("\N{NO-BREAK SPACE}", " ")
    said = ["Moment of inertia?", "What was missing?", "How sure?", "Does it move like the axis now?"]
    said += [f"amplitude {content['effects'][0]['parameters']['amplitude']['value']:#.3g} N·m ±"]
    said += [f"{content['parameters']['moment_of_inertia']['value']:#.3g} kg·m²"]
    said += [f"{content['gap']['velocity']['holdout']['after']:.3g}"]
    assert [words for words in said if words not in text] == []


def test_what_was_missing_how_sure_and_the_picture_are_on_the_first_screen(still):
    for place in ("h1", "dl", ".glance figure:nth-child(1) svg", ".glance figure:nth-child(2) svg"):
        box = still.locator(f"{place} >> visible=true").last.bounding_box()
        assert box["y"] + box["height"] <= 900.0


def test_labels_of_an_axis_are_as_far_apart_as_they_say(opened, found):
    """Steps of 2.5*10**n want a digit more than their size has."""
    page = opened(found / "report.html")
    page.evaluate("""() => {
        const write = CanvasRenderingContext2D.prototype.fillText, seen = [];
        CanvasRenderingContext2D.prototype.fillText = function (text, ...at) {
            if (!seen.includes(this.canvas)) seen.push(this.canvas);
            window.written.push([seen.indexOf(this.canvas) + this.textAlign, text]);
            return write.call(this, text, ...at);
        };
        const clear = CanvasRenderingContext2D.prototype.clearRect;
        CanvasRenderingContext2D.prototype.clearRect = function (...box) {
            const canvas = seen.indexOf(this.canvas);
            window.written = (window.written || []).filter(([axis]) => parseInt(axis) !== canvas);
            return clear.call(this, ...box);
        };
    }""")
    graph, steps = page.locator(".graph").first, set()
    for _ in range(9):
        page.evaluate("window.written = []")
        graph.press("+")
        settled(page)
        axes = {}
        for axis, text in page.evaluate("window.written"):
            if re.fullmatch(r"[−\d.]+(e[−+]?\d+)?", text):
                axes.setdefault(axis, []).append(float(text.replace("−", "-")))
        for values in axes.values():
            apart = np.diff(values)
            if apart.size > 1:
                np.testing.assert_allclose(apart, apart[0], rtol=1e-6)
                steps.add(f"{abs(apart[0]):.1e}"[:3])
    assert "2.5" in steps
