"""The site is built without a warning, asks nothing of a network when it is read, and anybody can read it."""

import re
import shutil
import subprocess
import sys

import pytest

from tests.docs.pages import DOCS, ROOT

READ = ("index", "reference/effects/backlash", "notebooks/hidden_effect", "method", "python", "commands", "diagnose")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Built from a copy, so that nothing is left beside the sources."""
    pytest.importorskip("sphinx", reason="needs Sphinx (pip install -e '.[docs]')")
    home = tmp_path_factory.mktemp("site")
    shutil.copytree(DOCS, home / "docs", ignore=shutil.ignore_patterns("_build", "reference", "jupyter_execute"))
    for path in ROOT.glob("*.md"):
        shutil.copy(path, home)
    built(home)
    return home / "site" / "html"


def built(home, *options):
    """Builds it without a word."""
    line = [sys.executable, "-m", "sphinx", "-q", "-W", "-j", "auto", "-b", "html", *options, "docs", "site/html"]
    done = subprocess.run(line, cwd=home, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_a_notebook_that_ran_does_not_run_again(site):
    """Read anew, none would get far in the time that it has."""
    built(site.parents[1], "-D", "nb_execution_timeout=1", "-E")


@pytest.mark.slow
def test_every_page_is_there_and_fetches_nothing(site):
    pages = {str(path.relative_to(site).with_suffix("")) for path in site.rglob("*.html")}
    assert {*READ, "reference/commands/identify", "contributing", "validation"} <= pages
    for path in site.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r'src="(?:https?:)?//|<link[^>]+href="(?:https?:)?//', text), path
    for path in site.rglob("*.css"):
        assert not re.search(r"url\(['\"]?(?:https?:)?//", path.read_text(encoding="utf-8")), path


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", READ)
def test_a_page_opens_without_a_network_and_is_accessible(name, scheme, site, opened):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="needs axe (pip install -e '.[dev]')")
    page = opened(site / f"{name}.html", color_scheme=scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= 1280
    # its look into style sheets is for rules that ask of media, and a browser lets no file read another
    found = axe.Axe().run(page, options={"preload": False}).response["violations"]
    assert [one["id"] for one in found if one["impact"] in ("serious", "critical")] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", READ)
def test_a_page_fits_a_phone(name, site, opened):
    page = opened(site / f"{name}.html", width=390)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
