"""One of several recordings that are fitted together: its information about the axis, and its estimate alone."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, OFFSET, VISCOUS, AxisKind
from bench.errors import UndeterminedError
from bench.fit import layout
from bench.fit.cutoffs import TERMS
from bench.fit.determined import only_direction
from bench.fit.estimate import Alone, RefusedEstimateError
from bench.fit.normal_equations import NormalEquations, solved
from bench.fit.parameter import Parameter
from bench.fit.regression import Gathered, parameters_of, solve
from bench.fit.solution import Left, Solved, solved_with_shift
from bench.rig.rig import Rig
from bench.statistics import NORMAL95


@dataclass(frozen=True)
class Member:
    """One of several recordings.

    Attributes:
        gathered: its normal equations.
        solved: its own fit, with the columns that all recordings share and its own shift and hum.
        alone: its estimate alone.
        along: if it moves in one direction only, its friction in that direction, offset included; else None.
        scales: standard error and half width at 95 % of parameters that it does not determine alone, over the
            standard error in `solved`.
        tolerances: half widths of J, K_w, K_0 and offset from the rig's tolerances.
        warnings: of its own fit.
    """

    gathered: Gathered
    solved: Solved
    alone: Alone
    along: Parameter | None
    scales: tuple[float, float]
    tolerances: dict[str, float]
    warnings: tuple[str, ...]

    @classmethod
    def of(cls, gathered: Gathered, rig: Rig) -> Member:
        """The fit of one recording alone.

        Raises:
            InputError: rig and recording do not fit together.
        """
        kind, origin, equations = rig.axis_kind, gathered.rows.origin, gathered.equations
        own = solved_with_shift(equations, gathered.rows, rig.offset)
        along, scales = None, (1.0, own.reach)
        one_way = only_direction(equations) is not None  # no offset was fitted then: it is in the friction
        places = TERMS | ({OFFSET: layout.COULOMB if one_way else -1} if own.offset else {})
        tolerances = {kind.parameter(term): float(gathered.tolerance[place]) for term, place in places.items()}
        tolerances |= {"load_moment_of_inertia": tolerances[kind.inertia]}
        if one_way:
            bare = solved_with_shift(equations, gathered.rows, False)
            misfit = Left.of(gathered.rows, gathered.hypothesis, bare).misfit(bare)
            more = np.hypot(misfit, np.pad(gathered.doubt, (0, misfit.size - gathered.doubt.size)))
            along = parameters_of(bare, kind, gathered.effort_unit, more)[kind.parameter(COULOMB)]
            error = max(float(bare.errors[layout.COULOMB]), 1e-300)
            scales = along.std_error / error, along.half_width / error
        try:
            found, reason = solve(gathered, rig), ""
        except RefusedEstimateError as refusal:
            found, reason = refusal.estimate, str(refusal)
        except UndeterminedError as refusal:
            return cls(gathered, own, Alone(origin, {}, str(refusal)), along, scales, tolerances, ())
        kept = {name: one for name, one in found.parameters.items() if name != kind.inertia or not _holds_zero(one)}
        return cls(gathered, own, Alone(origin, kept, reason), along, scales, tolerances, found.warnings)

    @property
    def _shared(self) -> list[int]:
        return [layout.INERTIA, layout.VISCOUS, layout.COULOMB, *([len(self.solved.columns) - 1] * self.solved.offset)]

    @property
    def equations(self) -> NormalEquations:
        """Of the fitted columns."""
        return self.gathered.equations.select(self.solved.columns)

    @property
    def power(self) -> float:
        """Sum of squared residuals of its own fit - the effort's unit squared."""
        return max(self.equations.residual_power(self.solved.theta), 0.0)

    @property
    def theta(self) -> Array:
        """J, K_w, K_0 and, where it is fitted, offset of its own fit (s,)."""
        return self.solved.theta[self._shared]

    @property
    def matrix(self) -> Array:
        """Matrix of the normal equations of these, its own shift and hum eliminated, positive semidefinite (s, s).

        A column with less power than expected from its noise carries no information.
        """
        at, equations, shared = layout.MISALIGNMENT, self.equations, self._shared
        whole, gram, noise = equations.matrix, equations.gram.sum(axis=0), equations.count * equations.noise
        own = [k for k in range(gram.shape[0]) if k not in shared and not (self.solved.held and k == at)]
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

    def known(self, kind: AxisKind) -> Array:
        """Its information about these: `matrix` over the mean variance implied by its covariance (s, s)."""
        matrix, (covariance, _) = self.matrix, self.covariance(kind)
        return matrix * matrix.shape[0] / max(float(np.trace(matrix @ covariance)), 1e-300)

    def covariance(self, kind: AxisKind) -> tuple[Array, Array]:
        """Covariance of `theta` in standard errors, and in half widths of intervals of 95 % (s, s) each."""
        found = self.solved.covariance[np.ix_(self._shared, self._shared)]
        names = [kind.parameter(term) for term in (INERTIA, VISCOUS, COULOMB, OFFSET)][: len(self._shared)]
        errors = np.sqrt(np.maximum(np.diag(found), 1e-300)).tolist()
        own = self.own
        scales = np.array(
            [
                (own[name].std_error / error, own[name].half_width / error) if name in own else self.scales
                for name, error in zip(names, errors, strict=True)
            ]
        )
        standard, half = (found * np.outer(scale, scale) for scale in scales.T)
        return standard, half


def _holds_zero(found: Parameter) -> bool:
    low, high = found.ci95
    return low <= 0.0 <= high
