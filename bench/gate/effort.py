"""Does the effort follow the motion? If not: what it probably is instead. Are the motor's constants those of one?"""

from __future__ import annotations

from bench.gate.check import Balanced, Check, Seen, absent

FOLLOWS, CONSTANTS = "effort_follows_motion", "motor_constants_agree"
#: Shares of the effort, explained by motion and position, below which a recording fails, and warns. The least of any
#: sound recording is 0.48 (`python -m tests.gate`).
REFUSED, WARNED = 0.3, 0.45
#: Effort below this many times its noise is inconclusive.
AUDIBLE = 3.0
#: Share that position must explain beyond motion for effort to follow position.
MORE = 0.3

ALLOWED = f"inertia, friction and position explain {WARNED:.0%} of the effort at least, with positive inertia"
ALLOWED_CONSTANTS = "kT is Ke, 3/2 or sqrt(3) of it, as Ke is meant, within their tolerances, 10 % where none is stated"


def follows_motion(seen: Seen) -> Check:
    """Compare effort with motion."""
    if seen.effort is None or not seen.tells_motion:
        return absent(FOLLOWS, "not both effort and motion are recorded", ALLOWED)
    _, name = seen.effort
    fitted = seen.balance()
    if fitted is None:
        return absent(FOLLOWS, f"too few samples, or {name} never changes", ALLOWED)
    return judged(fitted, name)


def judged(fitted: Balanced, name: str) -> Check:
    """What a balance of the effort of a name says."""
    by_motion, by_position = max(fitted.by_motion, 0.0), max(fitted.by_position, 0.0)
    explained = f"motion explains {by_motion:.0%} of {name}, with position {by_position:.0%}"
    if by_position < REFUSED and fitted.moving < AUDIBLE:
        found = f"the axis hardly moves, its speed is {fitted.moving:.1f} times its noise; {explained}"
        return Check(FOLLOWS, "fail", found, ALLOWED, "record it in motion", unanswerable=True)
    if by_position < WARNED and fitted.audible < AUDIBLE:
        found = f"{explained}; {name} is {fitted.audible:.1f} times its noise"
        advice = "no torque signal, or accelerations too small for it: record harder ones"
        return Check(FOLLOWS, "warn", found, ALLOWED, advice)
    if by_position > WARNED and fitted.inertia < 0.0 and fitted.coulomb < 0.0 and fitted.power < 0.0:
        found = f"{explained}, yet inertia and friction are negative: torque and motion have opposite signs"
        advice = "count both the same way (a leading - in the rig's [trace.columns] turns one)"
        return Check(FOLLOWS, "fail", found, ALLOWED, advice)
    if by_position < REFUSED:
        advice = f"likeliest {name} is another axis', or no torque signal: check the column"
        return Check(FOLLOWS, "fail", explained, ALLOWED, advice, unanswerable=True)
    if by_position - by_motion > MORE:
        advice = "likeliest gravity or a spring acts: tell the load in the rig, or let bench diagnose find it"
        return Check(FOLLOWS, "pass" if by_position > WARNED else "warn", explained, ALLOWED, advice)
    if by_position < WARNED:
        return Check(FOLLOWS, "warn", explained, ALLOWED, "bench diagnose may tell what else acts")
    return Check(FOLLOWS, "pass", explained, ALLOWED)


def constants(seen: Seen) -> Check:
    """Compare the torque constant and the back-EMF constant that the rig states."""
    rig = seen.rig
    if rig is None or rig.motor.back_emf_constant is None or rig.motor.torque_per_ampere is None:
        return absent(CONSTANTS, "not both are stated", ALLOWED_CONSTANTS)
    found = rig.motor.disagreement
    if found is None:
        return Check(CONSTANTS, "pass", "they agree", ALLOWED_CONSTANTS)
    advice = "correct the wrong one in the rig, or state its tolerance (+/-)"
    return Check(CONSTANTS, "warn", found, ALLOWED_CONSTANTS, advice)
