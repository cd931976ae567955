"""A load behind a dead zone, driven along a recorded motion: its position, and the columns that come of it.

    q_l'' = w_c**2*e + 2*D*w_c*e' - c*q_l - M_l/J_l,  e = p - clip(p, -g/2, g/2),  p = q_m - q_l

q_m, q_l - angle of motor and load - rad (m); e - penetration of the contact, 0 within the gap g - rad (m); w_c -
frequency of the contact - rad/s -, D its damping ratio, both per unit of load inertia; c - rate of a spring on the
load's side - 1/s**2; M_l/J_l - known torque of the other links, if the load is a link of a robot, over inertia. The
contact's damping is an impulse 2*D*w_c*de, so it also acts while the contact opens.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, splined
from bench.effects.shape import Shapes
from bench.effects.signals import Signals
from bench.trace.filter import Column
from bench.trace.motion import integrated

#: Steps of the integration per radian of the contact's oscillation: the trapezoidal rule errs by 1/(12*steps**2) of it.
STEPS_PER_RADIAN = 6.0
#: Windows that a recording is cut into, which are integrated side by side, and samples of the shortest.
WINDOWS, SHORTEST = 128, 60
#: Share of the gap to which a window's start agrees with the end of the window before.
CLOSED = 1e-5


def load_positions(
    angles: Sequence[Array],
    sample_period: float,
    shapes: Array,
    pulls: Sequence[tuple[Array, Array] | None] = (),
    heavier: Sequence[Array] = (),
) -> list[Array]:
    """Positions of the load behind several dead zones in stretches of a recording - rad (m) - (n, k) each.

    The motor moves along a cubic spline through its samples. A stretch is cut into windows that are integrated side by
    side, as those of stretches with windows as long are, each from where the one before it ended in the sweep before,
    until starts and ends agree: a contact forgets how it was entered, so few sweeps do. The load starts with the motor,
    in the middle of the gap or where known torque presses it.

    Args:
        angles: of the motor - rad (m) - (n,) each.
        sample_period: s.
        shapes: (k, 4): gap, contact's frequency and damping, spring's rate.
        pulls: of the load by what else acts on it, as `Signals.pull`; () of none.
        heavier: loads over that of the shapes (n,), of which a window takes the mean; () where all are of it.
    """
    inertias = heavier or [np.ones_like(angle) for angle in angles]
    lengths = np.array([max(SHORTEST, -(-(angle.size - 1) // WINDOWS)) for angle in angles])
    found: dict[int, Array] = {}
    for length in np.unique(lengths).tolist():
        alike = np.flatnonzero(lengths == length).tolist()
        own = [(angles[k], pulls[k] if pulls else None, inertias[k]) for k in alike]
        twists = _twists(own, length, sample_period, shapes)
        found |= {k: angles[k][:, None] - twist for k, twist in zip(alike, twists, strict=True)}
    return [found[k] for k in range(len(angles))]


def _twists(
    stretches: Sequence[tuple[Array, tuple[Array, Array] | None, Array]],
    length: int,
    sample_period: float,
    shapes: Array,
) -> list[Array]:
    """Angles of the motor (n,) less the load's (n, k) in windows of so many samples.

    By the angles of each stretch, the pull and how heavy the load is; see `load_positions`.
    """
    angles, pulls, heavier = zip(*stretches, strict=True)
    substeps = max(2, int(np.ceil(sample_period * shapes[:, 1].max() * STEPS_PER_RADIAN)))
    cut = [_windows(angle, length, substeps) for angle in angles]
    windows = np.concatenate([between for between, _ in cut], axis=1)
    slowed = [_slowed(pull, length, substeps, sample_period) for pull in pulls if pull is not None]
    pulling = np.concatenate(slowed, axis=2) if slowed else None
    sizes, size = np.array([starts.size for _, starts in cut], dtype=np.intp), len(shapes)
    ends, inertia = np.cumsum(sizes), np.concatenate([_means(each, length) for each in heavier])
    slower = np.stack([np.ones_like(inertia), inertia**-0.5, inertia**-0.5, 1.0 / inertia], axis=1)
    goes_on = ~np.isin(np.arange(ends[-1]), ends - 1)
    twist = np.zeros((ends[-1], size))
    firsts: NDArray[np.intp] = ends - sizes
    for first, angle, pull, more in zip(firsts, angles, pulls, heavier, strict=True):
        if pull is not None:
            twist[first] = _pressed(angle, pull[0] * more, sample_period, shapes)
    travel = np.repeat(np.concatenate([starts for _, starts in cut])[:, None], size, axis=1)
    found = np.empty((length, ends[-1], size))
    window, shape = (pairs.ravel() for pairs in np.indices(twist.shape))
    while window.size:
        start = twist[window, shape], travel[window, shape]
        own = shapes[shape] * slower[window]
        twists, last, way = _run(windows, pulling, window, own, start, sample_period / substeps, substeps)
        found[:, window, shape] = twists
        inside = goes_on[window]
        window, shape, last, way = window[inside] + 1, shape[inside], last[inside], way[inside]
        away = np.abs(way - travel[window, shape]) * (substeps / sample_period) / shapes[shape, 1]
        away = np.maximum(away, np.abs(last - twist[window, shape]))
        twist[window, shape], travel[window, shape] = last, way
        apart = away > CLOSED * shapes[shape, 0]
        window, shape = window[apart], shape[apart]
    samples = [part.transpose(1, 0, 2).reshape(-1, size) for part in np.split(found, ends[:-1], axis=1)]
    begun = np.split(twist[firsts], len(firsts))
    each = zip(angles, begun, samples, strict=True)
    return [np.concatenate([start, part[: angle.size - 1]]) for angle, start, part in each]


def _pressed(angle: Array, pull: Array, sample_period: float, shapes: Array) -> Array:
    """How far the motor is ahead of a load (k,) that goes along from the start, on the flank that has to drive it."""
    time = sample_period * np.arange(min(SHORTEST, angle.size))
    driving = 2.0 * np.polyfit(time, angle[: time.size], 2)[0] + np.mean(pull[: time.size])
    return np.sign(driving) * 0.5 * shapes[:, 0] + driving / shapes[:, 1] ** 2


def _windows(angle: Array, length: int, substeps: int) -> tuple[Array, Array]:
    """Angles between samples (n,) in windows of so many (length*substeps + 1, w), and the way of a step there (w,)."""
    between, slopes = splined(angle, substeps)
    count, step = -(-(angle.size - 1) // length), length * substeps
    fine = np.pad(between, (0, count * step + 1 - between.size), mode="edge")
    starts = step * np.arange(count)
    return fine[np.arange(step + 1)[:, None] + starts], slopes[starts] / substeps


def _means(values: Array, length: int) -> Array:
    """Of values (n,) in windows of so many (w,)."""
    starts = np.arange(0, values.size - 1, length)
    return np.add.reduceat(values, starts) / np.diff(starts, append=values.size)


def _slowed(pull: tuple[Array, Array], length: int, substeps: int, sample_period: float) -> Array:
    """Half of the way that a load loses in each step, and by how much more as it is ahead, by window (2, steps, w)."""
    count, step = -(-(pull[0].size - 1) // length), length * substeps
    middles = (np.arange(count * step) + 0.5) / substeps
    ways = [np.interp(middles, np.arange(each.size), each) for each in pull]
    return 0.5 * (sample_period / substeps) ** 2 * np.reshape(ways, (2, count, step)).transpose(0, 2, 1)


def _run(
    angles: Array,
    pulling: Array | None,
    window: NDArray[np.intp],
    shapes: Array,
    start: tuple[Array, Array],
    step: float,
    every: int,
) -> tuple[Array, Array, Array]:
    """Twists p after every so many steps (steps/every, k) of windows with shapes (k, 4), and the last with the travel.

    Trapezoidal rule, implicit where a step ends in contact. The travel is what the load goes in a step - rad (m).
    """
    gap, frequency, damping, spring = shapes.T
    above, below, half_step = 0.5 * gap, -0.5 * gap, 0.5 * step
    push = half_step * (half_step * frequency**2 + 2.0 * damping * frequency)
    resist = half_step * (half_step * frequency**2 - 2.0 * damping * frequency)
    implicit, explicit, pull = push / (1.0 + push), resist / (1.0 + push), half_step * step * spring
    springs = bool(spring.any())
    twist, travel = start
    found = np.empty(((angles.shape[0] - 1) // every, twist.size))
    ahead, after, before, moved, held = np.empty((5, twist.size))
    free = np.empty(twist.size, dtype=bool)
    _beyond(twist, below, above, before)
    for k, rise in enumerate(np.diff(angles, axis=0), 1):
        rise.take(window, out=ahead, mode="clip")
        ahead += twist
        ahead -= travel
        if pulling is not None:
            lost, more = pulling[:, k - 1, window]
            lost -= more * twist
            ahead += lost
            travel -= lost
            travel -= lost
        _beyond(ahead, below, above, after)
        np.equal(after, 0.0, out=free)
        np.multiply(explicit, before, out=held)
        np.multiply(resist, before, out=held, where=free)  # where they separate, or were separate
        np.multiply(implicit, after, out=moved)
        moved += held
        if springs:
            moved -= pull * (angles[k - 1].take(window) - twist + 0.5 * travel)
        travel += moved
        travel += moved
        np.subtract(ahead, moved, out=twist)
        _beyond(twist, below, above, before)
        if k % every == 0:
            found[k // every - 1] = twist
    return found, twist, travel


def _beyond(twist: Array, below: Array, above: Array, out: Array) -> None:
    """By how much twists (k,) are beyond their gaps, written to `out` (k,); `clip` would take longer."""
    np.maximum(twist, below, out=out)
    np.minimum(out, above, out=out)
    np.subtract(twist, out, out=out)


def dead_zone_columns(stretches: Sequence[Signals], shapes: Shapes) -> list[list[Column]]:
    """Load's acceleration less the motor's behind several dead zones, with the spring's share of it, in each stretch.

    Where the speed is the source, the motor's angle is its integral, whose noise no resolution of an encoder adds to.
    Shapes (k, 4) are as of `load_positions`.
    """
    angles = [
        s.position if s.source == "position" else s.position[0] + integrated(s.velocity, s.sample_period)
        for s in stretches
    ]
    table = np.asarray(shapes)
    heavier = [s.heavier for s in stretches]
    pulled = [s.pull(more) for s, more in zip(stretches, heavier, strict=True)]
    pulls = [pull for pull in pulled if pull is not None]
    positions = load_positions(angles, stretches[0].sample_period, table, pulls, heavier)
    twists = [(position - angle[:, None]).T for position, angle in zip(positions, angles, strict=True)]
    slopes = [0.0 if pull is None else more * pull[1] for pull, more in zip(pulled, heavier, strict=True)]
    return [
        [[*s.reaction(load), ((rate + slope) * load, 0)] for load, rate in zip(twist, table[:, 3], strict=True)]
        for s, twist, slope in zip(stretches, twists, slopes, strict=True)
    ]
