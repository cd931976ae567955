"""The default estimator: least squares of the torque balance without effects, of a recording or of several together.

A recording's first part that moves clearly decides on filter (`bench.fit.cutoffs`) and mains lines; all are summed up,
and one without clear motion contributes no rows.

Of several, what one does not determine another may:

    theta = (sum of B_k)**-1 * sum of B_k*theta_k,   B_k = (I + A_k*D)**-1 * A_k

theta - J, K_w, K_0 and offset, common to all recordings; theta_k - their estimate from recording k alone; A_k - its
information: the matrix of its normal equations, scaled to its covariance, with its own shift of torque against speed
and mains lines eliminated; D - variances between recordings beyond their own errors (`bench.comparison.spread`). With
D = 0 it is the least-squares fit to all recordings (D. Jackson, I. R. White, S. G. Thompson, Statistics in Medicine
29(12), 2010, 1282-1297). A_k may be singular: a run in one direction determines only the sum of K_0 and offset. Each
recording keeps its own filter, noise, sample period and source of speed. The interval covers the recordings' own errors
and D.
"""

from __future__ import annotations

import math
import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from bench.arrays import NORMAL95, Array, rms
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.comparison.spread import ALARM, Between, Excess, between, excess, spread_warning
from bench.effects.present import parse_value
from bench.errors import InputError, UndeterminedError
from bench.fit.cutoffs import TELLS, TERMS, Moves, for_inertia
from bench.fit.dead_time import DeadTime, command_delay, dead_time, with_delay, without_delay
from bench.fit.dependence import Dependence, dependence
from bench.fit.determined import remainder, require_inertia, sound
from bench.fit.estimate import Alone, Estimate, RefusedEstimateError, Residual, load_inertia
from bench.fit.fit import by_hint
from bench.fit.hum import mains
from bench.fit.hypothesis import BASE, Hypothesis, Name, lay_out, plain
from bench.fit.motor import motor_constants, require_often, with_inertia
from bench.fit.rows import Rows, effort_of
from bench.fit.solution import NOISE_ALONE, NormalEquations, Solution, equations_of, join, solution_of, solve, solved
from bench.fit.two_encoders import coupling
from bench.gate.check import Check
from bench.gate.gate import PARTS, Gated, gate, joined, passed, require
from bench.names import with_known_arguments
from bench.parameter import Parameter
from bench.rig.given import Given, GivenRig, Units, given
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from bench.trace.trace import join as join_traces

#: Normal equations of a part of a recording, None where it never moves clearly, number of its samples, its checks.
Summed = tuple[NormalEquations | None, int, tuple[Check, ...]]


@with_known_arguments
def identify(
    trace: Given | Iterator[Trace] | Sequence[Given | Iterator[Trace]],
    rig: GivenRig | None = None,
    cutoff: float | str | None = None,
    units: Units | None = None,
) -> Estimate:
    """Inertia, viscous and Coulomb friction (and offset, if the rig asks for it) of a recording, or of several.

    Each recording goes through the gate, is laid out in rows through one filter, and is summed up in normal equations
    at the cut-off at which the estimate stands still; these are solved, alone or together, with intervals that count
    correlated residuals, misfit, tolerances and what the recording hints at. What is not determined is refused.

    Args:
        trace: the recording, or its file, arrays by their names or a data frame; an iterator over its consecutive
            parts, for one that does not fit into memory; or a list (tuple) of several of one axis, which are fitted
            together.
        rig: what is known about the axis: a rig, its file, a shipped rig's name or its tables as a dictionary, where
            numbers without a unit are SI. Drafted from the recording where none is given.
        cutoff: half-power frequency of the filter instead of the one chosen from the data - Hz, or `"50 Hz"`.
        units: of columns by their names, which replace those of the file or data frame.

    Raises:
        RefusedEstimateError: the recordings leave one of them undetermined; the error carries the others.
        UndeterminedError: they determine none, or one of several recordings never moves clearly.
        InputError: no recording, one that is given twice, a signal is missing, efforts in different units, rig and
            trace do not fit together, or a check of a recording fails.
    """
    rig, recordings = given(trace, rig, units)
    cutoff = parse_value(cutoff, "Hz", "cutoff") if isinstance(cutoff, str) else cutoff
    if cutoff is not None and not 0.0 < cutoff < math.inf:
        raise InputError("cutoff", f"found {cutoff:g} Hz", "allowed: above 0 Hz")
    gathered = [_gather(one, rig, cutoff) for one in recordings]
    found = _estimated_alone(gathered[0], rig) if len(gathered) == 1 else _estimated_together(gathered, rig)
    first = join_traces([one.first for one in gathered])
    motor = motor_constants(first, rig, found, lambda trace, rig: _estimated_alone(_gather(trace, rig, None), rig))
    found = replace(found, motor=motor, command=command_delay(first, rig.axis_kind))
    found = _with_coupling(with_inertia(found, first, rig), first, rig)
    return replace(found, of=(rig, tuple(one for one in recordings if isinstance(one, Trace))))


