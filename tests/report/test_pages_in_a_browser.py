"""Pages of check, fleet and validate in a browser: no complaint, as wide as the window, nothing that axe finds."""

import numpy as np
import pytest

from bench.course.result import chart, curve, panel
from bench.report.check import check_document
from bench.report.document import Document, Section
from bench.report.publish import write_html
from tests.baseline.states import state
from tests.baseline.test_compare import checked
from tests.report.test_fleet_page import fleet_of, refused, stepped
from tests.report.test_fleet_page import page_of as fleet_page
from tests.report.test_page import HOSTILE
from tests.report.test_validation_page import covered, named
from tests.report.test_validation_page import page_of as validation_page

CONFUSED = {
    HOSTILE: {"refused": 3, "backlash": 2},
    "backlash": {"backlash": 4},
    "nothing": {"nothing missing": 5},
}


def of_fleet():
    values, name = stepped(3, 10, [1]), HOSTILE.replace("{", "(") + "{}"
    return fleet_page(fleet_of(values, {0: refused(HOSTILE)}, name))


PAGES = {
    "check": lambda: check_document(checked(state(), state({"moment_of_inertia": 3.0}, duration=3.0)), HOSTILE),
    "fleet": of_fleet,
    "validate": lambda: validation_page(
        [covered(quantity, 90, 100) for quantity in ("inertia", "viscous", "coulomb")], named(1, 9, CONFUSED), HOSTILE
    ),
}


@pytest.mark.parametrize("name", PAGES)
def test_a_page_opens_and_is_not_cut_on_paper(sound, tmp_path, name):
    """On A4 within its margins."""
    write_html(tmp_path / "page.html", PAGES[name]())
    page = sound(tmp_path / "page.html")
    assert page.locator("script").count() == (name == "fleet")  # what seeks in its rows
    assert "alert(1)" in page.locator("body").inner_text()
    page.set_viewport_size({"width": 688, "height": 900})
    page.emulate_media(media="print")
    assert page.evaluate("document.documentElement.scrollWidth") <= 688


#: Diagrams one above the other on a screen of 400 px: whole, and no label off it.
RIGHT = "[...document.querySelectorAll('figure svg, figure svg *')].map(e => e.getBoundingClientRect())"


def test_stacked_panels_fit_a_phone(opened, tmp_path):
    time = np.linspace(0.0, 6.0, 50)
    drawn = chart(
        "Stacked",
        panel("time / s", "error, backward / (1/s)", curve(time, 5e-4 * np.sin(time), "a"), curve(time, time, "b")),
        panel("time / s", "acceleration α / (rad/s²)", curve(time, -1.2e3 * np.sin(time))),
        panel("time / s", "error / (1/s)", curve(time, 2e-6 * np.sin(time))),
    )
    section = Section(key="one", heading="One", blocks=(drawn,))
    page = Document(title="t", subject="t", verdict="v", tone="sure", answers={}, sections=(section,))
    write_html(tmp_path / "page.html", page)
    shown = opened(tmp_path / "page.html", width=400)
    edges = shown.evaluate(f"{RIGHT}.map(r => [r.left, r.right])")
    assert len(edges) > 30
    assert min(left for left, _ in edges) >= 0.0
    assert max(right for _, right in edges) <= 400.0
    letters = shown.evaluate("[...document.querySelectorAll('svg text')].map(e => e.getBoundingClientRect().height)")
    assert min(letters) > 8.0  # to be read
