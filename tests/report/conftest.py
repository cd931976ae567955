"""What tests of pages share: a diagnosed folder whose names are hostile, and a browser without a network."""

import os
import shutil
from pathlib import Path

import pytest

from bench.trace.write import write
from tests.diagnosis.command import RIG, started
from tests.diagnosis.conftest import bench
from tests.diagnosis.test_commands import run_of, with_unbalance

__all__ = ["bench"]

#: A rig and a recording with such names are shown, and run nowhere; a file's name has no slash.
RIG_NAME, TRACE_NAME = "<script>alert(1)</script>", "<script>alert(1)<img src=x onerror=alert(2)>.csv"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
FLAGS += ["--disable-sync"]


@pytest.fixture(scope="session")
def found(tmp_path_factory):
    """Folder that `bench diagnose --out` wrote of an axis with an unbalance and a holdout, all of hostile names."""
    folder, before = tmp_path_factory.mktemp("page"), Path.cwd()
    run = started(folder)
    rig = RIG.replace('"axis"', f'"{RIG_NAME}"')
    (folder / "rig.toml").write_text(rig, encoding="utf-8")
    for seed, name in ((1, TRACE_NAME), (2, "holdout.csv")):
        write(with_unbalance(run_of(seed=seed, duration=4.0)), folder / name)
    try:
        assert run("diagnose", TRACE_NAME, "--rig", "rig.toml", "--holdout", "holdout.csv", "--out", "found") == 0
    finally:
        os.chdir(before)
    return folder / "found"


@pytest.fixture(scope="session")
def browser():
    if CHROMIUM is None:
        pytest.skip("needs chromium (apt-get install chromium)")
    playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright (pip install -e '.[dev]')")
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture
def opened(browser):
    """Opens a file in a browser without a network; a complaint of the page, or anything it asks for, is a failure."""
    contexts, complaints = [], []

    def open_page(path, width=1280, **options):
        context = browser.new_context(viewport={"width": width, "height": 900}, offline=True, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("dialog", lambda dialog: (complaints.append(f"dialog {dialog.message}"), dialog.dismiss()))
        page.on("requestfailed", lambda request: complaints.append(f"asked for {request.url[:80]}"))
        page.goto(path.resolve().as_uri())
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert complaints == []
