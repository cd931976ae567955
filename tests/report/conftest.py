"""What tests of pages share: a diagnosed folder whose names are hostile."""

import os
from pathlib import Path

import pytest

from bench.trace.write import write
from tests.diagnosis.command import RIG, started
from tests.diagnosis.conftest import bench
from tests.diagnosis.test_commands import run_of, with_unbalance

__all__ = ["bench"]

#: A rig and a recording with such names are shown, and run nowhere; a file's name has no slash.
RIG_NAME, TRACE_NAME = "<script>alert(1)</script>", "<script>alert(1)<img src=x onerror=alert(2)>.csv"


def blocks(page, kind):
    """Parts of a page that are of a kind."""
    return [block for section in page.sections for block in section.blocks if isinstance(block, kind)]


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


@pytest.fixture
def sound(opened):
    """Opens a page on a phone in the dark and in a wide light window; it is as wide, and axe finds nothing."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="needs axe-playwright-python")

    def opened_soundly(path):
        for width, scheme in ((390, "dark"), (1280, "light")):
            page = opened(path, width, color_scheme=scheme, bypass_csp=True)
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            found = axe.Axe().run(page).response["violations"]
            assert [(one["id"], [node["html"] for node in one["nodes"]][:3]) for one in found] == []
        return page

    return opened_soundly