def require_diagnosable(trace: Trace, rig: Rig) -> None:
    """UndeterminedError where a recording with voltage and current has too few samples to the motor's time constant."""
    if not {"voltage", "current"} <= set(trace.signals) or rig.axis_kind.effort in trace:
        return
    try:
        found = identify(trace, rig)
    except UndeterminedError:  # which a diagnosis judges with effects
        return
    require_often(trace, rig, found)


def _with_coupling(found: Estimate, first: Trace, rig: Rig) -> Estimate:
    """The estimate with the coupling of motor and load, where both positions are recorded, or why it has none."""
    if not {"position", "load_position"} <= set(first.signals):
        return found
    try:
        return replace(found, coupling=coupling(first, rig))
    except UndeterminedError as error:
        return replace(found, warnings=(*found.warnings, str(error)))


@dataclass(frozen=True, eq=False)
class Gathered:
    """A recording summed up.

    Attributes:
        solution: of all of it, with the rows of its first part, at whose filter the others are taken.
        effort_unit: N*m, N, or what the rig allows.
        samples_read: of all parts.
        measured: sum of the squares of the measured effort over all rows - its unit squared -, and its sum.
        doubt: possible bias of J, K_w and K_0, as they move with the filter's cut-off.
        depends: on what the residual depends where its RMS is that of noise; None if on nothing.
        hint: what the effect that the recording hints at would explain of the residual; empty without one.
        hinted: by how much that effect would move J, K_w and K_0.
        tolerance: half widths of coefficients from the rig's tolerances.
        warnings: about the cut-off.
        checks: of all parts.
        first: of its parts that moves clearly.
        late: by how much torque is later than motion, if that is more than a sample.
    """

    solution: Solution
    effort_unit: str
    samples_read: int
    measured: tuple[float, float]
    doubt: Mapping[str, float]
    depends: Dependence | None
    hint: str
    hinted: Mapping[str, float]
    tolerance: Mapping[Name, float]
    warnings: tuple[str, ...]
    checks: tuple[Check, ...]
    first: Trace
    late: DeadTime | None

    def solved(self, offset: bool) -> Solution:
        """Its solution with or without a constant."""
        found = self.solution
        if offset == (OFFSET in found.names):
            return found
        return solve(found.rows, found.hypothesis, found.laid, found.whole, offset)


def _gather(trace: Trace | Iterable[Trace], rig: Rig, cutoff: float | None) -> Gathered:
    """A recording, or its consecutive parts, summed up at a cut-off - Hz -, or at the one the data choose."""
    parts = iter([trace] if isinstance(trace, Trace) else trace)
    gated, found, (doubt, warnings), still = _first_moving(parts, rig, cutoff)
    first = gated.trace

    def summed(part: Trace) -> Summed:
        sound = gate(part, rig, PARTS)
        try:
            rows = Rows.of(sound.trace, rig, conditioning=found.rows.conditioning, begins=float(first.time[0]))
        except UndeterminedError:  # it never moves clearly, or is shorter than the filter: no row of it is determined
            return None, len(sound.trace), sound.checks
        return equations_of(rows, lay_out(rows, found.hypothesis)), len(sound.trace), sound.checks

    others = list(_in_parallel(summed, parts))
    checks = joined([*(part.checks for part in still), gated.checks, *(checked for _, _, checked in others)])
    require(checks, first)
    whole, (told, hinted) = found, by_hint(found.rows, found.hypothesis, OFFSET in found.names)
    if others:
        equations = join([found.whole, *(each for each, _, _ in others if each is not None)])
        offset = rig.offset and equations.one_way is None
        whole = solve(found.rows, found.hypothesis, found.laid, equations, offset)
    depends = None
    if rms(found.residual) <= NOISE_ALONE * found.floor.coloured:
        depends = dependence(found.rows, found.laid, found.theta, OFFSET in found.names)
    return Gathered(
        solution=whole,
        effort_unit=rig.net_effort(first)[1],
        samples_read=sum(len(part.trace) for part in (*still, gated)) + sum(read for _, read, _ in others),
        measured=_measured(whole.whole, None if others else found.rows),
        doubt=dict(zip(TERMS, doubt.tolist(), strict=True)),
        depends=depends,
        hint=told,
        hinted=hinted,
        tolerance=_by_tolerance(first, rig, found),
        warnings=warnings,
        checks=checks,
        first=first,
        late=_late(found),
    )


