"""A hypothesis: which effects there are and of what shape, and what is in the recording beside them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from bench.effects.effect import Coupling, Effect, Lag, Repeatable


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
    """

    effect: Effect
    shape: tuple[float, ...] = ()
    level: tuple[float, ...] = ()
    load: tuple[float, ...] | None = None
    pull: tuple[float, ...] = ()

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
