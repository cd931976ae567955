"""A hypothesis: which effects there are and of what shape, and what is in the recording beside them.

Dry frictions of one axis multiply: what scales the level scales all that other effects add to it.

    M = (K_0 + sum of added levels)*(1 + w_1)*(1 + w_2)*...

Linear in the strengths only with the other strengths held, as share of K_0. So it is where friction follows the torque
of a load, which is a matter of other strengths. An outer load - drag, a spring, an unbalance, an event - on the motor
stands in the balance as it is; on the load of a soft coupling it shakes the coupling first, and its strength also
drives the load's motion. A fit brings all of these in line.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.axis_kind import COULOMB
from bench.effects.acting import CarriesFriction, FollowsLoad, FrictionLevel, LoadTorque, ScalesFriction
from bench.effects.effect import Coupling, Effect, Lag, Load, OuterTorque, Repeatable
from bench.effects.signals import Signals
from bench.fit.rows import Rows


@dataclass(frozen=True)
class Term:
    """An effect of a shape.

    Attributes:
        effect: what it is.
        shape: its nonlinear quantities, in the effect's order.
        level: strengths over K_0 that others see of it, if it is dry friction; () until a fit has found them.
        load: strengths over load inertia by which it acts on the load behind a coupling, () until a fit has found them;
            None where it acts on the motor.
        pull: strengths by which it loads what transmits the torque, if others follow that and a fit has found them.
        around: from when to when what else is left is taken for a parabola, a nuisance - s -; () for nowhere.
    """

    effect: Effect
    shape: tuple[float, ...] = ()
    level: tuple[float, ...] = ()
    load: tuple[float, ...] | None = None
    pull: tuple[float, ...] = ()
    around: tuple[float, ...] = ()

    @property
    def key(self) -> tuple[str, tuple[float, ...]]:
        """What tells its columns from those of other terms."""
        return self.effect.name, self.shape

    def same(self, other: Term) -> bool:
        """Whether it is the same effect of the same shape."""
        return self.effect is other.effect and self.shape == other.shape


@dataclass(frozen=True)
class Hypothesis:
    """Effects beyond inertia, viscous and Coulomb friction, and nuisances: what a recording has that the axis has not.

    Attributes:
        terms: in the order in which they were added.
        hum: frequencies of the mains in this recording's sensors - Hz.
        step: between the values of the effort, if its last digit matters; else 0 - N*m (N).
    """

    terms: tuple[Term, ...] = ()
    hum: tuple[float, ...] = ()
    step: float = 0.0

    def plus(self, term: Term) -> Hypothesis:
        """This hypothesis and one term more."""
        return replace(self, terms=(*self.terms, term))

    def without(self, index: int) -> Hypothesis:
        """This hypothesis less one of its terms."""
        return replace(self, terms=(*self.terms[:index], *self.terms[index + 1 :]))

    def first(self, count: int) -> Hypothesis:
        """This hypothesis with the first of its terms only."""
        return replace(self, terms=self.terms[:count])

    def reshaped(self, index: int, shape: tuple[float, ...]) -> Hypothesis:
        """This hypothesis with another shape of one term."""
        return self.with_term(index, replace(self.terms[index], shape=shape))

    def with_term(self, index: int, term: Term) -> Hypothesis:
        """This hypothesis with another term in the place of one."""
        return replace(self, terms=(*self.terms[:index], term, *self.terms[index + 1 :]))

    def with_terms(self, terms: Iterable[Term]) -> Hypothesis:
        """This hypothesis with other terms."""
        return replace(self, terms=tuple(terms))

    def admits(self, effect: Effect) -> bool:
        """Whether an effect may come beside these: one coupling, one lag."""
        present = [term.effect for term in self.terms]
        if effect in present and not isinstance(effect, Repeatable):
            return False
        alone = [kind for kind in (Coupling, Lag) if isinstance(effect, kind)]
        return not any(isinstance(other, kind) for other in present for kind in alone)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(term.effect.name for term in self.terms)

    @property
    def coupling(self) -> int | None:
        """Index of the term that joins motor and load, None if they are one."""
        return next((index for index, term in enumerate(self.terms) if isinstance(term.effect, Coupling)), None)


def with_found_strengths(hypothesis: Hypothesis, theta: Array, owners: NDArray[np.object_]) -> Hypothesis:
    """The hypothesis with what its terms see of each other's strengths, as fitted coefficients (p,) have them."""
    found = _with_loads(_with_levels(hypothesis, theta, owners), theta, owners)
    return _with_pulls(found, theta, owners)


def terms_interact(hypothesis: Hypothesis) -> bool:
    """Whether the columns of a term depend on the strengths of another."""
    loaded = any(term.load is not None for term in hypothesis.terms)
    return loaded or _follows_load(hypothesis) or _multiply(hypothesis)


