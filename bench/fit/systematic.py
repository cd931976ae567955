"""What an estimate may be off beside noise: the rig's tolerances, and an effect that is there and too weak to be named.

A torque constant that drifts by 1 % moves J by 0.8 %, a drag that takes 4 % of the torque at top speed moves K_w by a
third, while each takes no more of the residual than some tenths of a per cent: no name, and yet several times the
interval that holds without it. What it would move is not known better.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.effects.catalogue import catalogue
from bench.effects.effect import Columns, Effect
from bench.fit.fit import Fit, explained, fit
from bench.fit.hypothesis import Term
from bench.fit.layout import lay_out
from bench.fit.normal_equations import Name
from bench.fit.rows import Rows
from bench.fit.solution import Solution, equations_of, solve
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Standard errors from which a strength is no longer chance: 3 of 1000 by a normal distribution.
SURE = 3.0


def by_tolerance(first: Trace, rig: Rig, found: Solution, offset: bool) -> dict[Name, float]:
    """Half widths at 95 % of coefficients by their names from the rig's tolerances, taken for independent."""
    moved = np.zeros(found.theta.size)
    for other in rig.within_tolerance():
        rows = Rows.of(first, other, conditioning=found.rows.conditioning)
        laid = lay_out(rows, found.hypothesis)
        theta = solve(rows, found.hypothesis, laid, equations_of(rows, laid), offset).theta
        moved = np.hypot(moved, theta - found.theta)
    return dict(zip(found.names, moved.tolist(), strict=True))


def by_hint(found: Solution) -> dict[str, float]:
    """By how much the effect that a recording hints at would move J, K_w and K_0 of its solution; empty without one."""
    fitted = fit(found.rows, found.hypothesis)
    beside = hint(fitted, catalogue().values())
    if beside is None:
        return {}
    return {term: beside.value(term) - fitted.value(term) for term in (INERTIA, VISCOUS, COULOMB)}


def hint(fitted: Fit, effects: Iterable[Effect]) -> Fit | None:
    """The fit with the effect beside what is fitted that explains most, if that is more than chance does; else None.

    Of the effects those count that are linear in all their quantities, so that no search makes them fit.
    """
    linear = [
        effect
        for effect in effects
        if isinstance(effect, Columns) and not effect.shapes
        if effect.sought(fitted.scope) and fitted.hypothesis.admits(effect)
    ]
    gains = dict(zip(linear, fitted.worth(linear), strict=True))
    if max(gains.values(), default=0.0) <= SURE**2 * fitted.rows.correlation * fitted.noise.white**2:
        return None  # a floor in colour, which takes long, is no lower
    least = SURE**2 * fitted.rows.correlation * fitted.floor**2
    for effect in sorted((effect for effect in linear if gains[effect] > least), key=lambda effect: -gains[effect]):
        beside = fit(fitted.rows, fitted.hypothesis.plus(Term(effect)))
        strengths = beside.strengths(len(fitted.terms))
        physical = effect.physical(strengths, (), beside.base) and effect.plausible([strengths], [()], fitted.scope)
        if physical and beside.base.inertia > 0.0 and explained(fitted, beside) > least:
            return beside
    return None
