"""Freed memory is kept for the next array, and only where nobody said otherwise."""

import os
import subprocess
import sys

import pytest

from bench.allocation import KEPT
from tests.hostile import ROOT

#: Page faults while an array of 8 MB comes and goes two hundred times.
FAULTS = """
import resource
import numpy as np
from bench.allocation import keep_freed_memory
keep_freed_memory()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(200):
    np.ones(10**6)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def faults(**environment):
    free = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")}
    env = {**free, "PYTHONPATH": str(ROOT), **environment}
    return int(
        subprocess.run([sys.executable, "-c", FAULTS], env=env, capture_output=True, text=True, check=True).stdout
    )


@pytest.mark.skipif("CS_GNU_LIBC_VERSION" not in getattr(os, "confstr_names", {}), reason="no glibc here")
def test_arrays_that_come_and_go_take_no_new_pages():
    anew = faults(MALLOC_MMAP_THRESHOLD_="1000000")  # said otherwise
    assert anew > 10_000
    assert faults() < 0.1 * anew
    assert faults(**KEPT) < 0.1 * anew
