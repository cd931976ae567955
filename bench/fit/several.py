"""Joint fit of several recordings of one axis: what one does not determine, another may.

    theta = (sum of B_k)**-1 * sum of B_k*theta_k,   B_k = (I + A_k*D)**-1 * A_k

theta - J, K_w, K_0 and offset, common to all recordings; theta_k - their estimate from recording k alone; A_k - its
information: the matrix of its normal equations, scaled to its covariance, with its own shift of torque against speed
and its own hum eliminated; D - variances between recordings beyond their own errors (`between.py`). With D = 0 it is
the least-squares fit to all recordings (D. Jackson, I. R. White, S. G. Thompson, Statistics in Medicine 29(12), 2010,
1282-1297). A_k may be singular: a run in one direction determines only the sum of K_0 and offset. Each recording keeps
its own filter, noise, sample period and source of speed. The interval covers the recordings' own errors and D.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.comparison.spread import ALARM, Between, Excess, between, excess, spread_warning
from bench.errors import InputError, UndeterminedError
from bench.fit.determined import left_open, only_direction, require_determined, require_sound
from bench.fit.estimate import Estimate, RefusedEstimateError, Residual
from bench.fit.load_inertia import load_inertia
from bench.fit.member import Member
from bench.fit.normal_equations import NormalEquations, join, solved
from bench.fit.parameter import Parameter
from bench.fit.regression import Gathered, gather, negative
from bench.fit.solution import Left
from bench.gate.gate import joined
from bench.rig.rig import Rig
from bench.statistics import NORMAL95
from bench.trace.trace import Trace


def identify_together(traces: Sequence[Trace | Iterable[Trace]], rig: Rig, cutoff: float | None = None) -> Estimate:
    """Inertia, viscous and Coulomb friction (and offset, if the rig asks for it) of several recordings of one axis.

    Args:
        traces: the recordings, each whole or as an iterator over its consecutive parts.
        rig: of the axis.
        cutoff: half-power frequency of the filter instead of those chosen from the recordings - Hz.

    Raises:
        RefusedEstimateError: together they leave one of them undetermined; the error carries the others.
        UndeterminedError: one recording never moves clearly.
        InputError: no recording, one that is given twice, a signal is missing, or efforts in different units.
    """
    gathered = [gather(trace, rig, cutoff) for trace in traces]
    _require_distinct(gathered)
    kind, unit, whole = rig.axis_kind, gathered[0].effort_unit, _joined(gathered)
    members = [Member.of(one, rig) for one in gathered]
    terms = [INERTIA, VISCOUS, COULOMB, *([OFFSET] if rig.offset else [])]
    excesses = {term: _excess(members, kind, term) for term in terms}
    joint = Joint.of(members, list(excesses.values()), kind)
    parameters = {}
    for term, value, error, reach in zip(terms, *(row.tolist() for row in joint.numbers), strict=True):
        tolerance = float(np.mean([member.tolerances[kind.parameter(term)] for member in members]))
        error, reach = math.hypot(error, tolerance / NORMAL95), math.hypot(reach, tolerance)
        interval = (value - reach, value + reach)
        parameters[kind.parameter(term)] = Parameter(value, kind.parameter_unit(term, unit), error, interval)
    filters = [one.rows.conditioning.filter for one in gathered]
    left = joint.left(members)
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
            *negative(parameters, kind),
        ),
        explained=1.0 - left / max(_variation(whole), 1e-300),
        checks=joined([one.checks for one in gathered]),
        recordings=tuple(member.alone for member in members),
        between=_between(members, kind),
    )
    return _sound(estimate, whole, excesses[INERTIA], kind)


def _sound(estimate: Estimate, whole: NormalEquations, apart: Excess, kind: AxisKind) -> Estimate:
    """The estimate, if the recordings together determine it and it is sound; `apart`: spread of the inertia."""
    suspicions = []
    if apart.variance:
        unit = estimate[kind.inertia].unit
        spread = f"{math.sqrt(apart.variance):.2g} {unit}"
        suspicions = [f"it differs from recording to recording by {spread}, and few are given"]
    try:
        require_determined(whole, kind)
        require_sound(estimate, kind, suspicions)
    except UndeterminedError as refusal:
        unknown = {kind.parameter(term) for term in left_open(whole, kind)}
        determined = {name: found for name, found in estimate.parameters.items() if name not in unknown}
        raise RefusedEstimateError(refusal, replace(estimate, parameters=determined)) from refusal
    return estimate


def _variation(joined: NormalEquations) -> float:
    """Sum of squares of the effort less its mean, over all recordings - the effort's unit squared."""
    return float(joined.power.sum()) - float(joined.moment[:, -1].sum()) ** 2 / joined.count


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
    parts = [one.equations.select([*range(4), one.equations.noise.shape[0] - 1]) for one in gathered]
    noise = sum((part.count * part.noise for part in parts), np.zeros_like(parts[0].noise))
    return replace(join(parts), noise=noise / sum(part.count for part in parts))


