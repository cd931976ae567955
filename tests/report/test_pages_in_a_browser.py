"""Pages of check, fleet and validate in a browser: no complaint, as wide as the window, and nothing that axe finds."""

import pytest

from bench.report.check import check_document
from bench.report.publish import write_html
from tests.baseline.states import state
from tests.baseline.test_compare import checked
from tests.report import test_fleet_page, test_validation_page
from tests.report.test_page import HOSTILE

PAGES = {
    "check": lambda: check_document(checked(state(), state({"moment_of_inertia": 3.0}, duration=3.0)), HOSTILE),
    "fleet": lambda: test_fleet_page.page_of(
        test_fleet_page.fleet_of(
            test_fleet_page.stepped(3, 10, [1]), {0: test_fleet_page.refused(HOSTILE)}, HOSTILE.replace("{", "(") + "{}"
        )
    ),
    "validate": lambda: test_validation_page.page_of(
        [test_validation_page.covered(quantity, 90, 100) for quantity in ("inertia", "viscous", "coulomb")],
        test_validation_page.named(
            1,
            9,
            {HOSTILE: {"refused": 3, "backlash": 2}, "backlash": {"backlash": 4}, "nothing": {"nothing missing": 5}},
        ),
        HOSTILE,
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
