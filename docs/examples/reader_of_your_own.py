"""A reader of your own: a drive's memory, `DUMP` and then records.

Offered as an entry point, `bench.read` tries it, too: see CONTRIBUTING.md, "Add a reader".
"""

from pathlib import Path

import numpy as np

from bench.trace.channel import Channel, Recording
from bench.trace.source import open_source
from bench.trace.trace import assemble

RECORD = np.dtype([("time", "<u4"), ("speed", "<f4"), ("current", "<f4")])
UNITS = {"time": "us", "speed": "rpm", "current": "A"}


class DriveDump:
    """Reads named columns with the units that stand in the file, and gives none of them a meaning."""

    format, endings = "drive's memory", (".dump",)

    def recognises(self, source):
        """Whether the file begins as a dump does."""
        return source.content.startswith(b"DUMP")

    def read(self, source):
        """Columns of the records."""
        records = np.frombuffer(source.content[4:], RECORD)
        channels = (Channel(name, unit, records[name].astype(float), source.path) for name, unit in UNITS.items())
        return Recording(tuple(channels), self.format, source.path)


count = np.arange(1000)
memory = np.array(list(zip(1000 * count, 3 * count, 0.001 * count, strict=True)), RECORD)
Path("run.dump").write_bytes(b"DUMP" + memory.tobytes())

trace = assemble(DriveDump().read(open_source("run.dump")))
print(f"{len(trace)} samples, {trace.sample_period:.4g} s between samples, up to {trace['velocity'].max():.2f} rad/s")