def with_friction(seen: Rows, hypothesis: Hypothesis, index: int) -> Rows:
    """The recording with the level of dry friction that the term at an index scales or carries, as share of K_0.

    sgn(omega) and what terms add to it, times what scales it: before the one at the index, or all where it carries it.
    """
    terms = hypothesis.terms
    carries = index < len(terms) and isinstance(terms[index].effect, CarriesFriction)
    others = [
        (term, term.effect, k < index or carries)
        for k, term in enumerate(terms)
        if isinstance(term.effect, FrictionLevel) and term.level and k != index
    ]
    acting = [(term, effect) for term, effect, _ in others if not isinstance(effect, ScalesFriction)]
    acting += [(term, effect) for term, effect, before in others if before and isinstance(effect, ScalesFriction)]
    if not acting:
        return seen

    def change(signals: Signals) -> Signals:
        for term, effect in acting:
            more = effect.level(signals, term.shape, term.level)
            signals = replace(signals, friction=signals.friction + more)
        return signals

    return seen.with_signals(change)


def _with_levels(hypothesis: Hypothesis, theta: Array, owners: NDArray[np.object_]) -> Hypothesis:
    """The hypothesis with the levels that a fit found: strengths over K_0 where that is positive."""
    coulomb = float(theta[owners == COULOMB][0])

    def level(index: int, term: Term) -> tuple[float, ...]:
        if coulomb <= 0.0 or not isinstance(term.effect, FrictionLevel):
            return ()
        return tuple((theta[owners == index] / coulomb).tolist())

    return hypothesis.with_terms(replace(term, level=level(index, term)) for index, term in enumerate(hypothesis.terms))


def _multiply(hypothesis: Hypothesis) -> bool:
    """Whether an effect scales what another adds, or carries it."""
    effects = [term.effect for term in hypothesis.terms]
    levels = sum(isinstance(effect, FrictionLevel) for effect in effects)
    scaled = levels > 1 and any(isinstance(effect, ScalesFriction) for effect in effects)
    return scaled or (levels > 0 and any(isinstance(effect, CarriesFriction) for effect in effects))


def with_load(seen: Rows, pulls: Iterable[tuple[Term, Sequence[float]]]) -> Rows:
    """The recording with the torque that terms of some strengths make as a load; others are left out."""
    known = [
        (term.effect, term.shape, strengths)
        for term, strengths in pulls
        if strengths and isinstance(term.effect, LoadTorque)
    ]
    if not known:
        return seen

    def change(signals: Signals) -> Signals:
        load = np.zeros(signals.time.size)
        for effect, shape, strengths in known:
            for strength, ((values, _),) in zip(strengths, effect.columns(signals, shape), strict=True):
                load += strength * values
        return replace(signals, load=load)

    return seen.with_signals(change)


def _with_pulls(hypothesis: Hypothesis, theta: Array, owners: NDArray[np.object_]) -> Hypothesis:
    """The hypothesis with the strengths that a fit found of its loads, if the friction of a term follows them."""
    if not _follows_load(hypothesis):
        return hypothesis

    def pull(index: int, term: Term) -> tuple[float, ...]:
        return tuple(theta[owners == index].tolist()) if isinstance(term.effect, LoadTorque) else ()

    return hypothesis.with_terms(replace(term, pull=pull(k, term)) for k, term in enumerate(hypothesis.terms))


def _follows_load(hypothesis: Hypothesis) -> bool:
    """Whether the friction of a term follows the torque of the load."""
    return any(isinstance(term.effect, FollowsLoad) for term in hypothesis.terms)


def outer_loads(hypothesis: Hypothesis) -> list[int]:
    """Indices of the terms that may act on the load of a coupling; none without one."""
    if hypothesis.coupling is None:
        return []
    return [index for index, term in enumerate(hypothesis.terms) if isinstance(term.effect, OuterTorque)]


def on_other_side(hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis with its outer loads on the load instead of on the motor, or the other way round."""
    outer = outer_loads(hypothesis)
    onto = None if any(hypothesis.terms[index].load is not None for index in outer) else ()
    return hypothesis.with_terms(
        replace(term, load=onto) if index in outer else term for index, term in enumerate(hypothesis.terms)
    )


def loads_of(hypothesis: Hypothesis) -> tuple[Load, ...]:
    """What acts on the load, as far as its strengths are known."""
    outer = [(term.effect, term.shape, term.load) for term in hypothesis.terms if term.load]
    return tuple((effect, shape, load) for effect, shape, load in outer if isinstance(effect, OuterTorque))


def _with_loads(hypothesis: Hypothesis, theta: Array, owners: NDArray[np.object_]) -> Hypothesis:
    """The hypothesis with the strengths over load inertia that a fit found of what acts on the load."""
    index = hypothesis.coupling
    inertia = 0.0 if index is None else float(theta[owners == index][0])

    def moved(k: int, term: Term) -> Term:
        if term.load is None:
            return term
        return replace(term, load=tuple((theta[owners == k] / inertia).tolist()) if inertia > 0.0 else ())

    return hypothesis.with_terms(moved(k, term) for k, term in enumerate(hypothesis.terms))
