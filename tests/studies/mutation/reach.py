"""Which functions of the bench each test runs, so that a mutant is shown to the tests that can see it.

A plugin of pytest (`-p tests.studies.mutation.reach`): it profiles each test with the fixtures that it uses, and writes
what ran into the folder that SERVOBENCH_REACH names, a file of JSON for each file of tests. Threads and processes that
a test starts are not seen, nor what an earlier test has left in a cache.
"""

from __future__ import annotations

import cProfile
import json
import os
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from _pytest.fixtures import FixtureDef

from tests.studies.mutation.mutants import ROOT

REACH = "SERVOBENCH_REACH"
BENCH = f"{ROOT / 'bench'}{os.sep}"

_profile = cProfile.Profile()
#: What runs now, innermost last: functions seen so far.
_running: list[set[str]] = []
_of_fixtures: dict[FixtureDef, set[str]] = defaultdict(set)
#: Of each file: seconds and functions of each of its tests.
_of_files: dict[str, dict[str, tuple[float, list[str]]]] = defaultdict(dict)


def _harvest() -> None:
    """Give what was profiled since the last time to all that run."""
    _profile.disable()
    entries = [entry.code for entry in _profile.getstats() if not isinstance(entry.code, str)]
    ran = {
        f"{code.co_filename[len(str(ROOT)) + 1 :]}:{code.co_firstlineno}"
        for code in entries
        if code.co_filename.startswith(BENCH)
    }
    for functions in _running:
        functions |= ran
    _profile.clear()


@contextmanager
def _collecting(functions: set[str]) -> Iterator[None]:
    """What runs within is counted for these, too."""
    _harvest()
    _running.append(functions)
    _enable()
    try:
        yield
    finally:
        _harvest()
        _running.pop()
        if _running:
            _enable()


def _enable() -> None:
    try:
        _profile.enable()
    except ValueError:  # a test that profiles by itself has the interpreter's only profiler
        return


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: FixtureDef) -> Iterator[None]:
    """A fixture is made."""
    with _collecting(_of_fixtures[fixturedef]):
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """A test runs, with what it sets up."""
    ran: set[str] = set()
    began = time.process_time()
    with _collecting(ran):
        found = yield
    info = getattr(item, "_fixtureinfo", None)
    for several in () if info is None else info.name2fixturedefs.values():
        for each in several:
            ran |= _of_fixtures[each]
    path = str(Path(item.path).relative_to(ROOT))
    _of_files[path][item.nodeid] = time.process_time() - began, sorted(ran)
    return found


def pytest_sessionfinish() -> None:
    """Write all of it: functions once, and their numbers for each test."""
    for path, tests in _of_files.items():
        functions = sorted({each for _, ran in tests.values() for each in ran})
        number = {each: k for k, each in enumerate(functions)}
        told = {name: [seconds, [number[each] for each in ran]] for name, (seconds, ran) in tests.items()}
        worker = os.environ.get("PYTEST_XDIST_WORKER", "")  # each has its share of a file's tests
        out = Path(os.environ[REACH]) / f"{'.'.join((*Path(path).with_suffix('').parts, worker))}.json"
        out.write_text(json.dumps({"functions": functions, "tests": told}), encoding="utf-8")