def _late(found: Solution) -> DeadTime | None:
    """By how much the torque of a solution is later than its motion, if that is more than a sample."""
    bare, shift = without_delay(found.hypothesis)
    return dead_time(found.rows, bare, shift + found.shift[0]) if shift or found.delayed else None


def _first_moving(parts: Iterator[Trace], rig: Rig, cutoff: float | None) -> tuple[Gated, Solution, Moves, list[Gated]]:
    """The first part that moves clearly, its solution, and the parts before it; UndeterminedError where none does."""
    still, refusals = [], []
    for part in parts:
        try:
            gated = passed(part, rig)
            return gated, *choose(gated.trace, rig, cutoff), still
        except UndeterminedError as refusal:
            still.append(gate(part, rig, PARTS))
            refusals.append(refusal)
    if not refusals:
        raise InputError("parts of a recording", "found none", "allowed: an iterator over one Trace or more")
    raise refusals[0]


def _in_parallel(work: Callable[[Trace], Summed], parts: Iterable[Trace]) -> Iterator[Summed]:
    """Results of `work` on each part, in order, on one thread a core; NumPy releases the interpreter lock.

    At most two parts a core are in memory, so a recording may be larger than it.
    """
    cores, waiting = os.cpu_count() or 1, deque[Future[Summed]]()
    with ThreadPoolExecutor(cores) as pool:
        for part in parts:
            waiting.append(pool.submit(work, part))
            if len(waiting) >= 2 * cores:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()


def _measured(equations: NormalEquations, rows: Rows | None) -> tuple[float, float]:
    """Sum of the squares of the measured effort, and its sum; `rows`: all that there are, if they are in memory.

    Within a robot that is what its motor gave, not the small part that its own inertia and friction are to explain.
    """
    if rows is not None and rows.stretches[0].signals.known:
        effort = rows.kept(effort_of)[:, 0]
        return float(effort @ effort), float(effort.sum())
    return float(equations.power.sum()), float(equations.moment[:, equations.names.index(OFFSET)].sum())


def _by_tolerance(first: Trace, rig: Rig, found: Solution) -> dict[Name, float]:
    """Half widths at 95 % of coefficients by their names from the rig's tolerances, taken for independent."""
    moved = np.zeros(found.theta.size)
    for other in rig.within_tolerance():
        rows = Rows.of(first, other, conditioning=found.rows.conditioning)
        moved = np.hypot(moved, solution_of(rows, found.hypothesis, OFFSET in found.names).theta - found.theta)
    return dict(zip(found.names, moved.tolist(), strict=True))


