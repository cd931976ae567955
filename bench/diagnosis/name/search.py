"""Forward selection: try every effect, keep what explains, polish it, let go of what a later one explains.

Stop, accept and "unexplained" are tests against the noise floor of the recording itself (chi = 1 where only noise is
left), so a recording in which nothing is hidden ends without a name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from bench.diagnosis.name.candidates import Candidate, candidates
from bench.diagnosis.name.rules import Rules, freedom, worth
from bench.effects.effect import Effect
from bench.fit.fit import Fit, fit
from bench.fit.hum import with_hum
from bench.fit.hypothesis import Term
from bench.fit.load_side import on_other_side, outer_loads
from bench.fit.shapes import shaped, together

#: Said of a search that its limit ended.
LIMIT = "limit of effects reached"


@dataclass(frozen=True)
class Step:
    """An effect taken up: its hypothesis fitted, and the candidates it was chosen from, best first."""

    fitted: Fit
    rivals: tuple[Candidate, ...] = ()


@dataclass(frozen=True)
class Searched:
    """Steps of a search.

    Attributes:
        steps: the first without an effect.
        stopped: what ended it before it was done; None if nothing did.
        ended: the fit to which nothing more was added, and what was tried beside it; None without a search.
    """

    steps: tuple[Step, ...]
    stopped: str | None = None
    ended: Step | None = None

    @property
    def last(self) -> Fit:
        """With all effects."""
        return self.steps[-1].fitted


def search(bare: Fit, effects: Sequence[Effect], rules: Rules) -> Searched:
    """Effects in the order in which they are taken up.

    Args:
        bare: the fit without an effect.
        effects: to be tried.
        rules: that decide.
    """
    found = forward_selection(Searched((Step(bare),)), effects, rules)
    for _ in range(rules.most):  # each leaves less, so it ends before; what is let go in between could turn it round
        better = exchanged(found.last, effects, rules)
        if better is None:
            break
        found = forward_selection(Searched((*found.steps, Step(better))), effects, rules)
    if rules.remainder.holds(found.last):
        for effect in effects:
            replaced = replacement(found.last, effect, rules) if effect.replaces else None
            if replaced is not None:
                steps = found.steps[:-1] if len(found.steps) > 1 else found.steps
                found = forward_selection(Searched((*steps, Step(replaced))), effects, rules)
    return found


def forward_selection(found: Searched, effects: Sequence[Effect], rules: Rules) -> Searched:
    """Steps with effects added until none is worthwhile, or the limit is reached."""
    steps = found.steps
    while True:
        current = steps[-1].fitted
        tried = candidates(current, effects)
        finalists = [
            refined(current, candidate.term) for candidate in rules.promising.of(current, tried, rules.significant)
        ]
        better = [after for after in finalists if _worthwhile(current, after, rules)]
        if not better:
            return Searched(steps, ended=Step(current, tuple(tried)))
        best = min(better, key=lambda after: after.squares)
        names = Counter(best.hypothesis.names)
        if len(names) > rules.most or max(names.values()) > rules.members:
            return Searched(steps, LIMIT, Step(current, tuple(tried)))
        chosen = with_hum(backward_elimination(on_its_side(polished(best, rules), rules), rules))
        if _repeats_a_step(chosen, steps, rules):
            return Searched(steps, ended=Step(current, tuple(tried)))
        steps = (*steps, Step(chosen, tuple(tried)))


def _repeats_a_step(fitted: Fit, steps: Sequence[Step], rules: Rules) -> bool:
    """Whether an earlier step had the same effects and left no more: what is taken up and let go in turn never ends."""
    least = rules.significant.threshold(fitted, 1)
    names = Counter(fitted.hypothesis.names)
    same = [step.fitted for step in steps if Counter(step.fitted.hypothesis.names) == names]
    return any(worth(earlier, fitted) <= least for earlier in same)


def _worthwhile(current: Fit, after: Fit, rules: Rules) -> bool:
    return rules.explains.holds(current, after, rules.significant) and rules.physical.holds(after)


def exchanged(fitted: Fit, effects: Sequence[Effect], rules: Rules) -> Fit | None:
    """The hypothesis with an earlier name exchanged for one that leaves less by more than chance; else None.

    What was nearest when nothing stood beside it need not be so among the others (sequential replacement: A. J. Miller,
    Journal of the Royal Statistical Society A 147, 1984, 389-425).
    """
    found = []
    for index, term in enumerate(fitted.terms[:-1]):
        less = fit(fitted.rows, fitted.hypothesis.without(index))
        others = [effect for effect in effects if effect is not term.effect]
        for candidate in rules.exchangeable.of(less, candidates(less, others), worth(less, fitted)):
            after = refined(less, candidate.term)
            numbers = max(freedom(after) - freedom(fitted), 1)
            if rules.physical.holds(after) and worth(fitted, after) > rules.significant.threshold(fitted, numbers):
                found.append(after)
    if not found:
        return None
    return with_hum(backward_elimination(polished(min(found, key=lambda after: after.squares), rules), rules))


def replacement(fitted: Fit, effect: Effect, rules: Rules) -> Fit | None:
    """The hypothesis with an effect in the place of those it replaces, if that explains clearly more."""
    kept = [term for term in fitted.terms if term.effect.name not in effect.replaces]
    current = fit(fitted.rows, fitted.hypothesis.with_terms(kept))
    shape = effect.in_place_of(current) if current.hypothesis.admits(effect) else None
    if shape is None:
        return None
    first = fit(fitted.rows, current.hypothesis.plus(Term(effect, shape)))
    after = shaped(first.rows, first.hypothesis, len(current.terms))  # from where levels and loads have settled
    return backward_elimination(after, rules) if rules.replaces.holds(fitted, after) else None


def refined(current: Fit, term: Term) -> Fit:
    """A term added, its shape searched around where the grid found it."""
    return shaped(current.rows, current.hypothesis.plus(term), len(current.terms))


def polished(fitted: Fit, rules: Rules) -> Fit:
    """Every term's shape searched again beside the others, then all of them at once."""
    if len(fitted.terms) < 2:
        return fitted
    for index in range(len(fitted.terms)):
        tried = shaped(fitted.rows, fitted.hypothesis, index)
        fitted = tried if rules.physical.holds(tried) else fitted
    tried = together(fitted)
    return tried if rules.physical.holds(tried) else fitted


def on_its_side(fitted: Fit, rules: Rules) -> Fit:
    """With outer loads on the side of a coupling, motor or load, on which they explain more, if much is left."""
    if not rules.remainder.holds(fitted) or not outer_loads(fitted.hypothesis) or fitted.hypothesis.coupling is None:
        return fitted
    moved = shaped(fitted.rows, on_other_side(fitted.hypothesis), fitted.hypothesis.coupling)
    return min(fitted, moved, key=lambda found: found.squares)


def backward_elimination(fitted: Fit, rules: Rules) -> Fit:
    """Without the terms that no longer explain anything beside the later ones."""
    for index in range(len(fitted.terms) - 1, -1, -1):
        if len(fitted.terms) < 2:
            break
        less = fit(fitted.rows, fitted.hypothesis.without(index))
        if rules.no_longer_needed.holds(fitted, less, index, rules.significant):
            fitted = less
    return fitted
