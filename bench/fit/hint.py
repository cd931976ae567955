"""An effect that a recording hints at, too weak to be named: what it would move is not known better.

A torque constant that drifts by 1 % moves J by 0.8 %, a drag that takes 4 % of the torque at top speed moves K_w by a
third, while each takes no more of the residual than some tenths of a per cent: no name, and yet several times the
interval that holds without it.
"""

from __future__ import annotations

from collections.abc import Iterable

from bench.effects.effect import Effect
from bench.fit.fit import Fit, explained, fit
from bench.fit.hypothesis import Term

#: Standard errors from which a strength is no longer chance: 3 of 1000 by a normal distribution.
SURE = 3.0


def hint(fitted: Fit, effects: Iterable[Effect]) -> Fit | None:
    """The fit with the effect beside what is fitted that explains most, if that is more than chance does; else None.

    Args:
        fitted: what is known so far.
        effects: of which those count that are linear in all their quantities, so that no search makes them fit.
    """
    linear = [
        effect
        for effect in effects
        if effect.overrides("columns") and not effect.shapes
        if effect.sought(fitted.scope) and fitted.hypothesis.admits(effect)
    ]
    gains = {effect: fitted.tried(effect, [()])[0].gain for effect in linear}
    least = SURE**2 * fitted.rows.correlation * fitted.floor**2
    for effect in sorted((effect for effect in linear if gains[effect] > least), key=lambda effect: -gains[effect]):
        beside = fit(fitted.rows, fitted.hypothesis.plus(Term(effect)))
        strengths = beside.strengths(len(fitted.terms))
        physical = effect.physical(strengths, (), beside.base) and effect.plausible([strengths], [()], fitted.scope)
        if physical and beside.base.inertia > 0.0 and explained(fitted, beside) > least:
            return beside
    return None
