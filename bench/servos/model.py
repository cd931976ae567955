"""A position-controlled servo, simulated free-running from its goal alone, many parameter sets and stretches at once.

With the goal g, dead time d, motor angle q, speed w, and all torques per moment of inertia J,

    dw/dt = drive - b*w - f*sgn(w) + o + s*sin(q) + c*cos(q) + m*r(t)
    drive = clip(a*slack(u(t - d) - y) - k*w + v*du/dt, -l, +l)

a = kp/J - 1/s**2; k = kv/J - 1/s; b = K_w/J - 1/s; f = K_0/J, l = limit/J, o = offset/J - rad/s**2 (m/s**2); s, c =
gravity/J; m = 1/J times the known torque r, which is taken at the measured position and corrected by its slope; v =
feed-forward/J - 1/s. u is the goal, which changes no faster than the speed limit; slack removes a dead band from the
position error; y is q behind a play, as an encoder on the output has it.

Each step is exact for the linear part (the 2x2 matrix exponential of its regime: in control, or with no torque that
depends on position); a stop inside a step is located and the rest of the step continues from there, so that the error
is of second order in the step also with stick-slip. The steps of a parameter set begin where its delayed goal jumps, as
a jump inside a step at the limit is an error of first order; between them samples are interpolated. Stretches and
parameter sets are stepped together, since a NumPy call costs about the same for one state and for 200.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array

#: Parameters with the value at which each is absent.
NULL: dict[str, float] = {
    "stiffness": 0.0,
    "drive_damping": 0.0,
    "damping": 0.0,
    "friction": 0.0,
    "dead_time": 0.0,
    "offset": 0.0,
    "sine": 0.0,
    "cosine": 0.0,
    "mobility": 0.0,
    "limit": np.inf,
    "feedforward": 0.0,
    "speed_limit": np.inf,
    "dead_band": 0.0,
    "play": 0.0,
}
#: Longest step of the integration - s -, in the search; as a share of a radian of the loop's own frequency afterwards.
STEP, SHARE = 3e-3, 0.1


@dataclass(frozen=True)
class Stretches:
    """Stretches of equal length of a recording, each simulated from its measured beginning.

    Attributes:
        period: of the samples - s.
        starts: first sample of each (w,).
        length: samples of each.
        goal: of the whole recording - rad (m) - (n,); it is held from sample to sample, as in a controller.
        known: torque known to act against the motion, less `known_slope` times the measured position - N*m (N) - (n,);
            zero where none is.
        known_slope: how it changes with position - N*m/rad (N/m) - (n,).
        position, speed: at the beginning of each - rad (m), rad/s (m/s) - (w,).
        steps: of the integration in each sample.
    """

    period: float
    starts: NDArray[np.int64]
    length: int
    goal: Array
    known: Array
    known_slope: Array
    position: Array
    speed: Array
    steps: int

    def resolving(self, stiffness: float) -> Stretches:
        """The same with steps that resolve when a loop of this stiffness - 1/s**2 - reaches a limit and returns from
        it."""
        return replace(self, steps=int(np.ceil(self.period * max(1.0 / STEP, np.sqrt(stiffness) / SHARE))))

    def samples(self) -> NDArray[np.int64]:
        """Numbers of their samples (w, length)."""
        return self.starts[:, None] + np.arange(self.length)


def simulated(values: Mapping[str, Array], stretches: Stretches) -> tuple[Array, Array]:
    """Position - rad (m) - of parameter sets along stretches (p, w, length), and each set's largest share of its limit.

    Args:
        values: parameters of NULL (p,) each; those left out are absent. The share is of the torque that the controller
            requests, in units of the limit where there is one, else per J - rad/s**2 (m/s**2) - (p,).
    """
    sets = next(iter(values.values())).size
    given = {name: np.asarray(values.get(name, np.full(sets, null)))[:, None] for name, null in NULL.items()}
    h, dead_time = stretches.period / stretches.steps, given["dead_time"][:, 0]
    whole = np.floor(dead_time / h + 1e-9)
    part = np.maximum(dead_time / h - whole, 0.0)
    goal = _delayed(whole, stretches)
    slope = None
    if given["feedforward"].any():
        slope = (goal - _delayed(whole + stretches.steps, stretches)) / stretches.period
    load = None
    if given["mobility"].any():
        load = np.array([_between(one, part, stretches) for one in (stretches.known, stretches.known_slope)])
    return _integrated(given, h, part[:, None], goal, slope, load, stretches)


def _integrated(
    given: Mapping[str, Array],
    h: float,
    part: Array,
    goal: Array,
    slope: Array | None,
    load: Array | None,
    stretches: Stretches,
) -> tuple[Array, Array]:
    """The integration; `part` of a step by which the steps begin after the samples (p, 1), `goal` and `slope` (steps,
    p, w), `load` (2, steps, p, w)."""
    a, k, b, f, limit = (given[name] for name in ("stiffness", "drive_damping", "damping", "friction", "limit"))
    slack, play = given["dead_band"], 0.5 * given["play"]
    limited, slacked, played = bool(np.isfinite(limit).any()), bool(slack.any()), bool(play.any())
    gravity = bool(given["sine"].any() or given["cosine"].any())
    slewed = bool(np.isfinite(given["speed_limit"]).any())
    control, drift, coast = (_exact(*one, h) for one in ((a, b + k), (0.0 * a, b + k), (0.0 * a, b)))
    w = np.broadcast_to(stretches.speed, (a.size, stretches.starts.size)).copy()
    q = stretches.position + part * h * w
    y = q.copy()
    out, u, most = np.empty((stretches.length, *q.shape)), goal[0], np.zeros_like(q)
    count, out[0] = stretches.steps, stretches.position
    for step in range((stretches.length - 1) * count):
        u = u + _clipped(goal[step] - u, given["speed_limit"] * h) if slewed else goal[step]
        error, regime = u - y, control
        if slacked:
            error = error - _clipped(error, slack)
        force = a * error
        if slope is not None:
            force = force + given["feedforward"] * slope[step]
        if slacked or played:
            free = (error == 0.0) & slacked | (np.abs(q - y) < play)
            regime = [np.where(free, *pair) for pair in zip(drift, control, strict=True)]
        demand = force - k * w
        most = np.maximum(most, np.abs(demand))
        if limited and np.count_nonzero(over := np.abs(demand) > limit):
            force = np.where(over, _clipped(demand, limit), force)
            regime = [np.where(over, *pair) for pair in zip(coast, regime, strict=True)]
        force = force + given["offset"]
        ahead = q + 0.5 * h * w
        if gravity:
            force = force + given["sine"] * np.sin(ahead) + given["cosine"] * np.cos(ahead)
        if load is not None:
            force = force - given["mobility"] * (load[0, step] + load[1, step] * ahead)
        before, (q, w) = (q, w), _moved(q, w, force, f, regime, h)
        if (step + 1) % count == 0:
            at = _inside(before, (q, w), 1.0 - part, h)
            out[(step + 1) // count] = np.clip(y, at - play, at + play) if played else at
        y = np.clip(y, q - play, q + play) if played else q
    return np.moveaxis(out, 0, -1), (most / np.where(np.isfinite(limit), limit, 1.0)).max(axis=1)


def _clipped(values: Array, reach: Array) -> Array:
    """Values between -reach and reach: `np.clip` takes three times as long on arrays as small as these."""
    return np.minimum(np.maximum(values, -reach), reach)


def _moved(q: Array, w: Array, force: Array, f: Array, regime: list[Array], h: float) -> tuple[Array, Array]:
    """Position and speed after a step under a force without damping; friction stops, keeps or opposes."""
    held = _clipped(force, f)
    net = force - np.where(w == 0.0, held, np.copysign(f, w))
    qw, qf, ww, wf = regime
    after, speed = q + qw * w + qf * net, ww * w + wf * net
    stops = (speed * w < 0.0) & (f > 0.0)
    if np.count_nonzero(stops):
        share = np.where(stops, w / np.where(stops, w - speed, 1.0), 1.0)
        rest, net = (1.0 - share) * h, force - held
        after = np.where(stops, q + 0.5 * share * h * w + 0.5 * net * rest**2, after)
        speed = np.where(stops, net * rest, speed)
    return after, speed


def _exact(a: Array, b: Array, h: float) -> list[Array]:
    """What a step of dw/dt = F - a*(q - q0) - b*w adds to q per w and F, and what w becomes per w and F: (p, 1) each.

    The exponential of [[0, 1, 0], [-a, -b, 1], [0, 0, 0]]*h by its series, halved until it converges at once.
    """
    halvings = max(0, int(np.ceil(np.log2(max(1e-30, float(np.max(np.sqrt(a) * h + b * h)))))) + 2)
    matrix = np.zeros((a.shape[0], 3, 3))
    matrix[:, 0, 1], matrix[:, 1, 2] = 1.0, 1.0
    matrix[:, 1, 0], matrix[:, 1, 1] = -a[:, 0], -b[:, 0]
    small, term = matrix * (h / 2**halvings), np.eye(3)
    exponential = np.tile(np.eye(3), (a.shape[0], 1, 1))
    for order in range(1, 12):
        term = term @ small / order
        exponential = exponential + term
    for _ in range(halvings):
        exponential = exponential @ exponential
    return [exponential[:, i, j][:, None] for i, j in ((0, 1), (0, 2), (1, 1), (1, 2))]


def _inside(before: tuple[Array, Array], after: tuple[Array, Array], share: Array, h: float) -> Array:
    """Position at a share of a step from positions and speeds at its ends, by the cubic through them."""
    (q, w), (end, speed) = before, after
    late = share * share * (3.0 - 2.0 * share)
    return q + late * (end - q) + share * (1.0 - share) * h * ((1.0 - share) * w - share * speed)


def _delayed(late: Array, stretches: Stretches) -> Array:
    """The goal, held after each sample, as many whole steps later (p,): (steps, p, w)."""
    steps = np.arange((stretches.length - 1) * stretches.steps)[:, None] - late
    at = stretches.starts + np.floor(steps / stretches.steps).astype(np.int64)[:, :, None]
    return stretches.goal[np.clip(at, 0, stretches.goal.size - 1)]


def _between(samples: Array, part: Array, stretches: Stretches) -> Array:
    """Samples, interpolated in the middles of steps that begin parts of a step (p,) after them: (steps, p, w)."""
    middles = (np.arange((stretches.length - 1) * stretches.steps)[:, None] + 0.5 + part) / stretches.steps
    return np.interp(stretches.starts + middles[:, :, None], np.arange(samples.size), samples)
