"""How tests run side by side: a numeric thread a process, in one process what shares a fixture, one browser in each."""

import os
import shutil
from contextlib import contextmanager
from pathlib import Path
from pickle import dumps, loads

import pytest
from hypothesis import HealthCheck, settings
from xdist.scheduler import LoadScopeScheduling

import bench.jobs.each
from bench.jobs.process import raised

#: Folders whose work ends no process: this one does it, which saves the start of one for each file, joint or run.
SOUND = ("docs", "export", "faults", "gate", "joints", "plant", "report", "servos", "trace", "validation", "view")
#: Files that share a fixture of the session, by its name; every other file goes its own way.
TOGETHER = {
    "truths": tuple(f"tests/effects/test_{name}.py" for name in ("agreement", "model_file")),
    "lab": ("tests/course/",),
}

ROOT = Path(__file__).parent
ON_THIS_MACHINE = bench.jobs.each._on_this_machine
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
FLAGS += ["--disable-sync"]

# before NumPy is loaded: the threads of several processes would fight over the cores
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

# a busy machine is no failure
settings.register_profile("unhurried", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("unhurried")


class Sharing(LoadScopeScheduling):
    """Files side by side, but for those that share."""

    def _split_scope(self, nodeid: str) -> str:
        shared = (fixture for fixture, files in TOGETHER.items() if nodeid.startswith(files))
        return next(shared, super()._split_scope(nodeid))


def pytest_xdist_make_scheduler(config, log):
    return Sharing(config, log)


def pytest_xdist_auto_num_workers(config):
    """None beside this process where a measurement would suffer, or somebody reads along with `-s`."""
    alone = config.option.capture == "no" or config.option.benchmark_only
    return 0 if alone else None


def here(work, waiting, *_):
    """Pieces of work one after the other in this process, by pickles as in one of their own."""
    work = loads(dumps(work))
    for place, item in waiting:
        sent = dumps(item)
        try:
            result = loads(dumps(work(loads(sent))))
        except Exception as error:
            result = raised(error)
        yield place, result


@pytest.fixture(scope="module", autouse=True)
def watched(request):
    with pytest.MonkeyPatch.context() as patch:
        if request.path.relative_to(ROOT).parts[0] in SOUND:
            patch.setenv("SERVOBENCH_WATCHED", "1")
            patch.setattr(bench.jobs.each, "_on_this_machine", here)
        yield


@pytest.fixture
def worker_processes(monkeypatch):
    """Pieces of work are done in processes of their own, as without these tests."""
    monkeypatch.setattr(bench.jobs.each, "_on_this_machine", ON_THIS_MACHINE)


@pytest.fixture(scope="session")
def browser():
    if CHROMIUM is None:
        pytest.skip("needs chromium (apt-get install chromium)")
    playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright (pip install -e '.[dev]')")
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@contextmanager
def opening(browser):
    """Opens a file in a browser without a network; a complaint of the page, or anything it asks for, is a failure."""
    contexts, complaints = [], []

    def open_page(path, width=1280, **options):
        context = browser.new_context(viewport={"width": width, "height": 900}, offline=True, **options)
        context.set_default_timeout(0.0)  # a busy machine is no failure
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("dialog", lambda dialog: (complaints.append(f"dialog {dialog.message}"), dialog.dismiss()))
        page.on("requestfailed", lambda request: complaints.append(f"asked for {request.url[:80]}"))
        page.goto(path.resolve().as_uri())
        undrawn = page.locator("[data-folded], .graph:not(:has(canvas))")
        undrawn.first.wait_for(state="detached")  # its numbers are unpacked in turns of their own
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert complaints == []


@pytest.fixture
def opened(browser):
    with opening(browser) as open_page:
        yield open_page
