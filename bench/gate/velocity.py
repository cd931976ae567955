"""Is reported speed the derivative of reported position?

    integral of v over a span = ratio*(displacement) - lag*(change of v) + offset*(span)

by least squares over spans of SPAN samples, so that a filter of the speed is a lag and a sensor's zero an offset, not
another ratio. At one steady speed neither can be separated from the ratio, and only that is fitted. What remains, as
share of the displacements, shows whether both are the same motion at all.
"""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import Array, rms
from bench.gate.check import Check, Seen, absent, least_squares, resolution_of
from bench.gate.timing import rate
from bench.names import percent
from bench.trace.motion import integrated
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

NAME = "velocity_is_derivative_of_position"
#: Samples a span.
SPAN = 20
#: Deviation of the ratio from one that is reported, and refused: clean ones reach 0.06, wrong scales 0.4 (tests.gate).
WARNED, REFUSED = 0.02, 0.1
#: Remainder, as share of the displacements, that is refused; clean recordings reach 0.15.
REMAINDER = 0.4
#: Steps of both signals, or noise of the speed, that the displacements of a span need to make the ratio.
STEPS = 5.0
#: Spread of the displacements, as share of their RMS, up to which the speed is steady.
STEADY = 0.1

ALLOWED = f"the same motion in both: 1 within {percent(WARNED)}, a lag aside"


def is_derivative(seen: Seen) -> Check:
    """Compare the speed of a recording with its position."""
    if not {"position", "velocity"} <= set(seen.trace.signals):
        return absent(NAME, "not both position and velocity are recorded", ALLOWED)
    found = compared(seen)
    if found is None:
        return absent(NAME, f"hardly any motion, or no stretch of {2 * SPAN} samples without a hole", ALLOWED)
    ratio, lag, remainder = found
    if remainder >= REMAINDER and rate(seen).status == "fail":
        return absent(NAME, "sampled too coarsely to compare them", ALLOWED)
    return judged(ratio, lag, remainder)


def compared(seen: Seen) -> tuple[float, float, float] | None:
    """Ratio of a recording's speed to its position's derivative, by how much it is late - s -, and what is not in it.

    That is a share of the displacements. None where the recording is too short or hardly moves.
    """
    trace = seen.trace
    spans = [_spans(trace, part) for part in seen.stretches(2 * SPAN)]
    if not spans:
        return None
    moved, claimed, change = (np.concatenate(column) for column in zip(*spans, strict=True))
    step = max(resolution_of(trace["velocity"]), white_noise(trace["velocity"])) * trace.sample_period * math.sqrt(SPAN)
    least = STEPS * max(resolution_of(trace["position"]), step)
    if max(rms(moved), rms(claimed)) <= least:
        return None
    steady = np.std(moved) <= max(STEADY * rms(moved), least)
    columns = np.column_stack([moved, *([] if steady else [change, np.full(moved.size, SPAN * trace.sample_period)])])
    theta = least_squares(columns, claimed)
    left = rms(claimed - columns @ theta)
    return float(theta[0]), 0.0 if steady else -float(theta[1]), left / max(rms(claimed), 1e-300)


def judged(ratio: float, lag: float, remainder: float) -> Check:
    """What a comparison of speed and position, as of `compared`, finds."""
    units = "check the units (and signs) of both columns and of the time, or omit one of the two columns"
    if abs(ratio - 1.0) > REFUSED and remainder < REMAINDER:
        thousands = math.log10(abs(ratio)) / 3.0 if ratio else 0.0
        likeliest = (
            "likeliest a unit of time is wrong, ms read as s: " if abs(thousands - round(thousands)) < 0.01 else ""
        )
        found = f"velocity is {ratio:.4g} times the derivative of position"
        return Check(NAME, "fail", found, ALLOWED, f"{likeliest if ratio > 0.0 else ''}{units}")
    if remainder >= REMAINDER:
        found = f"{percent(min(remainder, 1.0))} of velocity's travel is not in position: not the same motion"
        return Check(NAME, "fail", found, ALLOWED, f"{units}; a sensor may stand still, or the columns be two axes'")
    late = f", {lag * 1e3:.3g} ms late" if abs(lag) > 1e-5 else ""
    found = f"velocity is {ratio:.4g} times the derivative of position{late}"
    if abs(ratio - 1.0) > WARNED:
        return Check(NAME, "warn", found, ALLOWED, "calibrate one of them: inertia and friction scale with it")
    return Check(NAME, "pass", found, ALLOWED)


def _spans(trace: Trace, part: slice) -> tuple[Array, ...]:
    """Displacement by position and by speed, and change of speed, over each span - rad, rad, rad/s (m, m, m/s)."""
    period = trace.sample_period
    position, velocity = trace["position"][part], trace["velocity"][part]
    columns = position, integrated(velocity, period), velocity
    return tuple(values[SPAN:] - values[:-SPAN] for values in columns)
