"""Memory for arrays: what is freed is kept for the next one, where the C library lets one ask for it.

Thousands of arrays of a recording come and go. glibc gives each large one fresh pages and gives them back at once, and
the kernel fills every page with zeros first: 200 recordings of 30 s took 24 s of CPU, and 10 s with freed memory kept.
"""

from __future__ import annotations

import os

#: Environment by which glibc does so from a process' start: arrays up to so large come from memory that is kept (32 MB
#: is the most that it takes), and so much free memory stays with the process - bytes.
KEPT = {"MALLOC_MMAP_THRESHOLD_": str(32 * 2**20), "MALLOC_TRIM_THRESHOLD_": str(512 * 2**20)}
#: Numbers of the same two in `mallopt(3)`.
_OPTIONS = {"MALLOC_MMAP_THRESHOLD_": -3, "MALLOC_TRIM_THRESHOLD_": -1}


def keep_freed_memory() -> None:
    """Keep freed memory in this process; without glibc, or where its environment sets otherwise, nothing changes."""
    if any(name.startswith("MALLOC_") for name in os.environ):
        return
    try:
        glibc = os.confstr("CS_GNU_LIBC_VERSION")
    except (AttributeError, ValueError):
        glibc = None
    if glibc is None:
        return
    import ctypes

    for name, value in KEPT.items():
        ctypes.CDLL(None).mallopt(_OPTIONS[name], int(value))
