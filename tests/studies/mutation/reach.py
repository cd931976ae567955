"""Which functions of the bench each test file runs, so that a mutant is shown to the tests that can see it.

A plugin of pytest (`-p tests.studies.mutation.reach`): it profiles each file of tests and writes what ran into the
folder that SERVOBENCH_REACH names, one file of JSON for each, with its seconds.
"""

from __future__ import annotations

import cProfile
import json
import os
import time
from pathlib import Path

import pytest

from tests.studies.mutation.mutants import ROOT

REACH = "SERVOBENCH_REACH"


@pytest.fixture(autouse=True, scope="module")
def _reached(request: pytest.FixtureRequest) -> object:
    """Profiles the tests of a module."""
    profile, began = cProfile.Profile(), time.process_time()
    try:
        profile.enable()
    except ValueError:  # a test that profiles by itself has the interpreter's only profiler
        yield
        return
    yield
    profile.disable()
    seconds = time.process_time() - began
    profile.create_stats()
    bench = f"{ROOT / 'bench'}{os.sep}"
    ran = {f"{file[len(str(ROOT)) + 1 :]}:{line}" for file, line, _ in profile.stats if file.startswith(bench)}
    name = Path(str(request.path)).relative_to(ROOT)
    out = Path(os.environ[REACH]) / f"{'.'.join(name.with_suffix('').parts)}.json"
    out.write_text(json.dumps({"path": str(name), "seconds": seconds, "ran": sorted(ran)}), encoding="utf-8")
