"""The default estimator: least squares of the torque balance without effects, of a recording or of several together.

Of several, what one does not determine another may:

    theta = (sum of B_k)**-1 * sum of B_k*theta_k,   B_k = (I + A_k*D)**-1 * A_k

theta - J, K_w, K_0 and offset, common to all recordings; theta_k - their estimate from recording k alone; A_k - its
information: the matrix of its normal equations, scaled to its covariance, with its own shift of torque against speed
and its own hum eliminated; D - variances between recordings beyond their own errors (`bench.comparison.spread`). With
D = 0 it is the least-squares fit to all recordings (D. Jackson, I. R. White, S. G. Thompson, Statistics in Medicine
29(12), 2010, 1282-1297). A_k may be singular: a run in one direction determines only the sum of K_0 and offset. Each
recording keeps its own filter, noise, sample period and source of speed. The interval covers the recordings' own errors
and D.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import cast

import numpy as np

from bench.arrays import NORMAL95, Array
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.comparison.spread import ALARM, Between, Excess, between, excess, spread_warning
from bench.errors import InputError, UndeterminedError
from bench.fit.determined import left_open, negative_friction, require_determined, require_inertia, require_sound
from bench.fit.estimate import Alone, Estimate, RefusedEstimateError, Residual, load_inertia
from bench.fit.gathered import Gathered, gather
from bench.fit.layout import BASE
from bench.fit.normal_equations import NormalEquations, join, solved
from bench.fit.solution import NOISE_ALONE, SURE, Solution
from bench.gate.gate import joined
from bench.parameter import Parameter
from bench.rig.given import Given, rig_of, trace_of
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Share of what stands above the noise that a delay has to explain to be reported: what a model lacks may look like one
#: (-12.4 ms on a double pendulum whose signals are in step, which explains 17 %).
A_DELAY = 0.25


def estimated_alone(gathered: Gathered, rig: Rig) -> Estimate:
    """Estimate from the normal equations of a recording.

    Raises:
        RefusedEstimateError: they determine only some parameters.
        UndeterminedError: they determine none.
    """
    kind = rig.axis_kind
    require_inertia(gathered.equations, kind)
    estimate = _estimate(gathered, rig, gathered.solved(rig.offset and gathered.one_way is None))
    return sound(estimate, gathered.equations, rig, (*gathered.warnings, *_remaining(estimate)))


def sound(estimate: Estimate, equations: NormalEquations, rig: Rig, suspicions: tuple[str, ...]) -> Estimate:
    """The estimate, if its equations, of every column and a constant, determine it and it means something.

    Raises:
        RefusedEstimateError: else, with what is determined, and with what else is suspicious.
    """
    kind = rig.axis_kind
    negative = negative_friction(estimate.parameters, kind, suspicions)
    try:
        require_determined(equations, kind)
        require_sound(estimate, rig, suspicions)
        for refusal in negative.values():
            raise refusal
    except UndeterminedError as refusal:
        unknown = {kind.parameter(term) for term in left_open(equations, kind)} | negative.keys()
        determined = {name: value for name, value in estimate.parameters.items() if name not in unknown}
        raise RefusedEstimateError(refusal, replace(estimate, parameters=determined)) from refusal
    return estimate


def _estimate(gathered: Gathered, rig: Rig, found: Solution) -> Estimate:
    equations, unit, kind = gathered.equations, gathered.effort_unit, rig.axis_kind
    parameters = {}
    for term in (INERTIA, VISCOUS, COULOMB, MISALIGNMENT, *([OFFSET] if OFFSET in found.names else [])):
        margins = gathered.doubt.get(term, 0.0), gathered.tolerance.get(term, 0.0)
        parameter = parameter_of(found, term, kind, unit).widened(found.of(term, found.misfit), *margins)
        parameters[kind.parameter(term)] = parameter.reaching(parameter.value + gathered.hinted.get(term, 0.0))
    parameters |= load_inertia(parameters, rig)
    squares, total = gathered.measured
    if squares == 0.0:
        reason = "the effort is zero throughout"
        raise UndeterminedError(kind.in_words(INERTIA), reason, "the motor's current or torque too")
    rms, relative = math.sqrt(found.power / equations.count), math.sqrt(found.power / squares)
    smooth = gathered.rows.conditioning.filter
    estimate = Estimate(
        estimator="regression",
        parameters=parameters,
        residual=Residual(rms, found.floor.coloured, relative, unit),
        samples_read=gathered.samples_read,
        samples_used=equations.count * smooth.stride,
        cutoff=smooth.cutoff,
        source=gathered.rows.conditioning.source,
        warnings=(*gathered.warnings, *_shifted(found)),
        explained=1.0 - found.power / max(squares - total**2 / equations.count, 1e-300),
        checks=gathered.checks,
    )
    return replace(estimate, warnings=(*estimate.warnings, *_remaining(estimate)))


def parameter_of(found: Solution, term: str, kind: AxisKind, effort_unit: str) -> Parameter:
    """A coefficient of a solution with the interval that its covariance gives it."""
    value, error = found.of(term, found.theta), found.of(term, found.errors)
    interval = (value - found.reach * error, value + found.reach * error)
    return Parameter(value, kind.parameter_unit(term, effort_unit), error, interval)


def _remaining(estimate: Estimate) -> Iterator[str]:
    """What share is explained, where more than noise is left."""
    residual = estimate.residual
    if residual.rms > NOISE_ALONE * residual.noise_floor:
        yield (
            f"the model explains {estimate.explained:.2%} of the effort's variance and leaves "
            f"{residual.rms / residual.noise_floor:.3g} times what noise alone would: bench diagnose may tell why"
        )


def _shifted(found: Solution) -> Iterator[str]:
    (shift, error), period = found.shift, found.rows.scope.sample_period
    if abs(shift) > period and abs(shift) > SURE * error and found.shift_explains > A_DELAY:
        yield (
            f"current and speed are {shift * 1e3:.3g} ms apart, more than a sample ({period * 1e3:.3g} ms): "
            "a lag in the drive or its filters, which bench diagnose can tell"
        )


def estimated_together(gathered: Sequence[Gathered], rig: Rig) -> Estimate:
    """Estimate from the normal equations of several recordings of one axis.

    Raises:
        RefusedEstimateError: together they leave a parameter undetermined; the error carries the others.
        InputError: no recording, one that is given twice, or efforts in different units.
    """
    _require_distinct(gathered)
    kind, unit, whole = rig.axis_kind, gathered[0].effort_unit, _joined(gathered)
    members = [Member.of(one, rig) for one in gathered]
    terms = members[0].terms
    excesses = {term: _excess(members, kind, term) for term in terms}
    joint = Joint.of(members, list(excesses.values()))
    parameters = {}
    for term, *numbers in zip(terms, joint.theta, joint.errors, joint.reaches, strict=True):
        value, error, reach = map(float, numbers)
        tolerance = float(np.mean([member.tolerances[kind.parameter(term)] for member in members]))
        interval = (value - reach, value + reach)
        found = Parameter(value, kind.parameter_unit(term, unit), error, interval)
        parameters[kind.parameter(term)] = found.widened(tolerance)
    filters = [one.rows.conditioning.filter for one in gathered]
    left = joint.left(members)
    squares, total = (sum(one.measured[k] for one in gathered) for k in (0, 1))
    variation = squares - total**2 / whole.count
    estimate = Estimate(
        estimator="regression",
        parameters=parameters | load_inertia(parameters, rig),
        residual=_residual(members, left, unit),
        samples_read=sum(one.samples_read for one in gathered),
        samples_used=sum(one.equations.count * f.stride for one, f in zip(gathered, filters, strict=True)),
        cutoff=min(smooth.cutoff for smooth in filters),
        source=" and ".join(sorted({one.rows.conditioning.source for one in gathered})),
        warnings=(
            *(f"{member.alone.origin}: {warning}" for member in members for warning in member.warnings),
            *(f"{member.alone.origin} alone: {member.alone.reason}" for member in members if member.alone.reason),
            *_differences(members, excesses, kind),
            *_offset(gathered, members, rig),
        ),
        explained=1.0 - left / max(variation, 1e-300),
        checks=joined([one.checks for one in gathered]),
        recordings=tuple(member.alone for member in members),
        between=_between(members, kind),
    )
    spread, suspicions = excesses[INERTIA].variance, ()
    if spread:
        apart = f"{math.sqrt(spread):.2g} {estimate[kind.inertia].unit}"
        suspicions = (f"it differs from recording to recording by {apart}, and few are given",)
    return sound(estimate, whole, rig, suspicions)


@dataclass(frozen=True, eq=False)
class Member:
    """One of several recordings: its information about the axis, and its estimate alone.

    Attributes:
        gathered: its normal equations.
        terms: that all recordings share: J, K_w, K_0 and, where it is fitted, offset (s,).
        names: of these in results.
        solution: its own fit, with these columns and its own shift and hum.
        alone: its estimate alone.
        along: if it moves in one direction only, its friction in that direction, offset included; else None.
        tolerances: half widths of parameters from the rig's tolerances, by name.
        warnings: of its own fit.
    """

    gathered: Gathered
    terms: tuple[str, ...]
    names: tuple[str, ...]
    solution: Solution
    alone: Alone
    along: Parameter | None
    tolerances: Mapping[str, float]
    warnings: tuple[str, ...]

    @classmethod
    def of(cls, gathered: Gathered, rig: Rig) -> Member:
        """The fit of one recording alone.

        Raises:
            InputError: rig and recording do not fit together.
        """
        kind, origin = rig.axis_kind, gathered.rows.origin
        terms = (INERTIA, VISCOUS, COULOMB, *([OFFSET] if rig.offset else []))
        names = tuple(kind.parameter(term) for term in terms)
        # no offset was fitted to a recording in one direction: it is in the friction
        tolerances = {term: gathered.tolerance.get(term, gathered.tolerance[COULOMB]) for term in terms}
        reaches = {kind.parameter(term): reach for term, reach in tolerances.items()}
        reaches |= {"load_moment_of_inertia": tolerances[INERTIA]}
        found, reason = None, ""
        try:
            found = estimated_alone(gathered, rig)
        except RefusedEstimateError as refusal:
            found, reason = refusal.estimate, str(refusal)
        except UndeterminedError as refusal:
            reason = str(refusal)
        known = {} if found is None else found.parameters
        kept = {name: one for name, one in known.items() if name != kind.inertia or one.ci95[0] * one.ci95[1] > 0.0}
        return cls(
            gathered,
            terms,
            names,
            gathered.solved(rig.offset),
            Alone(origin, kept, reason),
            _along(gathered, kind),
            reaches,
            () if found is None else found.warnings,
        )

    @property
    def _shared(self) -> list[int]:
        return [self.solution.names.index(term) for term in self.terms]

    @property
    def equations(self) -> NormalEquations:
        """Of the fitted columns."""
        return self.solution.equations

    @property
    def theta(self) -> Array:
        """Coefficients of the shared terms in its own fit (s,)."""
        return self.solution.theta[self._shared]

    @cached_property
    def matrix(self) -> Array:
        """Matrix of the normal equations of these, its own shift and hum eliminated, positive semidefinite (s, s).

        A column with less power than expected from its noise carries no information.
        """
        equations, shared, held = self.equations, self._shared, self.solution.held
        whole, gram, noise = equations.matrix, equations.total, equations.count * equations.noise
        rest = {k: name for k, name in enumerate(equations.names) if k not in shared}
        own = [k for k, name in rest.items() if not (held and name == MISALIGNMENT)]
        beside = whole[np.ix_(own, shared)]
        taken, _ = solved(gram[np.ix_(own, own)], beside, noise[np.ix_(own, own)])
        scale = np.sqrt(np.diag(gram)[shared])
        power, ways = np.linalg.eigh((whole[np.ix_(shared, shared)] - beside.T @ taken) / np.outer(scale, scale))
        return (ways * np.maximum(power, 0.0)) @ ways.T * np.outer(scale, scale)

    @cached_property
    def own(self) -> dict[str, Parameter]:
        """Its estimate alone, without the rig's tolerances, which are common to all recordings."""
        found = dict(self.alone.parameters)
        for name, reach in self.tolerances.items():
            if name in found:
                before = found[name]
                half = math.sqrt(max(before.half_width**2 - reach**2, 0.0))
                error = math.sqrt(max(before.std_error**2 - (reach / NORMAL95) ** 2, 0.0))
                found[name] = replace(before, std_error=error, ci95=(before.value - half, before.value + half))
        return found

    @cached_property
    def known(self) -> Array:
        """Its information about these: `matrix` over the mean variance implied by its covariance (s, s)."""
        covariance, _ = self.covariance
        return self.matrix * len(self.terms) / max(float(np.trace(self.matrix @ covariance)), 1e-300)

    @cached_property
    def covariance(self) -> tuple[Array, Array]:
        """Covariance of `theta` in standard errors, and in half widths of intervals of 95 % (s, s) each.

        A parameter that it does not determine alone is as much wider than by its own fit as friction along one
        direction is.
        """
        found = self.solution.covariance[np.ix_(self._shared, self._shared)]
        errors = np.sqrt(np.maximum(np.diag(found), 1e-300)).tolist()
        wider = 1.0, self.solution.reach
        if self.along is not None:
            bare = self.gathered.solved(offset=False)
            error = max(bare.of(COULOMB, bare.errors), 1e-300)
            wider = self.along.std_error / error, self.along.half_width / error
        scales = np.array(
            [
                (self.own[name].std_error / error, self.own[name].half_width / error) if name in self.own else wider
                for name, error in zip(self.names, errors, strict=True)
            ]
        )
        standard, half = (found * np.outer(scale, scale) for scale in scales.T)
        return standard, half


