"""Does the position wrap? Readers undo clear wraps; here the rest, and recordings that no reader made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.gate.check import Check, absent
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from bench.trace.wraps import Wraps, jumps, period_of, undone

NAME = "position_wraps"
ALLOWED = "a position that runs on, or wraps by one period"


def check(trace: Trace, rig: Rig | None) -> tuple[Trace, Check]:
    """The recording with its wraps undone."""
    if "position" not in trace:
        return trace, absent(NAME, "no position is recorded", ALLOWED)
    if trace.wraps is not None:
        return trace, _undone(trace, trace.wraps)
    position = trace["position"]
    places = jumps(position, trace.time)
    if not places.size:
        return trace, Check(NAME, "pass", "position runs on", ALLOWED)
    period = period_of(position, places)
    if period is None:
        longest = float(np.abs(np.diff(position)[places]).max())
        found = (
            f"position jumps {places.size} times, by up to {longest:.4g} {trace.units['position']}, not by one period"
        )
        advice = "record so that it runs on, cut the recording at the jumps, or leave the position out"
        return trace, Check(NAME, "fail", found, ALLOWED, advice)
    wraps = Wraps(period, int(places.size))
    wrapping = [name for name in ("position", "position_reference") if name in trace]
    repaired = trace.with_signals({name: undone(trace[name], period) for name in wrapping}, {})
    return replace(repaired, wraps=wraps), _undone(trace, wraps)


def _undone(trace: Trace, wraps: Wraps) -> Check:
    found = f"position wraps at {wraps.period:.5g} {trace.units['position']}; {wraps.count} wraps undone"
    return Check(NAME, "pass", found, ALLOWED)
