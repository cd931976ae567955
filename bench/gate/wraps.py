"""Does the position wrap? Readers undo clear wraps; here the rest, and recordings that no reader made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.gate.check import Check, absent
from bench.gate.seen import Repaired, Seen
from bench.trace.trace import Trace
from bench.trace.wraps import Wraps, jumps, period_of, undone

NAME = "position_wraps"
ALLOWED = "a position that runs on, or wraps by one period"


def runs_on(seen: Seen) -> Check | Repaired:
    """The recording with its wraps undone."""
    trace = seen.trace
    if "position" not in trace:
        return absent(NAME, "no position is recorded", ALLOWED)
    if trace.wraps is not None:
        return _undone(trace, trace.wraps)
    position = trace["position"]
    places = jumps(position, trace.time)
    if not places.size:
        return Check(NAME, "pass", "position runs on", ALLOWED)
    period = period_of(position, places)
    if period is None:
        longest = float(np.abs(np.diff(position)[places]).max())
        found = (
            f"position jumps {places.size} times, by up to {longest:.4g} {trace.units['position']}, not by one period"
        )
        advice = "record so that it runs on, cut the recording at the jumps, or leave the position out"
        return Check(NAME, "fail", found, ALLOWED, advice)
    wraps = Wraps(period, int(places.size))
    wrapping = [name for name in ("position", "position_reference") if name in trace]
    repaired = trace.with_signals({name: undone(trace[name], period) for name in wrapping}, {})
    return Repaired(_undone(trace, wraps), replace(repaired, wraps=wraps))


def _undone(trace: Trace, wraps: Wraps) -> Check:
    found = f"position wraps at {wraps.period:.5g} {trace.units['position']}; {wraps.count} wraps undone"
    return Check(NAME, "pass", found, ALLOWED)
