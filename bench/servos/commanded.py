"""A position-controlled joint whose gains are known: inertia, friction, bias and delay from its goal and its position.

The torque follows from both, so the joint's balance is linear and nothing is simulated. With the goal g, which is held
from sample to sample, the measured position q and a known load of links M,

    kp*g(t - d) - kp*q - M = J*alpha + (K_w + kd)*omega + K_0*sgn(omega) - kp*b

d - dead time, b - joint bias: position less goal without a torque. A held goal acts as its interpolation half a period
T later, with T**2/24 of its second derivative. The delay is found by Gauss-Newton steps from the best of a grid; joints
of one robot share it.

The goal is exact, and noise n of the position is in q, in M and in the columns: errors in variables. Of a smoothed
signal E[n*n''] = -E[n'**2], so kp*q adds kp*E[n'**2] to the moment of alpha; the links' inertia dJ(q) beyond that in
the configuration of the MJCF takes dJ*E[n''**2] from it. Both are taken out with the noise of the columns themselves.
What remains uncertain of the noise's level is in the covariance, and of several filters the one with the least errors
is taken.

A controller at its force limit l, which nobody stated, makes the torque +-l, whatever it requests. The balance is
fitted to samples within the limit; where more is requested, the same balance gives the torque, whose mean is l.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy  # its special functions load when first used: 0.2 s
from numpy.typing import NDArray

from bench.arrays import NORMAL95, Array
from bench.axis_kind import ARMATURE, COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.effects.signals import Signals
from bench.errors import InputError, UndeterminedError
from bench.fit.hypothesis import Hypothesis, lay_out
from bench.fit.rows import Rows, known_of
from bench.fit.solution import NormalEquations, block_edges, equations, estimated, solved
from bench.names import percent
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.filter import LEAST_WIDTH, Column, GaussianFilter
from bench.trace.motion import slope
from bench.trace.noise import TOP
from bench.trace.signals import KNOWN_INERTIA, KNOWN_MOMENTUM, KNOWN_TORQUE
from bench.trace.trace import Trace, with_known

#: Columns of the balance.
TERMS = INERTIA, VISCOUS, COULOMB, MISALIGNMENT, OFFSET
#: Filters that are tried: widths in shortest ones.
WIDTHS = tuple(1.4**k for k in range(8))
#: Growth of the product of three errors over the least at which no wider filter is tried.
WORSE = 10.0
#: Delays that a search begins at - s -, steps of it at most, and the step at which it has converged - s.
DELAYS, STEPS, CONVERGED = np.arange(0.0, 0.061, 0.01), 12, 1e-6
#: Variance of a median over that of a mean, by which the noise's level is read.
OF_MEDIAN = 0.5 * math.pi
#: Half width of the inertia, as a share of it, above which a log does not determine the balance.
DETERMINED = 0.5
#: Share of the squares of the torque that a balance has to explain: noise takes 1e-4 of it, a limit a quarter.
EXPLAINS = 0.9
#: Share by which the links' weight may be off before the gains are doubted.
OFF = 0.02
#: Shares of the largest request within which a balance is sought that no limit disturbs; request over a limit at which
#: it is surely reached; rounds in which both are found together, and steps to a level in each of them.
BEGINNINGS, SURELY, ROUNDS, LEVELS = tuple(0.6 * 0.7**k for k in range(10)), 1.1, 3, 30
#: Relative step at which a level has converged, and fewest times that a limit has to be reached.
SETTLED, TIMES = 1e-4, 3
#: Name of the column of the links' load.
LINKS = "links"
#: Ratio of the spread of joints' delays to their errors above which they are not one delay.
NOT_ONE = 5.0


@dataclass(frozen=True)
class Gains:
    """Gains of a position controller at the joint, kp - N*m/rad (N/m) -, kd - N*m*s/rad (N*s/m) -, and its limit - N*m
    (N)."""

    kp: float
    kd: float = 0.0
    limit: float = math.inf

    def __post_init__(self) -> None:
        if not (0.0 < self.kp < math.inf and 0.0 <= self.kd < math.inf and self.limit > 0.0):
            found = f"found kp {self.kp:g}, kd {self.kd:g} and a limit of {self.limit:g}"
            raise InputError("gains", found, "allowed: kp and the limit above zero, kd zero or more")


@dataclass(frozen=True)
class Delay:
    """A dead time - s -, and its variance."""

    value: float
    variance: float


@dataclass(frozen=True, eq=False)
class Coefficients:
    """What a fit found of a joint.

    Attributes:
        kind: of the joint.
        gains: of the controller.
        theta: of TERMS: J, K_w + kd, K_0, less the dead time, -kp*b (5,).
        covariance: (5, 5).
        reach: of an interval of 95 % in standard errors.
        limit: of the controller's torque, where the log reaches one that is not stated.
    """

    kind: AxisKind
    gains: Gains
    theta: Array
    covariance: Array
    reach: float
    limit: Parameter | None = None

    @property
    def delay(self) -> Delay:
        """By how much the goal acts late."""
        k = TERMS.index(MISALIGNMENT)
        return Delay(-float(self.theta[k]), float(self.covariance[k, k]))

    @property
    def bias(self) -> float:
        """Position less goal without a torque - rad (m)."""
        return -float(self.theta[TERMS.index(OFFSET)]) / self.gains.kp

    @cached_property
    def errors(self) -> Array:
        """Standard errors (5,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    def at(self, delay: Delay) -> Coefficients:
        """The same with the delay that all joints share."""
        k = TERMS.index(MISALIGNMENT)
        along = self.covariance[:, k] / self.covariance[k, k]
        theta = self.theta + along * (-delay.value - self.theta[k])
        known = self.covariance[k, k] - delay.variance
        return replace(self, theta=theta, covariance=self.covariance - known * np.outer(along, along))

    def parameters(self, link_inertia: float) -> dict[str, Parameter]:
        """Parameters by their names; the armature is the inertia beyond the links'."""
        kind, kp = self.kind, self.gains.kp
        base = {term: self._parameter(term, kind.parameter_unit(term)) for term in (INERTIA, VISCOUS, COULOMB)}
        found = {kind.parameter(term): one for term, one in base.items()}
        found[kind.parameter(VISCOUS)] = _moved(base[VISCOUS], -self.gains.kd)
        found[ARMATURE] = _moved(base[INERTIA], -link_inertia)
        found["dead_time"] = self._parameter(MISALIGNMENT, "s", -1.0)
        found["joint_bias"] = self._parameter(OFFSET, kind.length_unit, -1.0 / kp)
        return found if self.limit is None else {**found, "force_limit": self.limit}

    def _parameter(self, term: str, unit: str, factor: float = 1.0) -> Parameter:
        k = TERMS.index(term)
        value, error = factor * float(self.theta[k]), abs(factor) * float(self.errors[k])
        return Parameter(value, unit, error, (value - self.reach * error, value + self.reach * error))


@dataclass(frozen=True, eq=False)
class JointBalance:
    """A joint's balance, fitted.

    Attributes:
        trace: goal, position and links along the log, on the joint's side.
        rows: of the log through the filter that was chosen.
        found: its coefficients.
    """

    trace: Trace
    rows: Rows
    found: Coefficients

    @property
    def noise(self) -> float:
        """White noise of the position - rad (m)."""
        return self.rows.conditioning.source_noise

    def goal(self, places: Array) -> Array:
        """The delayed goal - rad (m) - at places of samples (n,), as the interpolation of what is held."""
        late = self.found.delay.value / self.trace.sample_period + 0.5
        return np.interp(places - late, np.arange(len(self.trace)), self.trace["position_reference"])

    def request(self, trace: Trace) -> Array:
        """What the controller requests, in whatever limit - N*m (N) - (n,)."""
        position, speed = trace["position"], np.empty(len(trace))
        for part in trace.segments:
            speed[part] = slope(position[part], trace.sample_period) if part.stop - part.start > 1 else 0.0
        goal = replace(self, trace=trace).goal(np.arange(len(trace), dtype=np.float64))
        return self.found.gains.kp * (goal + self.found.bias - position) - self.found.gains.kd * speed

    def with_effort(self, trace: Trace) -> Trace:
        """A log of the joint with the torque of its controller, without its goal."""
        limit, kind = self.found.gains.limit, self.found.kind
        limited = np.clip(self.request(trace), -limit, limit)
        trace = trace.without("position_reference")
        return trace.with_signals({kind.effort: limited}, {kind.effort: kind.effort_unit})


def _moved(one: Parameter, by: float) -> Parameter:
    return one.at(one.value + by, positive=False)


def balance(trace: Trace, rig: Rig, gains: Gains) -> JointBalance:
    """The balance of a joint by a log with its goal, its position and the load of its links.

    Args:
        trace: as `bench.plant.robot.read_commanded` reads it, on the joint's side.
        rig: of the joint, without a gear.
        gains: of its controller.

    Raises:
        UndeterminedError: the joint never moves clearly, or the log does not determine its inertia.
    """
    first = Rows.of(_as_known(trace, gains), rig, width=LEAST_WIDTH * trace.sample_period)
    best = _best(trace, first, gains)
    if math.isinf(gains.limit):
        best = _limited(replace(best, rows=first)) or best
    gains = best.found.gains
    whole = replace(best, rows=first)  # a wide filter may keep only the slow parts, in which no limit is reached
    explained = _explained(whole if math.isinf(gains.limit) else replace(whole, rows=_within(whole, gains.limit)))
    if explained < EXPLAINS:
        reason = f"goal, position and gains explain {percent(max(explained, 0.0))} of the torque only: "
        reason += "the controller has other gains or is at a force limit"
        raise UndeterminedError("the joint's inertia", reason, "smaller and slower goals, which the joint follows")
    if not best.found.reach * best.found.errors[0] < DETERMINED * best.found.theta[0]:
        reason = "the goal and the position do not show how it accelerates"
        record = "goals of 0.1 to 2 Hz, 20 s or more"
        if (share := float(np.mean(np.abs(best.request(trace)) >= gains.limit))) > 0.0:
            limit = f"{gains.limit:.3g} {trace.axis_kind.effort_unit}"
            reason = f"the controller is at its force limit of {limit} for {percent(share)} of the log"
            record = "smaller and slower goals, which the joint follows"
        raise UndeterminedError("the joint's inertia", reason, record)
    return best


def _best(trace: Trace, first: Rows, gains: Gains) -> JointBalance:
    """The balance through the filter with the least errors; UndeterminedError if it is nearly always at its limit."""
    best, delay = None, None
    for rows in _filtered(first):
        if delay is None:
            delay = _begun(rows, gains, trace[KNOWN_INERTIA])
        one = _fitted(trace, rows, gains, delay)
        if math.isfinite(gains.limit):
            try:
                one = _fitted(trace, _within(one, gains.limit), gains, one.found.delay.value)
            except UndeterminedError:
                continue
        if best is None or _size(one) < _size(best):
            best = one
        if _size(one) > WORSE * _size(best):
            break
    if best is None:
        reason = f"the controller is nearly always at its limit of {gains.limit:.3g} {trace.axis_kind.effort_unit}"
        raise UndeterminedError("the joint's inertia", reason, "smaller and slower goals, which the joint follows")
    return best


def _as_known(trace: Trace, gains: Gains) -> Trace:
    """A log whose effort is that of the goal alone; that of the position is known, as the load of the links is."""
    goal, kind = trace["position_reference"], trace.axis_kind
    held = goal.copy()
    for part in trace.segments:
        held[part][1:-1] += np.diff(goal[part], 2) / 24.0
    trace = trace.with_signals({kind.effort: gains.kp * held}, {kind.effort: kind.effort_unit})
    known = trace[KNOWN_TORQUE] + gains.kp * trace["position"]
    return with_known(trace, known, trace[KNOWN_MOMENTUM], kind.effort_unit, trace[KNOWN_INERTIA])


def _filtered(first: Rows) -> Iterator[Rows]:
    """The log through each of the filters, as long as it moves clearly through them."""
    smooth, period = first.conditioning.filter, first.scope.sample_period
    for width in (smooth.width * times for times in WIDTHS):
        try:
            yield first.through(GaussianFilter.from_cutoff(GaussianFilter(width, period).cutoff, period))
        except UndeterminedError:
            return


def _size(one: JointBalance) -> float:
    """What filters are compared by: the errors of J, K_w and K_0 together."""
    return float(np.prod(one.found.errors[:3]))


def _begun(rows: Rows, gains: Gains, more: Array) -> float:
    """Dead time - s - from which the search starts: that of DELAYS with the least residual."""
    return min(DELAYS.tolist(), key=lambda delay: _step(rows, gains, more, delay)[1])


def _fitted(trace: Trace, rows: Rows, gains: Gains, delay: float) -> JointBalance:
    """The balance through a filter, its delay found from one nearby."""
    k, shortest, longest = TERMS.index(MISALIGNMENT), -trace.sample_period, 2.0 * float(DELAYS[-1])
    theta, _, covariance, reach = _step(rows, gains, trace[KNOWN_INERTIA], delay)
    for _ in range(STEPS):
        change = float(theta[k])
        if abs(change) < CONVERGED:
            break
        delay = min(max(delay - change, shortest), longest)
        theta, _, covariance, reach = _step(rows, gains, trace[KNOWN_INERTIA], delay)
    theta[k] -= delay
    return JointBalance(trace, rows, Coefficients(trace.axis_kind, gains, theta, covariance, reach))


def _equations(
    rows: Rows, gains: Gains, more: Array, delay: float, linked: bool = False
) -> tuple[NormalEquations, Array]:
    """Equations of TERMS around a delay - s -, and of the load of the links where asked; and what noise adds to their
    moment (k,)."""
    laid = lay_out(rows, Hypothesis(shift=-(delay + 0.5 * rows.scope.sample_period)))
    edges = block_edges(rows.time, rows.conditioning.filter.width)
    columns = [*laid.columns.T, np.ones(laid.effort.size)]
    if linked:
        columns.append(rows.kept(known_of)[:, 0] - gains.kp * rows.kept(_position)[:, 0])
    noise = np.pad(laid.noise, (0, len(columns) - len(laid.noise)))
    names = (*TERMS, LINKS)[: len(columns)]
    found, k = equations(names, np.vstack([*columns, laid.effort]), noise, edges), TERMS.index(INERTIA)
    acceleration, speed = (float(noise[at, at]) for at in (k, TERMS.index(VISCOUS)))
    of_noise = np.zeros_like(found.moment)  # noise of the effort times that of the columns, of each block
    of_noise[:, k] = gains.kp * speed * found.rows - acceleration * np.add.reduceat(more[rows.samples()], edges[:-1])
    return replace(found, moment=found.moment - of_noise), of_noise.sum(axis=0)


def _position(signals: Signals) -> list[Column]:
    """The measured position, as the one column of a table."""
    return [[(signals.position, 0)]]


def _step(rows: Rows, gains: Gains, more: Array, delay: float) -> tuple[Array, float, Array, float]:
    """Coefficients of TERMS around a delay - s -, squared residuals, covariance and reach of intervals of 95 %."""
    found, of_noise = _equations(rows, gains, more, delay)
    noise = found.count * found.noise
    theta, inverse = solved(found.total, found.moment.sum(axis=0), noise)
    covariance, reach = estimated(found.scores(theta), inverse, 0.0)
    by_level = inverse @ (noise @ theta - of_noise)
    uncertain = 2.0 * OF_MEDIAN / (TOP * rows.time.size * rows.conditioning.filter.stride)
    return theta, found.residual_power(theta), covariance + uncertain * np.outer(by_level, by_level), reach


def _explained(one: JointBalance) -> float:
    """Share of the squares of the controller's torque, less the links' and the noise, that the balance explains."""
    known, _ = _equations(one.rows, one.found.gains, one.trace[KNOWN_INERTIA], one.found.delay.value)
    theta = np.where(np.arange(len(TERMS)) == TERMS.index(MISALIGNMENT), 0.0, one.found.theta)
    noise = known.count * float(theta @ known.noise @ theta)
    return 1.0 - (known.residual_power(theta) - noise) / float(known.power.sum())


def wrong_scale(one: JointBalance) -> str:
    """By how much the weight of the links contradicts the gains, in a sentence; empty where it does not."""
    kp, delay = one.found.gains.kp, one.found.delay.value
    known, _ = _equations(one.rows, one.found.gains, one.trace[KNOWN_INERTIA], delay, linked=True)
    theta, inverse = solved(known.total, known.moment.sum(axis=0), known.count * known.noise)
    covariance, reach = estimated(known.scores(theta), inverse, 0.0)
    scale, half = 1.0 + float(theta[-1]), reach * math.sqrt(max(float(covariance[-1, -1]), 0.0))
    if abs(scale - 1.0) < max(2.0 * half, OFF):
        return ""
    return (
        f"with these gains the links weigh {scale:.3g} ± {half:.2g} times what the MJCF states: kp is "
        f"{kp / scale:.4g} instead of {kp:.4g}, or the links are heavier by that factor; "
        "all torques and inertias of the joint scale with it"
    )


def _within(one: JointBalance, limit: float) -> Rows:
    """The rows in whose reach the controller requests less than a limit."""
    return _where(one, np.abs(one.request(one.trace)) < limit)


def _where(one: JointBalance, met: NDArray[np.bool_]) -> Rows:
    """The rows in whose reach every sample meets a condition (n,); UndeterminedError where there are none."""
    trace, margin = one.trace, one.rows.conditioning.filter.margin
    beyond = np.convolve(~met, np.ones(2 * margin + 1), "same") > 0.5
    start = trace.time[0]

    def kept(time: Array) -> NDArray[np.bool_]:
        return ~beyond[np.clip(np.searchsorted(trace.time, start + time), 0, beyond.size - 1)]

    rows = one.rows.selected(kept)
    if not any(part.used.any() for part in rows.stretches):
        raise UndeterminedError("the balance", "the controller is at its limit", "goals that it follows")
    return rows


def _limited(one: JointBalance) -> JointBalance | None:
    """The balance with the limit that its controller reaches, by one of all rows; None where it reaches none."""
    gains, trace, first = one.found.gains, one.trace, one.rows
    largest = float(np.quantile(np.abs(one.request(trace)), 0.999))
    for share in BEGINNINGS:
        level = share * largest
        try:
            within = _fitted(trace, _within(one, level), gains, one.found.delay.value)
        except UndeterminedError:
            continue
        if _explained(within) >= EXPLAINS:
            break
    else:
        return None
    for _ in range(ROUNDS):
        settled = _settled(replace(within, rows=first), level)
        if settled is None:
            return None
        level = settled
        try:
            within = _best(trace, first, replace(gains, limit=level))
        except UndeterminedError:
            return None
    limit = _level(replace(within, rows=first), level)
    return limit and replace(within, found=replace(within.found, limit=limit, gains=replace(gains, limit=limit.value)))


def _settled(one: JointBalance, level: float) -> float | None:
    """Limit of the torque - N*m (N) -, from a level of it; None where nothing is above it.

    Where a controller requests more than a level, its mean torque is above the level if that is below the limit, and is
    the limit if not: repeated, the level settles at the limit, or rises until nothing is above it.
    """
    for _ in range(LEVELS):
        torques = [torque for _, torque, _ in _beyond(one, level)]
        if not torques:
            return None
        last, level = level, float(np.concatenate(torques).mean())
        if level <= 0.0:  # the balance is none
            return None
        if abs(level - last) < SETTLED * level:
            break
    return level


def _beyond(one: JointBalance, level: float) -> Iterator[tuple[Array, Array, Array]]:
    """Where the controller surely requests more than a level: times, torque in that direction by the balance - N*m
    (N) - (r,), and its slopes over J, K_w and K_0 (r, 3)."""
    request, found = one.request(one.trace), one.found
    theta = found.theta[:3] - np.array([0.0, found.gains.kd, 0.0])
    for side in (1.0, -1.0):
        try:
            rows = _where(one, side * request > SURELY * level)
        except UndeterminedError:
            continue
        columns = side * lay_out(rows, Hypothesis()).columns[:, :3]
        links = side * (rows.kept(known_of)[:, 0] - found.gains.kp * rows.kept(_position)[:, 0])
        yield rows.time, columns @ theta + links, columns


def _level(one: JointBalance, level: float) -> Parameter | None:
    """The mean torque where more than a level is requested; None where that is too seldom.

    Its variance is that of the times at which the limit is reached, and of the balance.
    """
    sums, slope, width = list[float](), np.zeros(3), one.rows.conditioning.filter.width
    parts = [*_beyond(one, level)]
    count = sum(time.size for time, _, _ in parts)
    if not count:
        return None
    value = sum(float(torque.sum()) for _, torque, _ in parts) / count
    for time, torque, columns in parts:
        edges = np.flatnonzero(np.diff(time, prepend=-np.inf) > 2.0 * width)
        sums += np.add.reduceat(torque - value, edges).tolist()
        slope += columns.sum(axis=0) / count
    if len(sums) < TIMES:
        return None
    variance = float(np.square(sums).sum()) / count**2 * len(sums) / (len(sums) - 1)
    variance += float(slope @ one.found.covariance[:3, :3] @ slope)
    error, reach = math.sqrt(variance), float(scipy.special.stdtrit(len(sums) - 1, 0.975))
    return Parameter(value, one.found.kind.effort_unit, error, (value - reach * error, value + reach * error))


def shared(found: Sequence[Delay]) -> Delay | None:
    """The dead time of joints of one robot by that of each; None where these differ by far more than their errors.

    The mean weighted by their variances; where they differ by more, its variance is as much larger (R. T. Birge,
    Physical Review 40, 1932, 207-227), and so that a normal interval is as wide as Student's of as many joints.
    """
    if not found:
        return None
    delays = np.array([one.value for one in found])
    weights = 1.0 / np.array([one.variance for one in found])
    value = float(weights @ delays / weights.sum())
    scale = 1.0
    if len(found) > 1:
        scale = max(1.0, float(weights @ (delays - value) ** 2) / (len(found) - 1))
    if scale > NOT_ONE**2:
        return None
    student = float(scipy.special.stdtrit(len(found) - 1, 0.975)) / NORMAL95 if scale > 1.0 else 1.0
    return Delay(value, scale * student**2 / float(weights.sum()))