def choose(first: Trace, rig: Rig, cutoff: float | None) -> tuple[Solution, Moves]:
    """The solution of a recording, or of its first part, at the chosen cut-off, or at one - Hz; raises as `Rows.of`."""
    rows = Rows.of(first, rig, cutoff=cutoff)
    highest = solution_of(rows, plain(rows), rig.offset)
    hum = mains(rows, highest.residual)
    if hum:
        highest = solution_of(rows, replace(highest.hypothesis, hum=hum), rig.offset)
    delayed: tuple[Hypothesis, ...] = ()
    if highest.delayed:
        delayed = with_delay(highest.hypothesis, dead_time(rows, highest.hypothesis, highest.shift[0]))
    if delayed:
        highest = solution_of(rows, delayed[0], rig.offset)
    if cutoff is None:
        found, (doubt, warnings) = for_inertia(highest, rig)
    else:
        used, rate = rows.conditioning.filter.cutoff, 1.0 / rows.scope.sample_period
        lower = (
            f"the filter's cut-off is {used:.4g} Hz instead of {cutoff:.4g} Hz: {rate:.4g} Hz of sampling allow no more"
        )
        found, doubt, warnings = highest, np.zeros(3), (lower,) * (used < cutoff * (1.0 - 1e-9))
    for other in delayed[1:]:  # what a lag may be moves all others
        moved = solution_of(found.rows, other, OFFSET in found.names).theta - found.theta
        doubt = np.hypot(doubt, moved[: len(TERMS)])
    return found, (doubt, warnings)


def _estimated_alone(gathered: Gathered, rig: Rig) -> Estimate:
    """Estimate from the solution of a recording."""
    found, kind, unit, parameters = gathered.solution, rig.axis_kind, gathered.effort_unit, {}
    require_inertia(found.whole, kind)
    terms = (INERTIA, VISCOUS, COULOMB, MISALIGNMENT, *([OFFSET] if OFFSET in found.names else []))
    for term in terms:
        margins = gathered.doubt.get(term, 0.0), gathered.tolerance.get(term, 0.0)
        parameter = _parameter_of(found, term, kind, unit)
        if term == MISALIGNMENT:
            parameter = parameter.at(parameter.value + without_delay(found.hypothesis)[1], positive=False)
        parameter = parameter.widened(found.of(term, found.misfit), *margins)
        depends = gathered.depends
        for moved in (gathered.hinted, {} if depends is None else depends.moved):
            parameter = parameter.reaching(parameter.value + moved.get(term, 0.0))
        parameters[kind.parameter(term)] = parameter
    at = [found.names.index(term) for term in terms]
    estimate = _estimate_of([gathered], [found], parameters, found.covariance[np.ix_(at, at)], found.power, rig)
    remaining = remainder(estimate, kind, gathered.hint, gathered.depends)
    told = [f"{'; '.join(remaining)}; {TELLS}"] if remaining else []
    late = [] if gathered.late is None else [str(gathered.late)]
    estimate = replace(estimate, warnings=(*gathered.warnings, *late, *told))
    return sound(estimate, found.whole, rig, (*gathered.warnings, *remaining))


def _parameter_of(found: Solution, term: str, kind: AxisKind, effort_unit: str) -> Parameter:
    """A coefficient of a solution with the interval that its covariance gives it."""
    unit, error = kind.parameter_unit(term, effort_unit), found.of(term, found.errors)
    return Parameter.around(found.of(term, found.theta), unit, error, found.reach * error)


def _estimate_of(
    gathered: Sequence[Gathered],
    solutions: Sequence[Solution],
    parameters: Mapping[str, Parameter],
    covariance: Array,
    left: float,
    rig: Rig,
) -> Estimate:
    """The estimate of recordings, with what explains them.

    `covariance`: of the parameters by the fit alone (p, p); `left`: squared residuals - the effort's unit squared.
    """
    kind, counts = rig.axis_kind, np.array([one.solution.whole.count for one in gathered])
    squares, total = (sum(one.measured[k] for one in gathered) for k in (0, 1))
    if squares == 0.0:
        reason = "the effort is zero throughout"
        raise UndeterminedError(kind.in_words(INERTIA), reason, "the motor's current or torque too")
    count = int(counts.sum())
    floor = math.sqrt(float(counts @ np.square([found.floor.coloured for found in solutions])) / count)
    filters = [one.solution.rows.conditioning.filter for one in gathered]
    size, relative, unit = math.sqrt(left / count), math.sqrt(left / squares), gathered[0].effort_unit
    on = next((one.depends.on for one in gathered if one.depends is not None), None)
    return Estimate(
        estimator="regression",
        parameters={**parameters, **load_inertia(parameters, rig)},
        correlations=_correlations([*parameters], covariance),
        residual=Residual(size, floor, relative, unit, on),
        samples_read=sum(one.samples_read for one in gathered),
        samples_used=int(counts @ [smooth.stride for smooth in filters]),
        cutoff=min(smooth.cutoff for smooth in filters),
        source=" and ".join(sorted({one.solution.rows.conditioning.source for one in gathered})),
        explained=max(1.0 - left / max(squares - total**2 / count, 1e-300), 0.0),
        checks=joined([one.checks for one in gathered]),
        dead_time=next((one.late for one in gathered if one.late is not None), None),
    )