@dataclass(frozen=True)
class Joint:
    """Joint estimate of J, K_w, K_0 and, where it is fitted, offset (s,).

    Attributes:
        theta: (s,).
        errors: standard errors (s,).
        reaches: half widths of the intervals of 95 % (s,).
    """

    theta: Array
    errors: Array
    reaches: Array

    @property
    def numbers(self) -> tuple[Array, Array, Array]:
        """Values, standard errors and half widths (s,) each."""
        return self.theta, self.errors, self.reaches

    @classmethod
    def of(cls, members: Sequence[Member], excesses: Sequence[Excess], kind: AxisKind) -> Joint:
        """Joint fit of recordings.

        Args:
            members: the recordings.
            excesses: their variance in each quantity beyond their own errors (s,).
            kind: of the axis.
        """
        between = np.array([found.variance for found in excesses])
        known = np.array([member.known(kind) for member in members])
        known = np.linalg.solve(np.eye(between.size) + known * between, known)
        moment = np.einsum("kij,kj->i", known, np.array([member.theta for member in members]))
        theta, inverse = solved(known.sum(axis=0), moment, np.zeros_like(known[0]))
        wide = between * np.array([found.reach for found in excesses]) ** 2
        variance, reached = np.zeros(theta.size), np.zeros(theta.size)
        for share, member in zip(inverse @ known, members, strict=True):
            error, half_width = (np.diag(share @ found @ share.T) for found in member.covariance(kind))
            variance += error + share**2 @ between
            reached += half_width + share**2 @ wide
        return cls(theta, np.sqrt(variance), np.sqrt(reached))

    def left(self, members: Sequence[Member]) -> float:
        """Sum of squared residuals of all recordings, each with its own shift and hum - the effort's unit squared."""
        away = [self.theta - member.theta for member in members]
        return sum(member.power + float(d @ member.matrix @ d) for member, d in zip(members, away, strict=True))


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
            groups.setdefault(str(only_direction(member.gathered.equations)), []).append(member.along)
    return excess(list(groups.values()))


def _residual(members: Sequence[Member], left: float, unit: str) -> Residual:
    """Residual of the joint fit over all recordings."""
    counts = np.array([member.equations.count for member in members])
    floors = [Left.of(m.gathered.rows, m.gathered.hypothesis, m.solved).floor for m in members]
    return Residual(
        rms=math.sqrt(left / counts.sum()),
        noise_floor=math.sqrt(float(counts @ np.square(floors)) / counts.sum()),
        relative=math.sqrt(left / sum(float(member.equations.power.sum()) for member in members)),
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
    excesses = [_excess(members, kind, term) for term in (INERTIA, VISCOUS, COULOMB, OFFSET)]
    value, _, reach = (float(row[-1]) for row in Joint.of(members, excesses, kind).numbers)
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
