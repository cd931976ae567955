"""Sinumerik frequency responses: recognised, so that the user learns why they are no trace of a motion."""

from __future__ import annotations

from typing import NoReturn

from bench.errors import InputError
from bench.trace.readers.xml import root_name
from bench.trace.source import Source


class Sinumerik:
    """Frequency responses, which are refused."""

    format = "Sinumerik frequency response (refused)"
    endings = ()

    def recognises(self, source: Source) -> bool:
        """Whether the root element is that of a frequency-response measurement."""
        return root_name(source).startswith("ResponseTest")

    def read(self, source: Source) -> NoReturn:
        """Refuse.

        Raises:
            InputError: always.
        """
        raise InputError(
            source.path,
            "found a Sinumerik frequency-response measurement, which holds no motion over time",
            "allowed: a recording of velocity or position and of current or torque over time",
        )
