"""MuJoCo's own warnings, silenced while the bench runs it: divergence is told as a result instead."""

from __future__ import annotations

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
        yield
    finally:
        before.set()