def _correlations(names: Sequence[str], covariance: Array) -> dict[str, dict[str, float]]:
    """Of estimates by name and name, from their covariance (p, p)."""
    error = np.sqrt(np.diag(covariance))
    table = covariance / np.maximum(np.outer(error, error), 1e-300)
    return {name: dict(zip(names, row, strict=True)) for name, row in zip(names, table.tolist(), strict=True)}


def _estimated_together(gathered: Sequence[Gathered], rig: Rig) -> Estimate:
    """Estimate from several recordings of one axis."""
    _require_distinct(gathered)
    kind, unit = rig.axis_kind, gathered[0].effort_unit
    members = [_member(one, rig) for one in gathered]
    excesses = {term: _excess(members, kind, term) for term in members[0].terms}
    theta, covariance, reaches = _jointly(members, list(excesses.values()))
    errors = np.sqrt(np.diag(covariance))
    parameters = {}
    for term, value, error, reach in zip(excesses, theta.tolist(), errors.tolist(), reaches.tolist(), strict=True):
        found = Parameter.around(value, kind.parameter_unit(term, unit), error, reach)
        parameters[kind.parameter(term)] = found.widened(float(np.mean([_tolerance(one, term) for one in gathered])))
    away = [theta - each.theta for each in members]
    left = sum(each.solution.power + float(d @ each.matrix @ d) for each, d in zip(members, away, strict=True))
    estimate = replace(
        _estimate_of(gathered, [each.solution for each in members], parameters, covariance, left, rig),
        warnings=(
            *(f"{each.alone.origin}: {warning}" for each in members for warning in each.warnings),
            *(f"{each.alone.origin} by itself: {each.alone.reason}" for each in members if each.alone.reason),
            *_differences(members, excesses, kind),
            *_offset(members, rig),
        ),
        recordings=tuple(each.alone for each in members),
        between=_between(members, kind),
    )
    spread, suspicions = excesses[INERTIA].variance, ()
    if spread:
        apart = f"{math.sqrt(spread):.2g} {estimate[kind.inertia].unit}"
        suspicions = (f"it differs from recording to recording by {apart}, and few are given",)
    return sound(estimate, _joined(gathered), rig, suspicions)


@dataclass(frozen=True, eq=False)
class Member:
    """One of several recordings: its information about the axis, and its estimate alone.

    Attributes:
        gathered: it summed up.
        terms: that all recordings share: J, K_w, K_0 and, where it is fitted, offset (s,).
        solution: its own fit, with these columns and its own shift and mains interference.
        theta: coefficients of these in it (s,).
        matrix: of the normal equations of these, its own shift and mains interference eliminated (s, s).
        covariances: of these, in standard errors and in half widths of intervals of 95 % (s, s) each.
        alone: its estimate alone.
        own: the same without the rig's tolerances, which are common to all recordings.
        along: if it moves in one direction only, its friction in that direction, offset included; else None.
        warnings: of its own fit.
    """

    gathered: Gathered
    terms: tuple[str, ...]
    solution: Solution
    theta: Array
    matrix: Array
    covariances: tuple[Array, Array]
    alone: Alone
    own: Mapping[str, Parameter]
    along: Parameter | None
    warnings: tuple[str, ...]


