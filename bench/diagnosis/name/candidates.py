"""Every effect tried beside a fit: how much of what is left would it take?"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from bench.effects.effect import Effect
from bench.fit.fit import Fit
from bench.fit.hypothesis import Term


@dataclass(frozen=True)
class Candidate:
    """An effect tried.

    Attributes:
        term: effect and shape.
        gain: sum of squares it would take from the residual - (N*m)**2 (N**2).
    """

    term: Term
    gain: float


def candidates(current: Fit, effects: Iterable[Effect]) -> list[Candidate]:
    """The best shape of every effect that may come beside what is fitted, best first."""
    found = []
    for effect in effects:
        if not effect.sought(current.scope) or not current.hypothesis.admits(effect):
            continue
        tried = [Candidate(Term(effect, proposal.shape), proposal.gain) for proposal in effect.propose(current)]
        tried = [candidate for candidate in tried if not any(candidate.term.same(term) for term in current.terms)]
        if tried:
            found.append(max(tried, key=lambda candidate: candidate.gain))
    return sorted(found, key=lambda candidate: -candidate.gain)
