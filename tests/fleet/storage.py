"""A storage that breaks, as fsspec finds it by an entry point: one never delivers, the other ends who reads it."""

import os
import signal
import time

from fsspec import AbstractFileSystem

ENTRY_POINTS = """[fsspec.specs]
never = tests.fleet.storage:Never
deadly = tests.fleet.storage:Deadly
"""


def offer(folder):
    """Make a folder an installed package that offers the storage to whoever has it on their path."""
    installed = folder / "broken_storage-1.dist-info"
    installed.mkdir(parents=True)
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: broken-storage\nVersion: 1\n")
    (installed / "entry_points.txt").write_text(ENTRY_POINTS)


class Never(AbstractFileSystem):
    protocol = "never"

    def info(self, path, **_):
        return {"name": path, "size": 1000, "type": "file"}

    def _open(self, path, mode="rb", **_):
        """Waits for what does not come."""
        time.sleep(1e6)


class Deadly(Never):
    protocol = "deadly"

    def _open(self, path, mode="rb", **_):
        """As where memory has run out."""
        os.kill(os.getpid(), signal.SIGKILL)