def _member(gathered: Gathered, rig: Rig) -> Member:
    """One recording fitted alone.

    A parameter that it does not determine alone is as much wider than by its own fit as friction along one direction.
    """
    kind, terms = rig.axis_kind, (INERTIA, VISCOUS, COULOMB, *([OFFSET] if rig.offset else []))
    solution, one_way = gathered.solved(rig.offset), gathered.solution.whole.one_way is not None
    bare = gathered.solved(offset=False) if one_way else solution
    found, reason = None, ""
    try:
        found = _estimated_alone(replace(gathered, solution=bare), rig)
    except RefusedEstimateError as refusal:
        found, reason = refusal.estimate, str(refusal)
    except UndeterminedError as refusal:
        reason = str(refusal)
    known, warnings = ({}, ()) if found is None else (found.parameters, found.warnings)
    kept = {name: one for name, one in known.items() if name != kind.inertia or one.ci95[0] * one.ci95[1] > 0.0}
    own, along, wider = dict(kept), None, (1.0, solution.reach)
    names = {kind.parameter(term): term for term in terms} | {"load_moment_of_inertia": INERTIA}
    for name in own.keys() & names.keys():
        own[name] = _without(own[name], _tolerance(gathered, names[name]))
    if one_way:
        along = _parameter_of(bare, COULOMB, kind, gathered.effort_unit)
        along = along.widened(bare.of(COULOMB, bare.misfit), gathered.doubt[COULOMB])
        error = max(bare.of(COULOMB, bare.errors), 1e-300)
        wider = along.std_error / error, along.half_width / error
    at = [solution.names.index(term) for term in terms]
    covariance, scales = solution.covariance[np.ix_(at, at)], []
    for term, variance in zip(terms, np.diag(covariance).tolist(), strict=True):
        one, error = own.get(kind.parameter(term)), math.sqrt(max(variance, 1e-300))
        scales.append(wider if one is None else (one.std_error / error, one.half_width / error))
    standard, half = (covariance * np.outer(scale, scale) for scale in np.array(scales).T)
    theta, matrix, alone = solution.theta[at], _eliminated(solution, at), Alone(solution.rows.origin, kept, reason)
    return Member(gathered, terms, solution, theta, matrix, (standard, half), alone, own, along, warnings)


def _eliminated(solution: Solution, kept: list[int]) -> Array:
    """Matrix of normal equations of some columns, all other columns eliminated, positive semidefinite (s, s).

    A column with less power than expected from its noise carries no information.
    """
    equations, held = solution.equations, solution.held
    whole, gram, noise = equations.matrix, equations.total, equations.count * equations.noise
    rest = {k: name for k, name in enumerate(equations.names) if k not in kept}
    own = [k for k, name in rest.items() if not (held and name == MISALIGNMENT)]
    beside = whole[np.ix_(own, kept)]
    taken, _ = solved(gram[np.ix_(own, own)], beside, noise[np.ix_(own, own)])
    scale = np.sqrt(np.diag(gram)[kept])
    power, ways = np.linalg.eigh((whole[np.ix_(kept, kept)] - beside.T @ taken) / np.outer(scale, scale))
    return (ways * np.maximum(power, 0.0)) @ ways.T * np.outer(scale, scale)


def _tolerance(gathered: Gathered, term: str) -> float:
    """Half width of a coefficient from the rig's tolerances; of an offset that was not fitted it is in the friction."""
    return gathered.tolerance.get(term, gathered.tolerance[COULOMB])


def _without(found: Parameter, reach: float) -> Parameter:
    """A parameter less an independent error of such a half width at 95 %."""
    half = math.sqrt(max(found.half_width**2 - reach**2, 0.0))
    error = math.sqrt(max(found.std_error**2 - (reach / NORMAL95) ** 2, 0.0))
    return Parameter.around(found.value, found.unit, error, half)


def _jointly(members: Sequence[Member], excesses: Sequence[Excess]) -> tuple[Array, Array, Array]:
    """Coefficients of recordings that vary beyond their own errors (s,), their covariance (s, s), half widths (s,)."""
    between = np.array([found.variance for found in excesses])
    # the information of each: its matrix over the mean variance that its covariance implies
    implied = [float(np.trace(each.matrix @ each.covariances[0])) / between.size for each in members]
    known = np.array([each.matrix / max(mean, 1e-300) for each, mean in zip(members, implied, strict=True)])
    known = np.linalg.solve(np.eye(between.size) + known * between, known)
    moment = np.einsum("kij,kj->i", known, np.array([each.theta for each in members]))
    theta, inverse = solved(known.sum(axis=0), moment, np.zeros_like(known[0]))
    wide = between * np.array([found.reach for found in excesses]) ** 2
    covariance, reached = np.zeros((theta.size, theta.size)), np.zeros(theta.size)
    for share, each in zip(inverse @ known, members, strict=True):
        error, half_width = (share @ found @ share.T for found in each.covariances)
        covariance += error + (share * between) @ share.T
        reached += np.diag(half_width) + share**2 @ wide
    return theta, covariance, np.sqrt(reached)


