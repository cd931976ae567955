"""Does the effort follow the motion? If not: what it probably is instead. Are the motor's constants those of one?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.arrays import rms
from bench.gate.check import Balanced, Check, Seen, absent
from bench.names import percent

FOLLOWS, CONSTANTS, SIGNED = "effort_follows_motion", "motor_constants_agree", "effort_has_a_sign"
#: Share of the RMS speed above which an axis moves; of the largest effort that counts as zero; of the motion that goes
#: each way, and that is at zero. Percentage of samples that interpolation may bring to the other side of zero.
MOVING, NEAR_ZERO, BOTH, AT_ZERO, FEW = 0.2, 0.03, 0.1, 0.01, 0.5
#: Share explained with positive inertia that speaks for a load held up; five such recordings have 0.96 at least.
HELD = 0.9
#: Speed below which a joint creeps - rad/s: a turn in two minutes.
CREEPING = 0.05
#: Samples of a stretch.
LEAST = 64
#: Shares of the effort that motion and position explain to pass; the least of sound ones is 0.48 (`tests.gate`).
REFUSED, WARNED = 0.3, 0.45
#: Effort below this many times its noise is inconclusive.
ABOVE_NOISE = 3.0
#: Share that position must explain beyond motion for effort to follow position.
MORE = 0.3

ALLOWED = f"inertia, friction and position explain {percent(WARNED)} of the effort at least, with positive inertia"
ALLOWED_SIGN = "an effort of both signs, or one that differs from zero where the axis moves"
ALLOWED_CONSTANTS = "kT is Ke, 3/2 or sqrt(3) of it, as Ke is meant, within their tolerances, 10 % where none is stated"


def has_sign(seen: Seen) -> Check:
    """Whether the effort has lost its sign: it is never below zero (or above), yet at zero while the axis moves.

    The torque that carries a load is of one sign, too: then inertia, friction and position explain it.
    """
    parts, fitted = seen.stretches(LEAST), seen.balance()
    if seen.effort is None or fitted is None or not parts:
        return absent(SIGNED, seen.unbalanced, ALLOWED_SIGN)
    effort, name = seen.effort
    raw = seen.trace.signals.get(name, effort)
    speed, effort = np.concatenate([seen.speed(part) for part in parts]), np.concatenate([raw[part] for part in parts])
    moving = np.abs(speed) > MOVING * rms(speed)
    forward = float(np.mean(speed[moving] > 0.0)) if moving.any() else 0.0
    side = 1.0 if abs(effort.max()) > abs(effort.min()) else -1.0
    top, bottom = float((side * effort).max()), float(np.percentile(side * effort, FEW))
    at_zero = float(np.mean(np.abs(effort[moving]) <= NEAR_ZERO * top)) if moving.any() else 0.0
    held = fitted.by_position > HELD and fitted.inertia > 0.0
    if held or bottom < -NEAR_ZERO * top or not BOTH < forward < 1.0 - BOTH or at_zero < AT_ZERO:
        return Check(SIGNED, "pass", f"{name} has {'both signs' if bottom < 0.0 else 'one sign'}", ALLOWED_SIGN)
    other = "below" if side > 0.0 else "above"
    found = f"{name} is never {other} 0, and at 0 in {percent(at_zero)} of the motion, both ways"
    advice = "its sign is lost: a register's sign bit, a magnitude or an effective value; record it with its sign"
    return Check(SIGNED, "fail", found, ALLOWED_SIGN, advice, unanswerable=True)


def follows_motion(seen: Seen) -> Check:
    """Compare effort with motion."""
    fitted = seen.balance()
    if seen.effort is None or fitted is None:
        return absent(FOLLOWS, seen.unbalanced, ALLOWED)
    found, speed = judged(fitted, seen.effort[1]), rms(fitted.columns[:, 1])
    if found.status == "fail" and seen.trace.axis_kind.turns and speed < CREEPING:
        advice = "the joint stands still or creeps, and friction balances the torque: move it"
        return replace(found, found=f"{found.found}; it moves at {speed:.2g} rad/s RMS", advice=advice)
    return found


def judged(fitted: Balanced, name: str) -> Check:
    """The result of a balance of the effort of a name."""
    by_motion, by_position = max(fitted.by_motion, 0.0), max(fitted.by_position, 0.0)
    explained = f"motion explains {percent(by_motion)} of {name}, with position {percent(by_position)}"
    if by_position < WARNED and fitted.effort_over_noise < ABOVE_NOISE:
        found = f"{explained}; {name} is {fitted.effort_over_noise:.1f} times its noise"
        advice = "no torque signal, or accelerations too small for it: record harder ones"
        return Check(FOLLOWS, "warn", found, ALLOWED, advice)
    if by_position < REFUSED and fitted.speed_over_noise < ABOVE_NOISE:
        found = f"the speed hardly changes, by {fitted.speed_over_noise:.1f} times its noise; {explained}"
        advice = "a motion that accelerates, better in both directions"
        return Check(FOLLOWS, "fail", found, ALLOWED, advice, unanswerable=True)
    power = float(fitted.effort @ fitted.columns[:, 1])
    if by_position > WARNED and max(fitted.inertia, fitted.coulomb, power) < 0.0:
        found = f"{explained}, yet inertia and friction are negative: torque and motion have opposite signs"
        advice = "count both the same way (a leading - in the rig's [trace.columns] turns one)"
        return Check(FOLLOWS, "fail", found, ALLOWED, advice)
    if by_position < REFUSED:
        advice = f"likeliest {name} is another axis', or no torque signal: check the column"
        return Check(FOLLOWS, "fail", explained, ALLOWED, advice, unanswerable=True)
    if by_position - by_motion > MORE:
        advice = "gravity or a spring probably acts: describe the load in the rig, or run `bench diagnose`"
        return Check(FOLLOWS, "pass" if by_position > WARNED else "warn", explained, ALLOWED, advice)
    if by_position < WARNED:
        return Check(FOLLOWS, "warn", explained, ALLOWED, "`bench diagnose` searches for what else acts")
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