def _along(gathered: Gathered, kind: AxisKind) -> Parameter | None:
    """Friction, offset included, of a recording that moves in one direction only."""
    if gathered.one_way is None:
        return None
    bare = gathered.solved(offset=False)
    alone = parameter_of(bare, COULOMB, kind, gathered.effort_unit)
    return alone.widened(bare.of(COULOMB, bare.misfit), gathered.doubt[COULOMB])


@dataclass(frozen=True, eq=False)
class Joint:
    """Joint estimate of the shared terms.

    Attributes:
        theta: (s,).
        errors: standard errors (s,).
        reaches: half widths of the intervals of 95 % (s,).
    """

    theta: Array
    errors: Array
    reaches: Array

    @classmethod
    def of(cls, members: Sequence[Member], excesses: Sequence[Excess]) -> Joint:
        """Joint fit of recordings that vary beyond their own errors in each quantity (s,)."""
        between = np.array([found.variance for found in excesses])
        known = np.array([member.known for member in members])
        known = np.linalg.solve(np.eye(between.size) + known * between, known)
        moment = np.einsum("kij,kj->i", known, np.array([member.theta for member in members]))
        theta, inverse = solved(known.sum(axis=0), moment, np.zeros_like(known[0]))
        wide = between * np.array([found.reach for found in excesses]) ** 2
        variance, reached = np.zeros(theta.size), np.zeros(theta.size)
        for share, member in zip(inverse @ known, members, strict=True):
            error, half_width = (np.diag(share @ found @ share.T) for found in member.covariance)
            variance += error + share**2 @ between
            reached += half_width + share**2 @ wide
        return cls(theta, np.sqrt(variance), np.sqrt(reached))

    def left(self, members: Sequence[Member]) -> float:
        """Sum of squared residuals of all recordings, each with its own shift and hum - the effort's unit squared."""
        away = [self.theta - member.theta for member in members]
        return sum(m.solution.power + float(d @ m.matrix @ d) for m, d in zip(members, away, strict=True))


