"""Does one torque balance hold from the recording's beginning to its end, and at this delay of the effort?

    gain of a block = (demand . effort)/(demand . demand),  demand = the balance of all blocks along the block's motion

A block is a stretch of time. Physics changes the gain by tens of percent; a sign that turns makes it -1, a sensor that
drops out 0, another unit a thousand. A delay is recognised by how much smaller the residual of the balance is with the
effort shifted.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator

import numpy as np

from bench.arrays import Array, rms
from bench.gate.check import Balanced, Check, Seen, absent, basis_of
from bench.names import percent
from bench.trace.trace import Trace

NAME = "balance_holds_throughout"
#: Blocks of a recording, and windows that one has at least.
BLOCKS, WINDOWS = 32, 6
#: Share of the effort that the balance explains, with the gains' signs taken out, from which on they are meaningful.
EXPLAINED = 0.6
#: Share of the demand's RMS that a block has at least.
DEMANDED = 0.3
#: Effort of a signal that dropped out, as share of the demand, and gain over the median one of another scale.
QUIET, SCALED = 0.2, 3.0
#: Correlation of effort and demand within a block from which on its gain is a scale.
ALIKE = 0.95
#: Delays that are tried to both sides, and the least that is refused - s, and samples: drives and filters have shorter.
LONGEST, LATE, SAMPLES = 0.1, 0.012, 12
#: Share of the residual that may remain without a fault; of signs, of which each block may have either, the first.
LEFT_BY_SIGNS, LEFT = 0.25, 0.4
#: The same of a delay that is a fault: 29 of 37 currents of the shared cases that are 20 ms late or early leave 0.06 to
#: 0.2, a load on a viscous coupling, which looks 12 ms late, 0.29. Above it it may be physics, which diagnose names.
DELAYED = 0.2

ALLOWED = "one balance of effort and motion, from beginning to end"


def holds(seen: Seen) -> Check:
    """Whether one balance is valid throughout, and the likeliest fault where none does."""
    fitted = seen.balance()
    if seen.effort is None or fitted is None:
        return absent(NAME, seen.unbalanced, ALLOWED)
    _, name = seen.effort
    for found, advice in _in_blocks(fitted, name, seen.trace):
        return Check(NAME, "fail", found, ALLOWED, advice)
    for found, advice, left in _delayed(fitted, name, seen.trace):
        return Check(NAME, "fail" if left <= DELAYED else "warn", found, ALLOWED, advice)
    return Check(NAME, "pass", "one balance is valid", ALLOWED)


def _in_blocks(fitted: Balanced, name: str, trace: Trace) -> Iterator[tuple[str, str]]:
    """What is wrong with the effort for a stretch of time, and what to do."""
    effort, count = fitted.effort, min(BLOCKS, fitted.effort.size // WINDOWS)
    edges = np.linspace(0, effort.size, count + 1).astype(int)
    basis, sizes = basis_of(fitted.columns), np.diff(edges)
    along = np.add.reduceat(basis * effort[:, None], edges[:-1]).T
    signs = _signs(along)
    demand = basis @ (along @ signs)
    if float(demand @ demand) < EXPLAINED * float(effort @ effort):
        return
    products = np.stack([demand, effort, demand * demand, effort * effort, demand * effort])
    mean_asked, mean, asked, had, both = np.add.reduceat(products, edges[:-1], axis=1) / sizes
    varies = np.maximum((asked - mean_asked**2) * (had - mean**2), 0.0)
    demanding = np.sqrt(asked) > DEMANDED * rms(demand)
    gains = both / np.maximum(asked, 1e-300)
    scale = np.abs(gains) / np.median(np.abs(gains[demanding])) + 1e-300
    alike = np.abs(both - mean_asked * mean) > ALIKE * np.sqrt(varies)
    faults = (
        (had < QUIET**2 * asked, 0.0, f"{name} is nearly zero while the motion takes effort", "the signal dropped out"),
        (alike & (np.abs(np.log(scale)) > np.log(SCALED)), 0.0, f"{name} has another scale", "a unit changed"),
        (gains < 0.0, -1.0, f"the sign of {name} is turned", "a mode of the drive turned it"),
    )
    for wrong, factor, found, why in faults:
        at = np.flatnonzero(demanding & wrong)
        each = np.repeat(np.where(demanding & wrong, factor, signs if factor else 1.0), sizes)
        most = LEFT_BY_SIGNS if factor else LEFT
        if at.size and _left(fitted, each) < most * _left(fitted, np.ones(effort.size)):
            first, last = fitted.starts[edges[at[0]]], fitted.starts[edges[at[-1] + 1] - 1] + fitted.length
            begins, ends = (float(trace.time[min(k, len(trace) - 1)] - trace.time[0]) for k in (first, last))
            yield f"{found} from about {begins:.3g} s to {ends:.3g} s", f"likeliest {why}: cut the recording there"


def _left(fitted: Balanced, factors: Array) -> float:
    """Share of the effort that the balance does not explain in the windows, their effort times factors (n,); 0 omits
    one out."""
    used = factors != 0.0
    effort, basis = (fitted.effort * factors)[used], basis_of(fitted.columns[used])
    return 1.0 - float(np.sum((basis.T @ effort) ** 2)) / max(float(effort @ effort), 1e-300)


def _signs(along: Array) -> Array:
    """Signs of blocks (n,), mostly +1, by which the sum of their columns (r, n) becomes longest."""
    signs = np.where(np.linalg.eigh(along.T @ along)[1][:, -1] < 0.0, -1.0, 1.0)
    for _ in range(signs.size):
        signs = np.where(along.T @ (along @ signs) < 0.0, -1.0, 1.0)
    return signs if float(signs @ np.linalg.norm(along, axis=0)) > 0.0 else -signs


def _delayed(fitted: Balanced, name: str, trace: Trace) -> Iterator[tuple[str, str, float]]:
    """That the effort is late, or early, by more than a drive makes it; and the share that remains so shifted."""
    most = round(LONGEST / trace.sample_period)
    length, each = fitted.length, max(1, most // 50)
    shifts = np.arange(-most, most + 1, each)
    columns, efforts = [], []
    for part in fitted.sums:
        places = part.places(length)
        first, last = (bisect_left(places, end) for end in (most, part.effort.size - length - most))
        if first < last:
            means = (part.sums[-1, length:] - part.sums[-1, :-length]) / length
            around = np.lib.stride_tricks.sliding_window_view(means, 2 * most + 1)
            efforts.append(around[places[first] - most : places[last - 1] - most + 1 : places.step, ::each])
            columns.append(part.windows(length)[:-1, first:last].T)
    if sum(map(len, columns)) < BLOCKS * WINDOWS // 3:
        return
    basis, effort = basis_of(np.concatenate(columns)), np.concatenate(efforts)
    effort = effort - effort.mean(axis=0)
    basis = basis_of(basis - basis.mean(axis=0))
    power = np.einsum("nk,nk->k", effort, effort)
    left = 1.0 - np.square(basis.T @ effort).sum(axis=0) / np.maximum(power, 1e-300)
    best, none = int(np.argmin(left)), int(np.argmin(abs(shifts)))
    delay = float(shifts[best]) * trace.sample_period
    if abs(delay) >= max(LATE, SAMPLES * trace.sample_period) and left[best] < min(LEFT * left[none], 1.0 - EXPLAINED):
        late = f"{name} is {abs(delay) * 1e3:.3g} ms {'late' if delay > 0.0 else 'early'}"
        shifted, plain = (percent(1.0 - left[at]) for at in (best, none))
        found = f"{late}: so shifted, motion explains {shifted} of it, and {plain} as it is"
        advice = "the columns were probably recorded separately: record them by one clock, or shift one of them"
        yield found, advice, float(left[best] / left[none])
