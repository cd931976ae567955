"""The page of a fleet: which axes need attention, what changed with its prediction band, and small."""

import dataclasses
import os
import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from bench.fleet.change_point import expected
from bench.fleet.evaluate import PlannedRecording
from bench.fleet.fleet import Fleet
from bench.fleet.manifest import Manifest
from bench.fleet.store import Store
from bench.fleet.summary import summarise
from bench.report.document import Chart, Table
from bench.report.fleet import AXES, CHARTS, DOTS, ROWS, SKETCHED, fleet_document, write_fleet
from bench.report.html import html
from bench.report.publish import write_html
from tests.fleet.test_summary import JOB, found
from tests.report.conftest import blocks
from tests.report.test_page import HOSTILE

BASIS = {"version": "0.1.0", "manifest_sha256": "abc", "options": {"diagnose": False}}
DAY = np.timedelta64(1, "D")
MISSING = {"status": "missing", "reason": "recording: no such file; give the path of a file"}
SEEK = """async (words) => { // how long until a frame shows what is sought - ms
  const input = document.querySelector(".seek input"), from = performance.now();
  input.value = words;
  input.dispatchEvent(new Event("input"));
  await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  return performance.now() - from;
}"""


def fleet_of(values, results=None, name="axis {}", dated=True, evaluated=0):
    """Axes (a,) recorded once a day, n times each, with inertias (a, n); `results`: of some rows, in their place."""
    count, each = values.shape
    rows = range(count * each)
    days = np.tile(np.datetime64("2026-03-02T06:00:00") + DAY * np.arange(each), count)
    columns = {
        "file": [f"{row}.csv" for row in rows],
        "rig": ["rig.toml"] * len(rows),
        "axis": [name.format(row // each) for row in rows],
        "time": days if dated else np.tile(np.arange(each, dtype=float), count),
    }
    manifest = Manifest(Path("fleet.csv"), pa.table(columns))
    planned = [PlannedRecording(f"{row:064x}", JOB, None, {"rig_sha256": "same"}) for row in rows]
    evaluations = [(results or {}).get(row, found(value, 1e-3)) for row, value in enumerate(values.ravel())]
    return Fleet(manifest, planned, evaluations, summarise(manifest, planned, evaluations), evaluated)


def stepped(count, each, changed, step=0.3):
    values = np.random.default_rng(1).normal(1.0, 0.01, (count, each))
    values[changed, each // 2 :] += step
    return values


def page_of(fleet):
    return fleet_document(fleet, BASIS)


def drawn(fleet):
    """Series of the one chart of a fleet's page, by their style, and its axes."""
    (axes,) = blocks(page_of(fleet), Chart)[0].panels
    return [[one for one in axes.series if one.style == style] for style in ("band", "dots")], axes


def write_pages(fleet, folder, results=True):
    """All pages of a fleet, and a manifest and results as old as they are."""
    fleet = dataclasses.replace(fleet, manifest=dataclasses.replace(fleet.manifest, path=folder / "fleet.csv"))
    if results:
        fleet.manifest.path.write_text("")
        for one in fleet.planned:
            path = Store(folder / "results").path(one.key)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("{}")
    write_fleet(folder, fleet, BASIS)


def refused(reason):
    return {"status": "refused", "reason": reason}


def test_who_needs_a_person_first_comes_first_with_the_reason():
    page = page_of(fleet_of(stepped(6, 10, [4]), {3: refused("too short")}))
    assert page.verdict == "1 of 6 axes changed; 1 more needs attention for another reason."
    assert page.tone == "refused"
    people = blocks(page, Table)[1]
    assert [row[0] for row in people.rows] == ["axis 4", "axis 0"]
    assert people.marked == (0,)
    assert "since 2026-03-07" in people.rows[0][1]
    assert people.rows[1][1] == "refused (1 of 10 recordings, the latest 3.csv): too short"
    assert next(iter(page.answers.values())).startswith("axis 4: ")


@pytest.mark.parametrize(
    ("fleet", "verdict", "tone"),
    [
        (fleet_of(stepped(3, 8, [])), "None of 3 axes changed, and none needs attention.", "sure"),
        (fleet_of(stepped(3, 8, []), {0: refused("x")}), "None of 3 axes changed, but 1 of 3 needs attention.", "open"),
        (fleet_of(np.ones((3, 1))), "No axis could be compared over time, and none needs attention.", "open"),
    ],
)
def test_where_nothing_changed_the_page_says_so(fleet, verdict, tone):
    page = page_of(fleet)
    assert (page.verdict, page.tone) == (verdict, tone)
    assert not blocks(page, Chart)


def test_a_change_is_drawn_over_time_outside_of_what_was_expected_before():
    values = stepped(3, 10, [1])
    ((before, after), (dots,)), axes = drawn(fleet_of(values))
    assert (axes.x_label, axes.x_unit) == ("time since 2026-03-02 06:00:00", "d")
    assert (dots.x, dots.y) == (tuple(range(10)), pytest.approx(values[1]))
    assert all(before.low[0] < value < before.high[0] for value in dots.y[:5])
    assert all(value > before.high[0] for value in dots.y[5:])
    assert all(after.low[0] < value < after.high[0] for value in dots.y[5:])
    assert after.x == (5.0, 9.0)
    _, undated = drawn(fleet_of(values, dated=False))
    assert (undated.x_label, undated.x_unit) == ("time", "")


@pytest.mark.parametrize("after", [1, 3])
def test_the_band_holds_the_next_recording_in_95_of_100_and_is_never_narrower_than_its_error(after):
    rng, trials, inside = np.random.default_rng(2), 4000, 0
    for _ in range(trials):
        values = rng.normal(1.0, 0.02, 5 + after)
        values[5:] += 0.5
        (low, high), _ = expected(values, np.full(values.size, 1e-4), 5)
        inside += low <= rng.normal(1.0, 0.02) <= high
    assert inside / trials == pytest.approx(0.95, abs=0.014)  # four standard deviations
    (low, high), _ = expected(np.array([1.0, 1.0, 2.0, 2.0]), np.full(4, 0.1), 2)
    assert high - low > 2.0 * 1.96 * 0.1


def test_names_are_text():
    page = page_of(fleet_of(stepped(2, 10, [1]), {0: refused(HOSTILE)}, name=HOSTILE.replace("{", "(") + " {}"))
    made = html(page)
    assert made.count("<script") == 1  # what seeks in rows
    assert "&lt;script&gt;alert(1)" in made


def test_a_large_fleet_is_a_small_page_that_says_what_it_leaves_out():
    values = stepped(1000, 12, np.arange(300))
    long = {row: refused("x" * 5000) for row in range(0, 12000, 12)}
    page = page_of(fleet_of(values, long, name="a" * 500 + "{}"))
    assert len(blocks(page, Chart)) == CHARTS
    dashboard, *tables = blocks(page, Table)
    assert len(dashboard.rows) == AXES == 1000
    assert all(len(table.rows) <= ROWS for table in tables)
    assert "the first 100 of 300" in "".join(table.caption for table in blocks(page, Table))
    assert len(html(page).encode()) < 1e6


def test_of_an_axis_recorded_a_thousand_times_those_around_the_change_are_drawn():
    fleet = fleet_of(stepped(1, 1000, [0]))
    (_, (dots,)), _ = drawn(fleet)
    assert (len(dots.x), dots.x[0], dots.x[-1]) == (DOTS, 400.0, 599.0)
    page = page_of(fleet)
    assert f"Of 1000 recordings the {DOTS} nearest" in blocks(page, Chart)[0].alternative
    assert len(html(page).encode()) < 1e6


def test_the_page_is_the_same_however_many_were_evaluated_now_and_leads_to_the_table():
    values = stepped(3, 10, [1])
    made = html(page_of(fleet_of(values)))
    assert made == html(page_of(fleet_of(values, evaluated=30)))
    assert '<a href="fleet.parquet">fleet.parquet</a>' in made


def test_every_axis_has_a_row_by_how_much_it_needs_a_person():
    (dashboard, *_) = blocks(page_of(fleet_of(stepped(6, 10, [4]), {3: refused("too short"), 59: MISSING})), Table)
    assert [row[0] for row in dashboard.rows] == [f"axis {k}" for k in (4, 5, 0, 1, 2, 3)]
    cells = {row[0]: row[1:5] for row in dashboard.rows}
    assert cells["axis 4"][:2] == ("inertia", dashboard.rows[0][2])
    assert re.fullmatch(r"\+\d+\s±\s\S+\s% since 2026-03-07 06:00:00, by chance < 0.1\s%", cells["axis 4"][1])
    assert [cells[f"axis {k}"][1:3] for k in (5, 0, 1)] == [("none", "missing"), ("none", "refused"), ("none", "–")]
    assert cells["axis 1"][3] == "0.997\xa0kg·m²\xa0±\xa00.2\xa0%"


def test_a_sketch_has_the_band_that_the_next_recording_is_expected_in():
    values = stepped(2, 60, [1])
    changed, calm = blocks(page_of(fleet_of(values)), Table)[0].sketches
    band, line, dot = calm
    assert (band.low[0], band.high[0]) == pytest.approx(expected(values[0], np.full(60, 1e-3))[0])
    assert line.y == pytest.approx(values[0, -SKETCHED:])
    assert dot.y == pytest.approx([values[0, -1]])
    assert [band.low[0] < changed[2].y[0] < band.high[0] for band in changed[:2]] == [True, False]
    assert [band.low[0] < changed[2].y[-1] < band.high[0] for band in changed[:2]] == [False, True]
    late = stepped(1, 100, [0])[:, ::-1]  # a step before what is in sight
    (sketch,) = blocks(page_of(fleet_of(late)), Table)[0].sketches
    assert [one.style for one in sketch] == ["band", "line", "dots"]
    assert (sketch[0].low[0], sketch[0].high[0]) == pytest.approx(expected(late[0], np.full(100, 1e-3), 50)[1])


def test_each_axis_and_each_recording_has_its_page(tmp_path, opened):
    fleet = fleet_of(stepped(2, 10, [1]), {3: refused("too short"), 4: MISSING})
    write_pages(fleet, tmp_path)
    page = opened(tmp_path / "fleet.html")
    page.click("tbody a:text-is('axis 1')")
    assert page.locator("h1").inner_text().startswith("Moment of inertia +")
    page.click("tbody tr:last-child a")
    assert page.locator("h1").inner_text() == "Inertia and friction are known and explain 99\xa0% of the effort."
    page.click("a:text-is('../../fleet.html')")
    page.click("tbody a:text-is('axis 0')")
    assert page.locator("tr.marked").count() == 2
    page.locator("tr.marked a").first.click()
    assert page.locator("h1").inner_text() == "Missing: no result."
    assert "no such file" in page.locator("main").inner_text()


def test_pages_are_written_again_only_where_a_result_or_the_manifest_is_newer(tmp_path):
    fleet = fleet_of(stepped(2, 3, []))
    write_pages(fleet, tmp_path)
    pages = sorted(tmp_path.rglob("*.html"))
    assert len(pages) == 1 + 2 + 6
    times = {path: path.stat().st_mtime_ns for path in pages}
    os.utime(next((tmp_path / "results").rglob("*.json")), ns=(2 * max(times.values()),) * 2)
    write_pages(fleet, tmp_path, results=False)
    again = {path: path.stat().st_mtime_ns for path in pages}
    assert {path.parent.name for path in pages if again[path] != times[path]} == {tmp_path.name, "axes", "00"}
    assert sum(again[path] != times[path] for path in pages) == 3


def test_rows_with_the_words_are_shown_of_a_thousand_axes(opened, tmp_path):
    write_html(tmp_path / "fleet.html", page_of(fleet_of(stepped(1000, 12, [4, 700]))))
    page = opened(tmp_path / "fleet.html")
    took = min(page.evaluate(SEEK, words) for words in ("axis 5", "axis 9 none", "axis 70 changed"))
    shown = page.locator("tbody tr:visible th").all_inner_texts()
    assert shown[:1] == ["axis 700"]
    assert page.locator(".seek output").inner_text() == "1 of 1000"
    print(f"\n1000 axes: {took:.0f} ms from a key to the frame")
