"""What a person may give for a rig or a recording: the object, a file's path, arrays by name or a data frame."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias, cast

from bench.errors import InputError
from bench.names import short
from bench.rig.rig import Rig, load_rig
from bench.trace.from_arrays import Arrays
from bench.trace.read import read
from bench.trace.trace import Trace

Given: TypeAlias = Trace | str | Path | Arrays


def rig_of(given: Rig | str | Path) -> Rig:
    """A rig, or that of a file or of a shipped one's name; InputError where it is none."""
    if isinstance(given, Rig):
        return given
    if not isinstance(given, str | Path):
        raise InputError("rig", f"found {short(repr(given))}", "allowed: a Rig, a rig file, or a shipped rig's name")
    return load_rig(given)


def trace_of(given: Given, rig: Rig) -> Trace:
    """A recording, read as the rig says where it is a file, arrays or a frame; InputError where it is none."""
    if isinstance(given, Trace):
        return given
    if isinstance(given, str | Path):
        return read(given, rig.trace)
    return Trace.from_arrays(given, sample_period=rig.trace.sample_period, columns=rig.trace.columns)


def recordings_of(given: Given | Sequence[Given], rig: Rig) -> list[Trace]:
    """One recording or a list (tuple) of several."""
    every = given if isinstance(given, list | tuple) else [cast(Given, given)]
    return [trace_of(one, rig) for one in every]
