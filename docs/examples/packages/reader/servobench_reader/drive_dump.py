"""Reader of a drive's memory: `DUMP`, then records of time - us, speed - rpm and current - A, little-endian."""

import numpy as np

from bench.errors import InputError
from bench.trace.channel import Channel, Recording

MAGIC = b"DUMP"
RECORD = np.dtype([("time", "<u4"), ("speed", "<f4"), ("current", "<f4")])
UNITS = {"time": "us", "speed": "rpm", "current": "A"}


class DriveDump:
    """See the module."""

    format = "drive's memory"
    endings = (".dump",)

    def recognises(self, source):
        """Whether the file begins as a dump does."""
        return source.content.startswith(MAGIC)

    def read(self, source):
        """Columns of the records; InputError where the last one is cut off."""
        body = source.content[len(MAGIC) :]
        if len(body) % RECORD.itemsize:
            found = f"found {len(body)} bytes of records"
            raise InputError(source.path, found, f"allowed: a multiple of {RECORD.itemsize}; the file is cut off")
        records = np.frombuffer(body, RECORD)
        channels = (Channel(name, unit, records[name].astype(float), source.path) for name, unit in UNITS.items())
        return Recording(tuple(channels), self.format, source.path)


READER = DriveDump()
