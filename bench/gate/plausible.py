"""Does a recording agree with its rig: the inertia of motor and disk, the motor's top speed and its peak current, and
are its units stated?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bench.axis_kind import INERTIA
from bench.gate.check import Check, Seen, absent
from bench.names import percent
from bench.trace.trace import ASSUMED_UNITS

NAME, UNITS = "agrees_with_rig", "units"
#: Factor between what is found and the rig's value that is reported, and that is refused.
WARNED, REFUSED = 1.2, 3.0
#: Share of the effort that motion explains from which on the coarse balance determines an inertia.
EXPLAINED = 0.8
#: Share of the samples that lie below what counts as the largest: spikes are no motion - %.
MOST = 99.5

ALLOWED = f"the values of the rig, within {percent(WARNED - 1.0)}"


def agrees(seen: Seen) -> Check:
    """Compare a recording with its rig."""
    compared = list(_compared(seen))
    if not compared:
        return absent(NAME, "the rig states neither inertia, top speed nor peak current", ALLOWED)
    off, found = max((max(ratio, 1.0 / ratio), text) for ratio, text in compared)
    if off <= WARNED:
        return Check(NAME, "pass", found, ALLOWED)
    advice = "check units, signs and scales of the columns, the time's too, and whether the rig is this axis'"
    return Check(NAME, "fail" if off > REFUSED else "warn", found, ALLOWED, advice)


def units(seen: Seen) -> Check | None:
    """Whether recording and rig state their units; None where they do."""
    found = [*filter(None, [seen.trace.metadata.get(ASSUMED_UNITS)]), *(seen.rig.assumed if seen.rig else ())]
    return Check(UNITS, "warn", "; ".join(found), "a unit for each value") if found else None


def _compared(seen: Seen) -> Iterator[tuple[float, str]]:
    """Ratio of found to stated, and in words; what is only a limit counts where it is exceeded."""
    rig, trace = seen.rig, seen.trace
    if rig is None:
        return
    known, fitted = _inertia(seen), seen.balance()
    if known is not None and fitted is not None and fitted.by_motion > EXPLAINED and fitted.inertia > 0.0:
        words = f"{trace.axis_kind.in_words(INERTIA)} is about {fitted.inertia:.3g} {trace.axis_kind.inertia_unit}"
        yield fitted.inertia / known, f"{words}, and {known:.3g} by the rig's motor and load"
    motor = rig.motor
    fastest = motor.maximum_speed or max((curve.no_load_speed for curve in motor.peak_curves), default=None)
    limits = {"velocity": fastest, "current": motor.peak_current}
    for name, limit in limits.items():
        if limit is not None and name in trace:
            most, unit = float(np.percentile(np.abs(trace[name]), MOST)), trace.units[name]
            yield max(most / limit, 1.0), f"{name} reaches {most:.3g} {unit}, and the rig's motor {limit:.3g} {unit}"


def _inertia(seen: Seen) -> float | None:
    """Inertia (mass) by the rig, on the motor's side; None where it does not state all of it."""
    rig = seen.rig
    if rig is None or rig.load is None or rig.load.link_inertia is not None or not rig.motor.inertia:
        return None
    disk = rig.load.disk(rig.axis_kind)
    if not disk or rig.effort(seen.trace)[1] != rig.effort_unit:
        return None
    return rig.motor.inertia + (rig.load.gear_inertia or 0.0) + rig.load.reflected(disk)
