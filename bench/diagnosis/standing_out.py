"""Events that stand out of what a search leaves, whatever that is: no name for the rest is needed to see them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from bench.diagnosis.policy import Policy
from bench.effects.effect import Effect, Occasional, Standout
from bench.fit.fit import Fit, shaped
from bench.fit.hypothesis import Term


def with_events(fitted: Fit, effects: Iterable[Effect], policy: Policy) -> Fit:
    """The fit with the events that stand out of its remainder, each beside a parabola of what is left around it."""
    if not policy.remains(fitted):
        return fitted
    for effect in (each for each in effects if isinstance(each, Occasional)):
        for apart in effect.apart(fitted):
            fitted = _with_event(fitted, effect, apart, policy)
    return fitted


def _with_event(fitted: Fit, effect: Occasional, apart: Standout, policy: Policy) -> Fit:
    """With an event that saves more than chance does, and beside whose torque little is left around it."""
    term = Term(effect, apart.shape, around=apart.around)
    after = shaped(fitted.rows, fitted.hypothesis.plus(term), len(fitted.terms))
    own = after.owners == len(fitted.terms)
    others = np.linalg.qr(after.columns[:, ~own])[0]
    alone = after.columns[:, own] - others @ (others.T @ after.columns[:, own])
    saved = float(np.sum((alone @ after.theta[own]) ** 2))
    near = (fitted.time >= apart.around[0]) & (fitted.time <= apart.around[1])
    left = float(np.sum(after.residual[near] ** 2)) - np.count_nonzero(near) * fitted.floor**2
    numbers = after.theta[own].size + len(term.shape)
    found = saved > max(policy.by_chance(fitted, numbers), left / policy.beside_event)
    return after if found and policy.physical(after) else fitted
