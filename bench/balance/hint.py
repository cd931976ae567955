"""A fault of a sensor that a recording hints at, too weak to be named: what it would move is not known better.

A torque constant that drifts by 1 % moves J by 0.8 % while it takes no more of the residual than some tenths of a per
cent: no name, and yet thirteen times the interval that holds without it.
"""

from __future__ import annotations

from collections.abc import Iterable

from bench.balance.fit import Fit, fit
from bench.balance.hypothesis import Term
from bench.effects.effect import Effect

#: Standard errors from which a strength is no longer chance: 3 of 1000 by a normal distribution.
SURE = 3.0


def hint(fitted: Fit, effects: Iterable[Effect]) -> Fit | None:
    """The fit with the fault beside what is fitted that explains most, if that is more than chance does; else None.

    Args:
        fitted: what is known so far.
        effects: of which those count that are faults of a sensor and linear in their strength.
    """
    scope = fitted.scope
    faults = [
        effect
        for effect in effects
        if effect.kind == "measurement" and effect.overrides("columns") and not effect.shapes
        if effect.sought(scope) and fitted.hypothesis.admits(effect)
    ]
    gains = {effect: fitted.tried(effect, [()])[0].gain for effect in faults}
    best = max(gains, key=lambda effect: gains[effect], default=None)
    if best is None or gains[best] <= SURE**2 * fitted.rows.correlation * fitted.floor**2:
        return None
    beside = fit(fitted.rows, fitted.hypothesis.plus(Term(best)))
    return beside if best.plausible([beside.strengths(len(fitted.terms))], [()], scope) else None
