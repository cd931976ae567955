"""Dry frictions of one axis multiply: what scales the level scales all that other effects add to it.

    M = (K_0 + sum of added levels)*(1 + w_1)*(1 + w_2)*...

Linear in the strengths only with the other strengths held, as share of K_0; a fit brings them in line. So it is where
friction follows the torque of a load, which is a matter of other strengths.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.axis_kind import COULOMB
from bench.effects.signals import Signals
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows


def with_friction(seen: Rows, hypothesis: Hypothesis, index: int) -> Rows:
    """The recording with the level of dry friction that the term at an index scales or carries, as share of K_0.

    sgn(omega) and what terms add to it, times what scales it: before the one at the index, or all where it carries it.
    """
    terms = hypothesis.terms
    last = len(terms) if index < len(terms) and terms[index].effect.carries_friction else index
    others = [term for k, term in enumerate(terms) if term.level and k != index]
    acting = [term for term in others if not term.effect.scales_friction]
    acting += [term for k, term in enumerate(terms[:last]) if term.level and k != index and term.effect.scales_friction]
    if not acting:
        return seen

    def change(signals: Signals) -> Signals:
        for term in acting:
            more = term.effect.level(signals, term.shape, term.level)
            signals = replace(signals, friction=signals.friction + more)
        return signals

    return seen.with_signals(change)


def with_levels(hypothesis: Hypothesis, theta: Array, owners: NDArray[np.object_]) -> Hypothesis:
    """The hypothesis with the levels that a fit found: strengths over K_0 where that is positive."""
    coulomb = float(theta[owners == COULOMB][0])

    def level(index: int, term: Term) -> tuple[float, ...]:
        if coulomb <= 0.0 or not term.effect.overrides("level"):
            return ()
        return tuple((theta[owners == index] / coulomb).tolist())

    return hypothesis.with_terms(replace(term, level=level(index, term)) for index, term in enumerate(hypothesis.terms))


def multiply(hypothesis: Hypothesis) -> bool:
    """Whether an effect scales what another adds, or carries it."""
    effects = [term.effect for term in hypothesis.terms]
    levels = sum(effect.overrides("level") for effect in effects)
    scaled = levels > 1 and any(effect.scales_friction for effect in effects)
    return scaled or (levels > 0 and any(effect.carries_friction for effect in effects))


def with_load(seen: Rows, pulls: Iterable[tuple[Term, Sequence[float]]]) -> Rows:
    """The recording with the torque that terms of some strengths make as a load; others are left out."""
    known = [(term, strengths) for term, strengths in pulls if strengths and term.effect.overrides("load_torque")]
    if not known:
        return seen

    def change(signals: Signals) -> Signals:
        load = np.zeros(signals.time.size)
        for term, strengths in known:
            for strength, ((values, _),) in zip(strengths, term.effect.columns(signals, term.shape), strict=True):
                load += strength * values
        return replace(signals, load=load)

    return seen.with_signals(change)


def with_pulls(hypothesis: Hypothesis, theta: Array, owners: NDArray[np.object_]) -> Hypothesis:
    """The hypothesis with the strengths that a fit found of its loads, if the friction of a term follows them."""
    if not follows_load(hypothesis):
        return hypothesis

    def pull(index: int, term: Term) -> tuple[float, ...]:
        return tuple(theta[owners == index].tolist()) if term.effect.overrides("load_torque") else ()

    return hypothesis.with_terms(replace(term, pull=pull(k, term)) for k, term in enumerate(hypothesis.terms))


def follows_load(hypothesis: Hypothesis) -> bool:
    """Whether the friction of a term follows the torque of the load."""
    return any(term.effect.overrides("friction_under_load") for term in hypothesis.terms)
