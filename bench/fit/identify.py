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
from bench.fit.determined import sound
from bench.fit.estimate import Alone, Estimate, RefusedEstimateError
from bench.fit.gathered import Gathered, estimated_alone, gather, parameter_of, summed_up
from bench.fit.hypothesis import BASE
from bench.fit.solution import NormalEquations, Solution, join, solved
from bench.parameter import Parameter
from bench.rig.given import Given, rig_of, trace_of
from bench.rig.rig import Rig
from bench.trace.trace import Trace


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
    if len(gathered) == 1:
        found = estimated_alone(gathered[0], gathered[0].solution, rig)
    else:
        found = estimated_together(gathered, rig)
    return replace(found, of=(rig, tuple(one for one in recordings if isinstance(one, Trace))))


def estimated_together(gathered: Sequence[Gathered], rig: Rig) -> Estimate:
    """Estimate from several recordings of one axis.

    Raises:
        RefusedEstimateError: together they leave a parameter undetermined; the error carries the others.
        InputError: no recording, one that is given twice, or efforts in different units.
    """
    _require_distinct(gathered)
    kind, unit = rig.axis_kind, gathered[0].effort_unit
    members = [Member.of(one, rig) for one in gathered]
    excesses = {term: _excess(members, kind, term) for term in members[0].terms}
    theta, errors, reaches = _jointly(members, list(excesses.values()))
    parameters = {}
    for term, value, error, reach in zip(excesses, theta.tolist(), errors.tolist(), reaches.tolist(), strict=True):
        found = Parameter(value, kind.parameter_unit(term, unit), error, (value - reach, value + reach))
        tolerance = float(np.mean([_tolerance(one, term) for one in gathered]))
        parameters[kind.parameter(term)] = found.widened(tolerance)
    left = sum(each.left(theta) for each in members)
    estimate = replace(
        summed_up(gathered, [each.solution for each in members], parameters, left, rig),
        warnings=(
            *(f"{each.alone.origin}: {warning}" for each in members for warning in each.warnings),
            *(f"{each.alone.origin} alone: {each.alone.reason}" for each in members if each.alone.reason),
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
        solution: its own fit, with these columns and its own shift and hum.
        alone: its estimate alone.
        own: the same without the rig's tolerances, which are common to all recordings.
        along: if it moves in one direction only, its friction in that direction, offset included; else None.
        covariances: of its coefficients, in standard errors and in half widths of intervals of 95 % (s, s) each.
        warnings: of its own fit.
    """

    gathered: Gathered
    terms: tuple[str, ...]
    solution: Solution
    alone: Alone
    own: Mapping[str, Parameter]
    along: Parameter | None
    covariances: tuple[Array, Array]
    warnings: tuple[str, ...]

    @classmethod
    def of(cls, gathered: Gathered, rig: Rig) -> Member:
        """The fit of one recording alone.

        A parameter that it does not determine alone is as much wider than by its own fit as friction along one
        direction is.
        """
        kind, terms = rig.axis_kind, (INERTIA, VISCOUS, COULOMB, *([OFFSET] if rig.offset else []))
        solution, one_way = gathered.solved(rig.offset), gathered.equations.one_way is not None
        bare = gathered.solved(offset=False) if one_way else solution
        found, reason = None, ""
        try:
            found = estimated_alone(gathered, bare, rig)
        except RefusedEstimateError as refusal:
            found, reason = refusal.estimate, str(refusal)
        except UndeterminedError as refusal:
            reason = str(refusal)
        known = {} if found is None else found.parameters
        kept = {name: one for name, one in known.items() if name != kind.inertia or one.ci95[0] * one.ci95[1] > 0.0}
        own, along, wider = dict(kept), None, (1.0, solution.reach)
        names = {kind.parameter(term): term for term in terms} | {"load_moment_of_inertia": INERTIA}
        for name in own.keys() & names.keys():
            own[name] = _without(own[name], _tolerance(gathered, names[name]))
        if one_way:
            along = parameter_of(bare, COULOMB, kind, gathered.effort_unit)
            along = along.widened(bare.of(COULOMB, bare.misfit), gathered.doubt[COULOMB])
            error = max(bare.of(COULOMB, bare.errors), 1e-300)
            wider = along.std_error / error, along.half_width / error
        at = [solution.names.index(term) for term in terms]
        covariance = solution.covariance[np.ix_(at, at)]
        scales = []
        for term, variance in zip(terms, np.diag(covariance).tolist(), strict=True):
            one, error = own.get(kind.parameter(term)), math.sqrt(max(variance, 1e-300))
            scales.append(wider if one is None else (one.std_error / error, one.half_width / error))
        standard, half = (covariance * np.outer(scale, scale) for scale in np.array(scales).T)
        warnings = () if found is None else found.warnings
        alone = Alone(gathered.rows.origin, kept, reason)
        return cls(gathered, terms, solution, alone, own, along, (standard, half), warnings)

    @cached_property
    def _at(self) -> list[int]:
        """Places of the shared terms among the columns of its own fit (s,)."""
        return [self.solution.names.index(term) for term in self.terms]

    @property
    def theta(self) -> Array:
        """Coefficients of the shared terms in its own fit (s,)."""
        return self.solution.theta[self._at]

    @cached_property
    def matrix(self) -> Array:
        """Matrix of the normal equations of these, its own shift and hum eliminated, positive semidefinite (s, s).

        A column with less power than expected from its noise carries no information.
        """
        equations, shared, held = self.solution.equations, self._at, self.solution.held
        whole, gram, noise = equations.matrix, equations.total, equations.count * equations.noise
        rest = {k: name for k, name in enumerate(equations.names) if k not in shared}
        own = [k for k, name in rest.items() if not (held and name == MISALIGNMENT)]
        beside = whole[np.ix_(own, shared)]
        taken, _ = solved(gram[np.ix_(own, own)], beside, noise[np.ix_(own, own)])
        scale = np.sqrt(np.diag(gram)[shared])
        power, ways = np.linalg.eigh((whole[np.ix_(shared, shared)] - beside.T @ taken) / np.outer(scale, scale))
        return (ways * np.maximum(power, 0.0)) @ ways.T * np.outer(scale, scale)

    def left(self, theta: Array) -> float:
        """Sum of its squared residuals by other coefficients (s,) - the effort's unit squared."""
        away = theta - self.theta
        return self.solution.power + float(away @ self.matrix @ away)


def _tolerance(gathered: Gathered, term: str) -> float:
    """Half width of a coefficient from the rig's tolerances; of an offset that was not fitted it is in the friction."""
    return gathered.tolerance.get(term, gathered.tolerance[COULOMB])


def _without(found: Parameter, reach: float) -> Parameter:
    """A parameter less an independent error of such a half width at 95 %."""
    half = math.sqrt(max(found.half_width**2 - reach**2, 0.0))
    error = math.sqrt(max(found.std_error**2 - (reach / NORMAL95) ** 2, 0.0))
    return replace(found, std_error=error, ci95=(found.value - half, found.value + half))


def _jointly(members: Sequence[Member], excesses: Sequence[Excess]) -> tuple[Array, Array, Array]:
    """Coefficients of recordings that vary beyond their own errors, standard errors, half widths at 95 % (s,) each."""
    between = np.array([found.variance for found in excesses])
    known = np.array([_information(each) for each in members])
    known = np.linalg.solve(np.eye(between.size) + known * between, known)
    moment = np.einsum("kij,kj->i", known, np.array([each.theta for each in members]))
    theta, inverse = solved(known.sum(axis=0), moment, np.zeros_like(known[0]))
    wide = between * np.array([found.reach for found in excesses]) ** 2
    variance, reached = np.zeros(theta.size), np.zeros(theta.size)
    for share, each in zip(inverse @ known, members, strict=True):
        error, half_width = (np.diag(share @ found @ share.T) for found in each.covariances)
        variance += error + share**2 @ between
        reached += half_width + share**2 @ wide
    return theta, np.sqrt(variance), np.sqrt(reached)


def _information(member: Member) -> Array:
    """What a recording tells of the shared terms (s, s): its matrix over the mean variance that is implied."""
    implied = float(np.trace(member.matrix @ member.covariances[0]))
    return member.matrix * len(member.terms) / max(implied, 1e-300)


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
            groups.setdefault(str(member.gathered.equations.one_way), []).append(member.along)
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
            f"no two recordings tell {' or '.join(silent)} alike, so the interval does not count how recordings "
            "differ in it: record each direction twice"
        )


def _offset(members: Sequence[Member], rig: Rig) -> Iterator[str]:
    """A warning of an offset that is not fitted, which runs of one direction each attribute to friction."""
    if rig.offset or all(member.along is None for member in members):
        return
    kind, asked = rig.axis_kind, rig.model_copy(update={"offset": True})
    members = [Member.of(each.gathered, asked) for each in members]
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
