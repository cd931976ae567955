"""MuJoCo without a word: what it would print, and the file it would leave, are reported by the caller."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def silenced() -> Iterator[None]:
    """Keep MuJoCo from printing warnings and from leaving a MUJOCO_LOG.TXT behind, within the block."""
    before, silent = mujoco.MjLogConfig.get(), mujoco.MjLogConfig.get()
    silent.logto_console = silent.logto_file = False
    silent.set()
    try:
        with warnings.catch_warnings(action="ignore", category=UserWarning):  # a compiler's, of a singular inertia
            yield
    finally:
        before.set()
