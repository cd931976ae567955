"""Backlash: motor and load are joined through a dead zone (a gear, a worn key).

    M_c = 0 for |p| <= g/2, beyond it k*(|p| - g/2)*sgn(p) + d*dp/dt, never pulling; p = q_m - q_l

g - gap - rad (m); k, d - stiffness - N*m/rad (N/m) - and damping - N*m*s/rad (N*s/m) - of the contact; p - angle of the
motor less that of the load. Sensor and friction sit at the motor. In the balance the load's acceleration less the
motor's is a column of strength J_l, and the load is driven along the recorded motion,

    q_l'' = w_c**2*e + 2*D*w_c*e' - c*q_l,  e = p - clip(p, -g/2, g/2)

e - penetration of the contact, 0 within the gap - rad (m); w_c - frequency of the contact - rad/s -, D its damping
ratio, both per unit of load inertia; c - rate of a spring on the load's side - 1/s**2. The contact's damping is an
impulse 2*D*w_c*de, so it also acts while the contact opens.

Impacts are short and hard, and the instant of one hangs on how the load left the other side of the gap: a few rows are
far off whatever the shape. So shapes are compared by Cauchy's likelihood, sum(log(1 + (r/s)**2)), which lets them be.
A softer contact looks like a wider gap, and each impact errs by its own instant: a ridge along which the likelihood is
rough, so that its curvature at the top tells nothing of how far the shape is open. What tells is how the likeliest
shape moves when stretches of the recording are resampled with replacement (block bootstrap).
Source: M. Nordin, P.-O. Gutman, Automatica 38 (2002) 1633-1649, sec. 2 (dead zone with stiff contact); P. J. Huber,
E. M. Ronchetti, Robust Statistics, 2nd ed., 2009, ch. 7; B. Efron, R. J. Tibshirani, An Introduction to the Bootstrap,
1993, sec. 8.6.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, splined, symmetric_inverse
from bench.effects.effect import Contact, Fitted, Load
from bench.effects.mjcf import Spec, add_coupling_joint
from bench.effects.shape import FREQUENCY, Shape, Shapes, extended
from bench.effects.signals import Axis, Base, Number, Scope, Signals
from bench.trace.filter import Column
from bench.units import Quantity

#: Contact of a gear whose own is not known: natural frequency against the two inertias - rad/s - and damping ratio.
CONTACT_FREQUENCY, CONTACT_DAMPING_RATIO = 2.0 * np.pi * 200.0, 0.2
#: Impedance of the joint's limit: constant, and so small that stiffness and damping below act unattenuated.
IMPEDANCE = (0.01, 0.01, 1.0, 0.5, 2.0)
#: Factors of gap, frequency and damping within which a recording does not tell a contact from another.
INDISTINCT = (1.01, 1.1, 1.1)
#: Steps of the integration per radian of the contact's oscillation: the trapezoidal rule errs by 1/(12*steps**2) of it.
STEPS_PER_RADIAN = 6.0
#: Windows that a recording is cut into, which are integrated side by side, and samples of the shortest.
WINDOWS, SHORTEST = 128, 60
#: Share of the gap to which a window's start agrees with the end of the window before.
CLOSED = 1e-5
#: Gaps in travel of the motor at the recording's RMS speed over one filter width, wide ones closer, as impacts shift by
#: more widths of the filter the wider the gap is; contacts - rad/s; damping ratio.
GAPS = (*np.geomspace(0.005, 0.8, 24).tolist(), *np.geomspace(0.88, 8.0, 24).tolist())
CONTACTS = tuple(2.0 * np.pi * f for f in (40.0, 80.0, 130.0, 210.0))
DAMPING = 0.4
#: Offsets around a shape in each round of refinement - gap, frequency, damping - and their size at first, as factor
#: e**offset. Refinement starts from the likeliest shapes of several contacts, and ends with the likeliest of all.
OFFSETS = np.stack([m.ravel() for m in np.meshgrid(np.linspace(-1, 1, 5), [-1, 0, 1], [-1, 0, 1], indexing="ij")], 1)
SPREAD = (0.12, 0.4, 0.5)
ROUNDS, STARTS, ALL_STARTS = 6, 3, 2
#: Residual in noise floors beyond which a row counts less and less, and reweightings of the least squares.
SCALE, REWEIGHTED = 3.0, 6
#: Samples of all shapes tried at once, which bounds memory: 8 bytes each, some four times over.
TOGETHER = 4_000_000
#: Factors e**x around a shape that are compared for its spread: of gap, frequency and damping.
AROUND = (np.linspace(-0.12, 0.12, 7), np.linspace(-0.6, 0.6, 5), np.linspace(-0.5, 0.5, 3))
#: Gap over what the contact yields to the peak torque - 1 -, below which it is a damped spring: real gaps are .04 and
#: more, what damps a motor without a load is .002.
OF_YIELDING = 0.005
#: Length of what is drawn: longer than a load rings after an impact - s.
STRETCH = 0.2
#: Standard errors that all resampled recordings share, as shares: a contact of microns hardly stands out of the noise
#: of the motion that presses it, and rebounds run faster than samples follow, so the likeliest one is softer and damps
#: more. Of 39 drawn axes (`python -m tests.studies.blind --only backlash`, seeds 101 and 102) the logarithms of
#: gap, frequency and damping ratio err by .03, .50 and 1.46 by root mean square, 1.34 of it too much damping.
SHARED = np.array([0.02, 0.45, 1.4])
#: Resampled recordings.
DRAWS = 400


class Backlash(Contact):
    name = "backlash"
    summary = "motor and load are joined through a dead zone"
    quantities = (
        Quantity("gap", "g", "rad", lower=0.0, null=0.0),
        Quantity("contact_stiffness", "k", "N*m/rad", lower=0.0, minor=True),
        Quantity("contact_damping", "d", "N*m*s/rad", lower=0.0, minor=True),
    )
    shapes = (  # impacts move in jumps: a smaller step of a derivative would see only one
        Shape(quantities[0], reach=0.0, step=3e-3),
        Shape(Quantity("contact_frequency", "w_c", "rad/s", lower=0.0), reach=0.0, step=3e-2),
        Shape(Quantity("contact_damping_ratio", "D", "dimensionless", lower=0.0), reach=0.0, step=3e-2),
        Shape(Quantity("spring_rate", "c/J_l", "1/s**2", lower=0.0), reach=0.0, step=0.0),
    )
    replaces = frozenset({"elastic_coupling", "current_loop_lag"})

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return self.columns_of(signals, [shape])

    def columns_of(self, signals: Signals, shapes: Shapes, loads: Sequence[Load] = ()) -> list[Column]:
        """The same; of what acts on the load, a spring's share is a shape of its own."""
        return dead_zone_columns([signals], np.array(shapes))[0]

    def tables_of(self, stretches: Sequence[Signals], shapes: Shapes) -> list[list[Column]]:
        """The same, integrated side by side."""
        return dead_zone_columns(stretches, np.array(shapes))

    def noise_of_motion(self, shape: Sequence[float], omega: Array) -> Array:
        """The load does not follow it."""
        return -np.ones_like(omega)

    def wave_number(self, shape: Sequence[float]) -> float:
        return 2.0 * np.pi / shape[0]

    def period(self, shape: Sequence[float]) -> float:
        return 2.0 * np.pi / shape[1]

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        """The gap is more than a small part of what its contact yields to the peak torque."""
        return all(  # of shapes whose strength is known
            gap * load * frequency**2 > OF_YIELDING * scope.peak_effort
            for (load,), (gap, frequency, *_) in zip(strengths, shapes, strict=False)
        )

    def open_torque(self, fitted: Fitted, shape: Sequence[float]) -> Array:
        """Rows soon after an impact: its instant hangs on how the load left the other side of the gap."""
        shapes = np.tile(shape, (2 * len(INDISTINCT) + 1, 1))
        for k, factor in enumerate(INDISTINCT):
            shapes[2 * k + 1, k] *= factor
            shapes[2 * k + 2, k] /= factor
        columns = fitted.seen(dead_zone_columns(fitted.stretches, shapes), of_motion=True)
        return np.abs(columns[:, 1:] - columns[:, :1]).max(axis=1)

    def in_place_of(self, fitted: Fitted, promises: Callable[[float], bool]) -> tuple[float, ...] | None:
        return likeliest_shape(fitted, promises)

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Gap, and what the contact's frequency and damping ratio are with the load's inertia."""
        gap, contact, ratio, _ = shape
        stiffness = strengths[0] * contact**2
        return {"gap": gap, "contact_stiffness": stiffness, "contact_damping": 2.0 * ratio * stiffness / contact}

    def spread(self, fitted: Fitted, shape: Sequence[float]) -> Array:
        """Of gap, frequency and damping (3, 3), by resampled recordings.

        Along the ridge of softer contacts and wider gaps curvature tells nothing.
        """
        contact, spring_rate = np.array(shape[:3]), shape[3]
        offsets = np.stack([m.ravel() for m in np.meshgrid(*AROUND, indexing="ij")], axis=1)
        shapes = np.column_stack([contact * np.exp(offsets), np.full(len(offsets), spring_rate)])
        others, place, time = fitted.columns.T.copy(), int(fitted.places(lambda effect: effect is self)[0]), fitted.time
        edges = np.unique(np.searchsorted(time, np.arange(time[0], time[-1], STRETCH)))
        misfits = []
        for column in _columns(fitted, shapes).T:
            others[place] = column
            misfits.append(np.add.reduceat(cauchy(others, fitted.effort, SCALE * fitted.floor)[1], edges))
        rng = np.random.default_rng(0)
        drawn = rng.multinomial(edges.size, np.full(edges.size, 1.0 / edges.size), size=DRAWS)
        likeliest = offsets[np.argmin(np.stack(misfits) @ drawn.T, axis=0)]
        step = np.array([axis[1] - axis[0] for axis in AROUND])
        relative = likeliest.T @ likeliest / DRAWS + np.diag(step**2 / 12.0 + SHARED**2)
        return relative * np.outer(contact, contact)

    def defaults(self, axis: Axis) -> Mapping[str, Number]:
        """A contact that resonates at CONTACT_FREQUENCY; recordings of an axis hardly tell it."""
        motor = np.asarray(axis.motor_inertia)
        reduced = float(motor * (axis.inertia - motor) / axis.inertia)
        return {
            "contact_stiffness": reduced * CONTACT_FREQUENCY**2,
            "contact_damping": 2.0 * CONTACT_DAMPING_RATIO * reduced * CONTACT_FREQUENCY,
        }

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A joint with a range between motor and load; limits take acceleration, hence the inverse inertia."""
        import mujoco

        joint = add_coupling_joint(spec, name)
        inverse = 1.0 / float(axis.motor_inertia) + 1.0 / float(axis.inertia - axis.motor_inertia)
        joint.range = [-0.5 * values["gap"], 0.5 * values["gap"]]
        joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        joint.solref_limit = [-values["contact_stiffness"] * inverse, -values["contact_damping"] * inverse]
        joint.solimp_limit = list(IMPEDANCE)


