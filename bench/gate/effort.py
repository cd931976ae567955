"""Does the effort follow the motion? If not: what it probably is instead."""

from __future__ import annotations

from bench.gate.balance import Balance, balance, effort_of
from bench.gate.check import Check, absent
from bench.rig.rig import Rig
from bench.trace.trace import Trace

NAME = "effort_follows_motion"
#: Shares of the effort, explained by motion and position, below which a recording fails, and warns. The least of any
#: sound recording is 0.48 (`python -m tests.gate`).
REFUSED, WARNED = 0.3, 0.45
#: Effort below this many times its noise is inconclusive.
AUDIBLE = 3.0
#: Share that position must explain beyond motion for effort to follow position.
MORE = 0.3

ALLOWED = f"inertia, friction and position explain {WARNED:.0%} of the effort at least, with positive inertia"


def check(trace: Trace, rig: Rig | None) -> tuple[Trace, Check]:
    """Compare effort with motion; the recording is unchanged."""
    found = effort_of(trace, rig)
    if found is None or not {"position", "velocity"} & set(trace.signals):
        return trace, absent(NAME, "not both effort and motion are recorded", ALLOWED)
    effort, name = found
    fitted = balance(trace, effort)
    if fitted is None:
        return trace, absent(NAME, f"too few samples, or {name} never changes", ALLOWED)
    return trace, judged(fitted, name)


def judged(fitted: Balance, name: str) -> Check:
    """What a balance of the effort of a name says."""
    by_motion, by_position = max(fitted.by_motion, 0.0), max(fitted.by_position, 0.0)
    inertia, _, coulomb, _ = fitted.theta
    explained = f"motion explains {by_motion:.0%} of {name}, with position {by_position:.0%}"
    if by_position < WARNED and fitted.audible < AUDIBLE:
        found = f"{explained}; {name} is {fitted.audible:.1f} times its noise"
        advice = "no torque signal, or accelerations too small for it: record harder ones"
        return Check(NAME, "warn", found, ALLOWED, advice)
    if by_position > WARNED and inertia < 0.0 and coulomb < 0.0 and fitted.power < 0.0:
        found = f"{explained}, yet inertia and friction are negative: torque and motion have opposite signs"
        advice = "count both the same way (a leading - in the rig's [trace.columns] turns one)"
        return Check(NAME, "fail", found, ALLOWED, advice)
    if by_position < REFUSED:
        advice = f"likeliest {name} is another axis', or no torque signal: check the column"
        return Check(NAME, "fail", explained, ALLOWED, advice, unanswerable=True)
    if by_position - by_motion > MORE:
        advice = "likeliest gravity or a spring acts: tell the load in the rig, or let bench diagnose find it"
        return Check(NAME, "pass" if by_position > WARNED else "warn", explained, ALLOWED, advice)
    if by_position < WARNED:
        return Check(NAME, "warn", explained, ALLOWED, "bench diagnose may tell what else acts")
    return Check(NAME, "pass", explained, ALLOWED)