def _require_distinct(gathered: Sequence[Gathered]) -> None:
    if not gathered:
        raise InputError("recordings", "found none", "allowed: at least one")
    for one, other in combinations(gathered, 2):
        if one.effort_unit != other.effort_unit:
            found = f"gives its effort in {other.effort_unit}, {one.rows.origin} in {one.effort_unit}"
            raise InputError(other.rows.origin, found, "allowed: recordings of one kind of effort; say kT in the rig")
        if np.array_equal(one.equations.gram, other.equations.gram):
            found = f"found the same recording as {one.rows.origin}"
            raise InputError(other.rows.origin, found, "allowed: each recording once; twice would count as two")


def _joined(gathered: Sequence[Gathered]) -> NormalEquations:
    """Equations of all recordings in their common columns: J, K_w, K_0, misalignment, constant."""
    parts = [one.equations.only(lambda name: name in (*BASE, OFFSET)) for one in gathered]
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
            groups.setdefault(str(member.gathered.one_way), []).append(member.along)
    return excess(list(groups.values()))


def _residual(members: Sequence[Member], left: float, unit: str) -> Residual:
    """Residual of the joint fit over all recordings."""
    counts = np.array([member.equations.count for member in members])
    floors = [member.solution.floor.coloured for member in members]
    return Residual(
        rms=math.sqrt(left / counts.sum()),
        noise_floor=math.sqrt(float(counts @ np.square(floors)) / counts.sum()),
        relative=math.sqrt(left / sum(member.gathered.measured[0] for member in members)),
        unit=unit,
    )


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
            f"no two recordings tell {' or '.join(silent)} alike, so the interval does not count how recordings "
            "differ in it: record each direction twice"
        )


