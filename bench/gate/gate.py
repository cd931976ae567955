"""The gate before any fit: all checks in order, each on the recording as the previous ones have repaired it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bench.axis_kind import INERTIA
from bench.errors import InputError, UndeterminedError
from bench.gate import effort, neighbours, plausible, repairs, signals, throughout, timing, velocity
from bench.gate.check import STATUSES, Check, Look, Seen
from bench.rig.rig import Rig
from bench.trace.trace import Trace, require_plausible

#: Checks that repair come before those that only judge.
CHECKS: tuple[Look, ...] = (
    signals.moves,
    timing.regular,
    effort.has_sign,
    repairs.runs_on,
    velocity.is_derivative,
    repairs.none_lost,
    timing.rate,
    signals.clips,
    signals.resolution,
    throughout.holds,
    effort.follows_motion,
    effort.constants,
    plausible.agrees,
    plausible.units,
    neighbours.stand,
)
#: Checks that do not apply at one steady speed: signals may stay the same, and effort follows no motion.
UNSTEADY: tuple[Look, ...] = (signals.moves, repairs.none_lost, timing.rate, signals.resolution)
UNSTEADY += (effort.has_sign, throughout.holds, effort.follows_motion)
STEADY = tuple(look for look in CHECKS if look not in UNSTEADY)
#: Checks of a later part of a recording: what can go wrong there, without what is the same in all of it.
WHOLE = (timing.rate, signals.resolution, effort.has_sign, effort.follows_motion, effort.constants, plausible.agrees)
WHOLE += (plausible.units, neighbours.stand)
PARTS = tuple(look for look in CHECKS if look not in WHOLE)


class UnanswerableError(UndeterminedError):
    """A sound recording that does not allow the identification, with all checks of it."""

    checks: tuple[Check, ...] = ()


@dataclass(frozen=True)
class Gated:
    """A recording that went through the gate, repaired where possible, with its checks in their order."""

    trace: Trace
    checks: tuple[Check, ...]


def gate(trace: Trace, rig: Rig | None = None, looks: Sequence[Look] = CHECKS) -> Gated:
    """Run checks on a recording, or on a part of one.

    InputError where rig and recording do not fit together, or for a value that no axis can have.
    """
    require_plausible(trace)
    seen, checks = Seen(trace, rig), list[Check]()
    for look in looks:
        found = look(seen)
        if isinstance(found, tuple):
            found, repaired = found
            seen = Seen(repaired, rig)
        checks += [] if found is None else [found]
    return Gated(seen.trace, tuple(checks))


def passed(trace: Trace, rig: Rig, looks: Sequence[Look] = CHECKS) -> Gated:
    """The gated recording; the first check that fails is an InputError or UnanswerableError."""
    gated = gate(trace, rig, looks)
    require(gated.checks, trace)
    return gated


def require(checks: Sequence[Check], trace: Trace) -> None:
    """Raise the first check of a recording, or of a part of it, that fails."""
    failed = next((check for check in checks if check.status == "fail"), None)
    if failed is None:
        return
    where = f"{trace.origin}: {failed.name}"
    if not failed.unanswerable:
        raise InputError(where, f"found: {failed.found}", f"allowed: {failed.allowed}; {failed.advice}")
    error = UnanswerableError(trace.axis_kind.in_words(INERTIA), f"{where}: {failed.found}", failed.advice)
    error.checks = tuple(checks)
    raise error


def joined(parts: Sequence[Sequence[Check]]) -> tuple[Check, ...]:
    """Checks of a recording from those of its parts: the worst of each, without parts that are only unanswerable.

    A part in which the axis stands still is no evidence against the others. The first part has every check.
    """
    worst = []
    for check in parts[0]:
        same = [one for part in parts for one in part if one.name == check.name]
        silent = [one for one in same if one.status == "not_applicable" or (one.status == "fail" and one.unanswerable)]
        answered = [one for one in same if one not in silent] or silent
        worst.append(min(answered, key=lambda one: STATUSES.index(one.status)))
    return tuple(worst)


def warnings_of(checks: Sequence[Check]) -> list[str]:
    """A line for each check that warns."""
    warned = (check for check in checks if check.status == "warn")
    return [f"{one.name}: {'; '.join(filter(None, (one.found, one.advice)))}" for one in warned]
