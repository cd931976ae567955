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
from numpy.typing import NDArray

from bench.arrays import Array
from bench.gate.check import Balanced, Check, Seen, absent, basis_of
from bench.names import percent
from bench.trace.trace import Trace

NAME = "balance_holds_throughout"
#: Blocks of a recording, and windows that one has at least.
BLOCKS, WINDOWS = 32, 6
#: Share of the effort that the balance explains, with the fault undone, from which on it is one.
EXPLAINED = 0.6
#: Share of the effort that one balance of all blocks explains, from which on no other is sought.
EXPLAINED_BY_ALL = 0.95
#: Share of the blocks that the balance of most need not explain, stretches omitted to begin with, and steps from there.
OMITTED, STARTS, ROUNDS = 0.4, 7, 20
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
#: The same of a delay that is a fault: 29 of 37 currents 20 ms late leave 0.06 to 0.2, a viscous coupling 0.29.
DELAYED = 0.2

ALLOWED = "one balance of effort and motion, from beginning to end"


def holds(seen: Seen) -> Check:
    """Whether one balance is valid throughout, and the likeliest fault where none does."""
    fitted = seen.balance()
    if seen.effort is None or fitted is None:
        return absent(NAME, seen.unbalanced, ALLOWED)
    _, name = seen.effort
    if (fault := _in_blocks(fitted, name, seen.trace)) is not None:
        return Check(NAME, "fail", fault[0], ALLOWED, fault[1])
    for found, advice, left in _delayed(fitted, name, seen.trace):
        return Check(NAME, "fail" if left <= DELAYED else "warn", found, ALLOWED, advice)
    return Check(NAME, "pass", "one balance is valid", ALLOWED)


def _in_blocks(fitted: Balanced, name: str, trace: Trace) -> tuple[str, str] | None:
    """What is wrong with the effort for a stretch of time, and what to do; None where nothing is."""
    likeliest = None
    effort, count = fitted.effort, min(BLOCKS, fitted.effort.size // WINDOWS)
    edges = np.linspace(0, effort.size, count + 1).astype(int)
    basis, sizes = basis_of(fitted.columns), np.diff(edges)
    along = np.add.reduceat(basis * effort[:, None], edges[:-1]).T
    power, signs = np.add.reduceat(effort * effort, edges[:-1]), _signs(along)
    demands = np.stack([basis @ _of_most(basis, along * each, power, edges) for each in (np.ones(count), signs)])
    turned = np.add.reduceat(demands[1] * effort, edges[:-1]) < 0.0
    asked = np.add.reduceat(demands**2, edges[:-1], axis=1) / sizes
    demanding = asked > DEMANDED**2 * np.mean(demands**2, axis=1, keepdims=True)
    rescaled = _rescaled(demands[0], effort, edges)
    right = np.stack([~rescaled.any(axis=0), ~turned])
    # a balance of blocks at rest does not determine what motion takes
    known = asked < SCALED**2 * asked.max(axis=1, initial=0.0, where=right, keepdims=True)
    quiet, scaled = rescaled & known[0]
    faults = (
        (quiet, 0.0, f"{name} is nearly zero while the motion takes effort", "the signal dropped out"),
        (scaled, 0.0, f"{name} has another scale", "a unit changed"),
        (turned & known[1] & demanding[1], -1.0, f"the sign of {name} is turned", "a mode of the drive turned it"),
    )
    least, plain = 1.0 - EXPLAINED, _left(fitted, np.ones(effort.size))
    for wrong, factor, found, why in faults:
        borders = np.convolve(wrong, np.ones(3), "same") > 0.0  # the fault may begin or end within them
        each = np.where(wrong, factor, np.where(borders, 0.0, signs if factor else 1.0))
        at, left = np.flatnonzero(wrong & demanding[int(factor)]), _left(fitted, np.repeat(each, sizes))
        if at.size and left < min((LEFT_BY_SIGNS if factor else LEFT) * plain, least):
            first, last = fitted.starts[edges[at[0]]], fitted.starts[edges[at[-1] + 1] - 1] + fitted.length
            begins, ends = (float(trace.time[min(k, len(trace) - 1)] - trace.time[0]) for k in (first, last))
            likeliest = (
                f"{found} from about {begins:.3g} s to {ends:.3g} s",
                f"likeliest {why}: cut the recording there",
            )
            least = left
    return likeliest


def _rescaled(demand: Array, effort: Array, edges: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Blocks (2, blocks) whose effort is nearly zero, and whose effort and its changes follow the demand by another
    scale than most."""
    products = np.stack([demand, effort, demand * demand, effort * effort, demand * effort])
    mean_asked, mean, asked, had, both = np.add.reduceat(products, edges[:-1], axis=1) / np.diff(edges)
    asks, has, vary = asked - mean_asked**2, had - mean**2, both - mean_asked * mean
    alike = np.abs(vary) > ALIKE * np.sqrt(np.maximum(asks * has, 0.0))
    scales = np.log(np.abs([both / np.maximum(asked, 1e-300), vary / np.maximum(asks, 1e-300)]) + 1e-300)
    off = scales - np.median(scales, axis=1, keepdims=True)
    other = alike & (np.abs(off).min(axis=0) > np.log(SCALED)) & (off[0] * off[1] > 0.0)
    return np.stack([had < QUIET**2 * asked, other])


def _of_most(basis: Array, along: Array, power: Array, edges: NDArray[np.intp]) -> Array:
    """Balance (r,) that most blocks have: least trimmed squares of their residuals over their effort (P. J. Rousseeuw,
    J. Am. Stat. Assoc. 79, 1984, 871-880).

    It is that of all blocks if this explains their effort, and else sought from the blocks outside a stretch of time.

    Args:
        basis: (n, r).
        along, power: its products with the effort (r, blocks), and the effort's with itself, in each block.
        edges: of the blocks.
    """
    if np.sum(along.sum(axis=1) ** 2) > EXPLAINED_BY_ALL * power.sum():
        return along.sum(axis=1)
    size, place = np.maximum(power, 1e-2 * np.median(power)), np.linspace(0.0, 1.0, power.size)
    grams = np.add.reduceat(basis[:, :, None] * basis[:, None], edges[:-1]) / size[:, None, None]
    starts = (abs(place - middle) > OMITTED / 2.0 for middle in np.linspace(0.0, 1.0, STARTS))
    found = [_trimmed(used, grams, along / size, power / size) for used in starts]
    return min(found, key=lambda one: one[0])[1]


def _trimmed(used: NDArray[np.bool_], grams: Array, along: Array, power: Array) -> tuple[float, Array]:
    """Residual of the blocks that fit best, and their balance, from some blocks to start from."""
    count, left, balance = round((1.0 - OMITTED) * power.size), power, np.zeros(len(along))
    for _ in range(ROUNDS):
        balance = np.linalg.lstsq(grams[used].sum(axis=0), along[:, used].sum(axis=1))[0]
        left = power - 2.0 * balance @ along + np.einsum("i,kij,j->k", balance, grams, balance)
        before, used = used, left <= np.partition(left, count - 1)[count - 1]
        if np.array_equal(used, before):
            break
    return float(left[used].sum()), balance


def _left(fitted: Balanced, factors: Array) -> float:
    """Share of the effort that the balance does not explain in the windows, times factors (n,), without those of 0."""
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