def _require_distinct(gathered: Sequence[Gathered]) -> None:
    if not gathered:
        raise InputError("recordings", "found none", "allowed: at least one")
    for one, other in combinations(gathered, 2):
        if one.effort_unit != other.effort_unit:
            found = f"gives its effort in {other.effort_unit}, {one.solution.rows.origin} in {one.effort_unit}"
            raise InputError(
                other.solution.rows.origin, found, "allowed: recordings of one kind of effort; set kT in the rig"
            )
        if np.array_equal(one.solution.whole.gram, other.solution.whole.gram):
            found = f"found the same recording as {one.solution.rows.origin}"
            raise InputError(
                other.solution.rows.origin, found, "allowed: each recording once; twice would count as two"
            )


def _joined(gathered: Sequence[Gathered]) -> NormalEquations:
    """Equations of all recordings in their common columns: J, K_w, K_0, misalignment, constant."""
    parts = [one.solution.whole.only(lambda name: name in (*BASE, OFFSET)) for one in gathered]
    noise = sum((part.count * part.noise for part in parts), np.zeros_like(parts[0].noise))
    return replace(join(parts), noise=noise / sum(part.count for part in parts))


def _excess(members: Sequence[Member], kind: AxisKind, term: str) -> Excess:
    """Variance between recordings in a quantity.

    Runs of one direction determine the sum of friction and offset; it is compared among runs of the same direction.
    """
    name = kind.parameter(term)
    groups: dict[str, list[Parameter]] = {}
    for member in members:
        if name in member.own:
            groups.setdefault("both", []).append(member.own[name])
        elif term == COULOMB and member.along is not None:
            groups.setdefault(str(member.gathered.solution.whole.one_way), []).append(member.along)
    return excess(list(groups.values()))


def _differences(members: Sequence[Member], excesses: Mapping[str, Excess], kind: AxisKind) -> Iterator[str]:
    """Warnings of quantities in which the recordings differ, and of those that cannot be compared."""
    differing = [term for term, found in excesses.items() if found.chance < ALARM / len(excesses)]
    for term in differing:
        name = kind.parameter(term)
        values = [m.alone.parameters[name] for m in members if name in m.alone.parameters]
        yield spread_warning(name, values or [member.along for member in members if member.along is not None])
    silent = [kind.parameter(term) for term, found in excesses.items() if not found.degrees and term != OFFSET]
    if differing and silent:
        yield (
            f"no two recordings determine {' or '.join(silent)} alike, so the interval does not count how recordings "
            "differ in it: record each direction twice"
        )


def _offset(members: Sequence[Member], rig: Rig) -> Iterator[str]:
    """A warning of an offset that is not fitted, which runs of one direction each attribute to friction."""
    if rig.offset or all(member.along is None for member in members):
        return
    kind, asked = rig.axis_kind, rig.model_copy(update={"offset": True})
    members = [_member(each.gathered, asked) for each in members]
    theta, _, reaches = _jointly(members, [_excess(members, kind, term) for term in members[0].terms])
    value, reach = float(theta[-1]), float(reaches[-1])
    if abs(value) > reach:
        unit = kind.parameter_unit(OFFSET, members[0].gathered.effort_unit)
        yield (
            f"the recordings hold a {kind.in_words(OFFSET)} of {value:.3g} ± {reach:.2g} {unit}, which was not fitted: "
            "set `offset = true` in the rig, or give --offset"
        )


def _between(members: Sequence[Member], kind: AxisKind) -> dict[str, Between]:
    """Spread of each quantity that at least two recordings determine alone; the shift is no property of the axis."""
    own = [member.own for member in members]
    found = {
        name: [each[name] for each in own if name in each] for name in dict.fromkeys(n for each in own for n in each)
    }
    found.pop(kind.parameter(MISALIGNMENT), None)
    return {name: between(values) for name, values in found.items() if len(values) > 1}
