"""Magnitudes that no servo axis can have: a wrong unit, a damaged file, or numbers whose squares overflow or vanish.

The bounds are far beyond any axis: a value within them may be wrong, one outside them certainly is.
"""

from __future__ import annotations

import numpy as np

from bench.errors import InputError
from bench.trace.signals import KNOWN_MOMENTUM, KNOWN_TORQUE
from bench.trace.trace import Trace

#: Largest magnitude of a signal - SI; of time it is 30,000 years, of position a spindle's turns in a year.
LARGEST = {
    "time": 1e12,
    "position": 1e12,
    "velocity": 1e8,
    "acceleration": 1e12,
    "current": 1e8,
    "torque": 1e10,
    "force": 1e12,
    "voltage": 1e8,
    "temperature": 1e8,
    KNOWN_TORQUE: 1e12,
    KNOWN_MOMENTUM: 1e12,
}
#: A signal that never exceeds this has a square that underflows - SI.
SMALLEST = 1e-30
#: Sample periods that a recording can have - s.
SHORTEST, LONGEST = 1e-9, 1e6


def require_plausible(trace: Trace) -> None:
    """Raise InputError for the first value beyond what a servo axis can have, or for a signal that is nearly zero.

    A reference has the bounds of its signal.
    """
    for name, values in {"time": trace.time, **trace.signals}.items():
        unit, where = trace.units.get(name, "s"), f"{trace.origin}: {name}"
        largest = LARGEST[name.removesuffix("_reference")]
        top = max(float(values.max()), -float(values.min()))
        if top > largest:
            first = int(np.argmax(np.abs(values) > largest))
            found = f"found {values[first]:g} {unit} at {trace.time[first]:g} s, which no servo axis has"
            raise InputError(where, found, f"allowed: up to {largest:g} {unit}; is the unit right?")
        if 0.0 < top < SMALLEST:
            found = f"found nothing beyond {top:g} {unit}"
            raise InputError(where, found, f"allowed: a signal that exceeds {SMALLEST:g} {unit}; is the unit right?")
    period = trace.sample_period
    if not SHORTEST <= period <= LONGEST:
        allowed = f"allowed: {SHORTEST:g} s to {LONGEST:g} s; is the unit right?"
        raise InputError(f"{trace.origin}: time", f"found a sample every {period:g} s", allowed)