def load_positions(angles: Sequence[Array], sample_period: float, shapes: Array) -> list[Array]:
    """Positions of the load behind several dead zones in stretches of a recording - rad (m) - (n, k) each.

    The motor moves along a cubic spline through its samples. A stretch is cut into windows that are integrated side by
    side, as those of stretches with windows as long are, each from where the one before it ended in the sweep before,
    until starts and ends agree: a contact forgets how it was entered, so few sweeps do. The load starts with the motor,
    in the middle of the gap.

    Args:
        angles: of the motor - rad (m) - (n,) each.
        sample_period: s.
        shapes: (k, 4): gap, contact's frequency and damping, spring's rate.
    """
    lengths = np.array([max(SHORTEST, -(-(angle.size - 1) // WINDOWS)) for angle in angles])
    found: dict[int, Array] = {}
    for length in np.unique(lengths).tolist():
        alike = np.flatnonzero(lengths == length).tolist()
        twists = _twists([angles[k] for k in alike], length, sample_period, shapes)
        found |= {k: angles[k][:, None] - twist for k, twist in zip(alike, twists, strict=True)}
    return [found[k] for k in range(len(angles))]


def _twists(angles: Sequence[Array], length: int, sample_period: float, shapes: Array) -> list[Array]:
    """Angles of the motor (n,) less the load's (n, k) in windows of so many samples; see `load_positions`."""
    substeps = max(2, int(np.ceil(sample_period * shapes[:, 1].max() * STEPS_PER_RADIAN)))
    cut = [_windows(angle, length, substeps) for angle in angles]
    windows = np.concatenate([between for between, _ in cut], axis=1)
    ends, size = np.cumsum([starts.size for _, starts in cut]), len(shapes)
    goes_on = ~np.isin(np.arange(ends[-1]), ends - 1)
    twist = np.zeros((ends[-1], size))
    travel = np.repeat(np.concatenate([starts for _, starts in cut])[:, None], size, axis=1)
    found = np.empty((length, ends[-1], size))
    window, shape = (pairs.ravel() for pairs in np.indices(twist.shape))
    while window.size:
        start = twist[window, shape], travel[window, shape]
        twists, last, way = _run(windows, window, shapes[shape], start, sample_period / substeps, substeps)
        found[:, window, shape] = twists
        inside = goes_on[window]
        window, shape, last, way = window[inside] + 1, shape[inside], last[inside], way[inside]
        away = np.abs(way - travel[window, shape]) * (substeps / sample_period) / shapes[shape, 1]
        away = np.maximum(away, np.abs(last - twist[window, shape]))
        twist[window, shape], travel[window, shape] = last, way
        apart = away > CLOSED * shapes[shape, 0]
        window, shape = window[apart], shape[apart]
    samples = [part.transpose(1, 0, 2).reshape(-1, size) for part in np.split(found, ends[:-1], axis=1)]
    first = np.zeros((1, size))
    return [np.concatenate([first, part[: angle.size - 1]]) for angle, part in zip(angles, samples, strict=True)]


def _windows(angle: Array, length: int, substeps: int) -> tuple[Array, Array]:
    """Angles between samples (n,) in windows of so many (length*substeps + 1, w), and the way of a step there (w,)."""
    between, slopes = splined(angle, substeps)
    count, step = -(-(angle.size - 1) // length), length * substeps
    fine = np.pad(between, (0, count * step + 1 - between.size), mode="edge")
    starts = step * np.arange(count)
    return fine[np.arange(step + 1)[:, None] + starts], slopes[starts] / substeps


def _run(
    angles: Array, window: NDArray[np.intp], shapes: Array, start: tuple[Array, Array], step: float, every: int
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
        _beyond(ahead, below, above, after)
        np.equal(after, 0.0, out=free)
        np.multiply(explicit, before, out=held)
        np.multiply(resist, before, out=held, where=free)  # where they part, or were apart
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


def dead_zone_columns(stretches: Sequence[Signals], shapes: Array) -> list[list[Column]]:
    """Load's acceleration less the motor's behind several dead zones, with the spring's share of it, in each stretch.

    Where the speed is the source, the motor's angle is its integral, whose noise no resolution of an encoder adds to.

    Args:
        stretches: of a recording.
        shapes: (k, 4), see `load_positions`.
    """
    angles = [_angle(signals) for signals in stretches]
    positions = load_positions(angles, stretches[0].sample_period, shapes)
    twists = [(position - angle[:, None]).T for position, angle in zip(positions, angles, strict=True)]
    rates = shapes[:, 3]
    return [[[(load, 2), (rate * load, 0)] for load, rate in zip(twist, rates, strict=True)] for twist in twists]


def _angle(signals: Signals) -> Array:
    """Of the motor (n,) - rad (m)."""
    if signals.source != "velocity":
        return signals.position
    speed = signals.velocity
    steps = 0.5 * signals.sample_period * (speed[1:] + speed[:-1])
    return signals.position[0] + np.concatenate([[0.0], np.cumsum(steps)])


@dataclass(frozen=True)
class Likely:
    """A dead zone's shape (4,), its negative logarithm of likelihood, and the load's spring rate that comes of it."""

    shape: Array
    misfit: float
    spring_rate: float

    def around(self, factors: Array) -> Array:
        """Shapes (k, 4) around it, with the spring that was found beside it."""
        return np.column_stack([self.shape[:3] * factors, np.full(len(factors), self.spring_rate)])


def likeliest_shape(fitted: Fitted, promises: Callable[[float], bool]) -> tuple[float, ...] | None:
    """Gap, contact's frequency and damping ratio, and spring's rate beside a fit without them; see `load_positions`.

    None where no shape of the first grid takes squares that promise more.
    """

    def likeliest(shapes: Array, columns: Array) -> Likely:
        found = []
        for shape, column in zip(shapes, columns.T, strict=True):
            theta, unlikely = cauchy(np.vstack([fitted.columns.T, column]), fitted.effort, SCALE * fitted.floor)
            rate, stiffness = float(shape[3]), _stiffness(fitted, theta[:-1])
            if rate > 0.0 and theta[-1] > 0.0 and stiffness > 0.0:
                rate = stiffness / float(theta[-1])
            found.append(Likely(shape, float(unlikely.sum()), rate))
        return min(found, key=lambda likely: likely.misfit)

    travel = fitted.scope.rms_speed * fitted.scope.width
    contacts = contacts_of(fitted.scope)
    load = fitted.base.inertia - fitted.scope.rotor_inertia
    pulled = max(_stiffness(fitted, fitted.theta), 0.0) / load if load > 0.0 else 0.0  # by a spring on the load's side
    axes = [np.array(contacts), np.array(GAPS) * travel, np.array([DAMPING]), np.unique([0.0, pulled])]
    grid = np.stack([m.ravel() for m in np.meshgrid(*axes, indexing="ij")], axis=1)[:, [1, 0, 2, 3]]
    shapes = np.split(grid, len(contacts))  # each contact in steps of its own, of which a soft one needs few
    columns = [_columns(fitted, part) for part in shapes]
    if not promises(float(fitted.gains(np.concatenate(columns, axis=1), 1).max())):
        return None
    starts = sorted(map(likeliest, shapes, columns), key=lambda likely: likely.misfit)[:STARTS]
    for level in range(1, ROUNDS):
        offsets = np.exp(OFFSETS * np.array(SPREAD) * 0.6 ** (level - 1))
        around = np.concatenate([start.around(offsets) for start in starts])
        columns = np.split(_columns(fitted, around), len(starts), axis=1)
        refined = map(likeliest, np.split(around, len(starts)), columns)
        starts = [min(pair, key=lambda likely: likely.misfit) for pair in zip(starts, refined, strict=True)]
        starts = sorted(starts, key=lambda likely: likely.misfit)[: STARTS if level < ALL_STARTS else 1]
    return tuple(float(value) for value in starts[0].shape)


def _columns(fitted: Fitted, shapes: Array) -> Array:
    """Columns (m, k) of many shapes, few at a time where the recording is long."""
    few = max(1, TOGETHER // max(fitted.time.size, 1))
    parts = [shapes[k : k + few] for k in range(0, len(shapes), few)]
    made = [fitted.seen(dead_zone_columns(fitted.stretches, part), of_motion=True) for part in parts]
    return np.concatenate(made, axis=1)


def contacts_of(scope: Scope) -> list[float]:
    """Frequencies of contact that a search begins with - rad/s: one that swings faster than samples follow is rigid."""
    fastest = np.pi / scope.sample_period
    return sorted({min(contact, fastest) for contact in extended(CONTACTS, FREQUENCY.factor(scope))})


def _stiffness(fitted: Fitted, theta: Array) -> float:
    return float(theta[fitted.places(lambda effect: effect.spring)][:1].sum())


def cauchy(columns: Array, effort: Array, scale: float) -> tuple[Array, Array]:
    """Coefficients (p,) of columns (p, m) by reweighted least squares; each row's -log of Cauchy's likelihood (m,)."""
    size = np.sqrt(np.einsum("ij,ij->i", columns, columns) / effort.size) + 1e-300
    columns = columns / size[:, None]
    weight, left, theta = np.ones(effort.size), effort, np.zeros(size.size)
    for _ in range(REWEIGHTED):
        weighted = columns * weight
        theta = symmetric_inverse(weighted @ columns.T, 1e-12) @ (weighted @ effort)
        left = effort - theta @ columns
        weight = 1.0 / (1.0 + (left / scale) ** 2)
    return theta / size, np.log1p((left / scale) ** 2)


EFFECT = Backlash()