def _offset(gathered: Sequence[Gathered], members: Sequence[Member], rig: Rig) -> Iterator[str]:
    """A warning of an offset that is not fitted, which runs of one direction each attribute to friction."""
    if rig.offset or all(member.along is None for member in members):
        return
    kind, asked = rig.axis_kind, rig.model_copy(update={"offset": True})
    members = [Member.of(one, asked) for one in gathered]
    excesses = [_excess(members, kind, term) for term in members[0].terms]
    joint = Joint.of(members, excesses)
    value, reach = float(joint.theta[-1]), float(joint.reaches[-1])
    if abs(value) > reach:
        unit = kind.parameter_unit(OFFSET, gathered[0].effort_unit)
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


def identify(
    trace: Given | Iterator[Trace] | Sequence[Given | Iterator[Trace]],
    rig: Rig | str | Path,
    cutoff: float | None = None,
) -> Estimate:
    """Inertia, viscous and Coulomb friction (and offset, if the rig asks for it) of a recording, or of several.

    Each recording goes through the gate, is laid out in rows through one filter, and is summed up in normal equations
    at the cut-off at which the estimate stands still; these are solved, alone or together, with intervals that count
    correlated residuals, misfit, tolerances and what the recording hints at. What is not determined is refused.

    Args:
        trace: the recording, or its file, arrays by their names or a data frame; an iterator over its consecutive
            parts, for one that does not fit into memory; or a list (tuple) of several of one axis, which are fitted
            together.
        rig: what is known about the axis, or its file, or a shipped rig's name.
        cutoff: half-power frequency of the filter instead of the one chosen from the data - Hz.

    Raises:
        RefusedEstimateError: the recordings leave one of them undetermined; the error carries the others.
        UndeterminedError: they determine none, or one of several recordings never moves clearly.
        InputError: no recording, one that is given twice, a signal is missing, efforts in different units, rig and
            trace do not fit together, or a check of a recording fails.
    """
    rig = rig_of(rig)
    every = trace if isinstance(trace, list | tuple) else [cast("Given", trace)]
    recordings = [one if isinstance(one, Iterator) else trace_of(one, rig) for one in every]
    gathered = [gather(one, rig, cutoff) for one in recordings]
    found = estimated_alone(gathered[0], rig) if len(gathered) == 1 else estimated_together(gathered, rig)
    return replace(found, of=(rig, tuple(one for one in recordings if isinstance(one, Trace))))
