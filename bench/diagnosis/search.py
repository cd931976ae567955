"""Forward selection: try every effect, keep what explains, polish it, let go of what a later one explains.

Stop, accept and "unexplained" are tests against the noise floor of the recording itself (chi = 1 where only noise is
left), so a recording in which nothing is hidden ends without a name. The rules are `bench.diagnosis.policy`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from bench.diagnosis.policy import Policy, worth
from bench.effects.effect import Effect
from bench.fit.fit import Fit, fit, shaped, together
from bench.fit.hum import with_hum
from bench.fit.hypothesis import Term, on_other_side, outer_loads
from bench.fit.rows import Rows

#: Said of a search that its limit ended.
LIMIT = "limit of effects reached"
#: Times at most that an effect in the place of others and what is beside it are searched in turn.
TURNS = 3


@dataclass(frozen=True)
class Candidate:
    """An effect tried.

    Attributes:
        term: effect and shape.
        gain: sum of squares it would take from the residual - (N*m)**2 (N**2).
    """

    term: Term
    gain: float


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
        less: that fit without each of its terms, the shapes of the others settled; () of one term or none.
        instead: that fit with one of its earlier names exchanged for what was nearly as good.
    """

    steps: tuple[Step, ...]
    stopped: str | None = None
    ended: Step | None = None
    less: tuple[Fit, ...] = ()
    instead: tuple[Fit, ...] = ()

    @property
    def last(self) -> Fit:
        """With all effects."""
        return self.steps[-1].fitted

    def ending(self, fitted: Fit) -> Searched:
        """The same with another fit in the place of the last one; without steps where that has no effect."""
        if [term.key for term in fitted.terms] == [term.key for term in self.last.terms]:
            return self
        last = Step(fitted, self.steps[-1].rivals)
        return replace(self, steps=(*self.steps[:-1], last) if fitted.terms else self.steps[:1])

    def through(self, rows: Rows) -> Searched:
        """The same with the last fit anew, to rows through another filter."""
        last = Step(fit(rows, self.last.hypothesis), self.steps[-1].rivals)
        return replace(self, steps=(*self.steps[:-1], last))


def search(bare: Fit, effects: Sequence[Effect], policy: Policy) -> Searched:
    """Effects in the order in which they are taken up beside the fit without one."""
    found = from_rivals(selected(Searched((Step(bare),)), effects, policy), effects, policy)
    for effect in (each for each in effects if each.replaces):
        if policy.leaves_room(found.last, effect):
            found = replacement(found, effect, effects, policy) or found
    if policy.remains(found.last) and found.stopped is None:
        # many small effects take little each and nearly all together; where they do not, each may be anything
        further = selected(found, effects, policy.patient)
        found = further if further.last.excess < policy.nearly_all * found.last.excess else found
    return found


def selected(found: Searched, effects: Sequence[Effect], policy: Policy) -> Searched:
    """Steps with effects added from the last one on, and names exchanged for others, until neither leaves less."""
    found = forward_selection(found, effects, policy)
    for _ in range(policy.most):  # each leaves less, so it ends before; what is let go in between could turn it round
        instead = instead_of_each(found.last, effects, policy)
        better = exchanged(found.last, instead, policy)
        if better is None:
            return replace(found, instead=tuple(instead))
        found = forward_selection(Searched((*found.steps, Step(better))), effects, policy)
    return found


def from_rivals(found: Searched, effects: Sequence[Effect], policy: Policy) -> Searched:
    """The search, or that from what was nearly as good as its first name, if that leaves less.

    Later names adapt their shapes to a wrong first one.
    """
    if len(set(found.last.hypothesis.names)) <= policy.undoubted:
        return found
    bare, first = found.steps[0].fitted, found.steps[1]
    least = policy.as_good * first.rivals[0].gain
    others = [
        each for each in first.rivals if each.gain > least and each.term.effect is not first.fitted.terms[0].effect
    ]
    for rival in others[: policy.exchanges]:
        start = refined(bare, rival.term)
        if policy.accepts(bare, start):
            other = selected(Searched((*found.steps[:1], Step(start))), effects, policy)
            found = other if policy.exchanges_for(found.last, other.last) else found
    return found


def forward_selection(found: Searched, effects: Sequence[Effect], policy: Policy) -> Searched:
    """Steps with effects added until none is worthwhile, or the limit is reached."""
    steps, ended = found.steps, found.ended
    while True:
        current = steps[-1].fitted
        tried = ended.rivals if ended is not None and ended.fitted is current else candidates(current, effects)
        promising = [candidate for candidate in tried if policy.promises(current, candidate.gain)]
        finalists = [refined(current, candidate.term) for candidate in promising[: policy.finalists]]
        finalists = [physical_form(after, effects, policy) for after in finalists]
        better = [after for after in finalists if policy.accepts(current, after)]
        if not better:
            fewer, less = settled_elimination(current, policy)
            if fewer is current:
                return Searched(steps, ended=Step(current, tuple(tried)), less=less)
            steps = (*steps, Step(fewer, tuple(tried)))
            continue
        best = min(better, key=lambda after: after.squares)
        simpler = [after for after in better if policy.as_simple(current, best, after)]
        best = min(simpler, key=lambda after: after.squares, default=best)
        names = Counter(best.hypothesis.names)
        if len(names) > policy.most or max(names.values()) > policy.members:
            return Searched(steps, LIMIT, Step(current, tuple(tried)))
        chosen = with_hum(backward_elimination(on_its_side(polished(best, policy), policy), policy))
        if _repeats_a_step(chosen, steps, policy):
            return Searched(steps, ended=Step(current, tuple(tried)))
        steps = (*steps, Step(chosen, tuple(tried)))


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


def refined(current: Fit, term: Term) -> Fit:
    """A term added, its shape searched around where the grid found it."""
    return shaped(current.rows, current.hypothesis.plus(term), len(current.terms))


def physical_form(fitted: Fit, effects: Sequence[Effect], policy: Policy) -> Fit:
    """With an earlier name in a form that no recording distinguishes, where only that is physical with the last one."""
    if policy.physical(fitted):
        return fitted
    for index, term in enumerate(fitted.terms[:-1]):
        alike = term.effect.ambiguous(fitted.scope)
        for effect in (each for each in effects if each.name in alike and len(each.shapes) == len(term.shape)):
            tried = fit(fitted.rows, fitted.hypothesis.with_term(index, Term(effect, term.shape)))
            if policy.physical(tried):
                return tried
    return fitted


def polished(fitted: Fit, policy: Policy) -> Fit:
    """Every term's shape searched again beside the others, then all of them at once."""
    if len(fitted.terms) < 2:
        return fitted
    for index in range(len(fitted.terms)):
        tried = shaped(fitted.rows, fitted.hypothesis, index)
        fitted = tried if policy.physical(tried) else fitted
    tried = together(fitted)
    return tried if policy.physical(tried) else fitted


def on_its_side(fitted: Fit, policy: Policy) -> Fit:
    """With outer loads on the side of a coupling, motor or load, on which they explain more, if much is left."""
    if not policy.remains(fitted) or not outer_loads(fitted.hypothesis) or fitted.hypothesis.coupling is None:
        return fitted
    moved = shaped(fitted.rows, on_other_side(fitted.hypothesis), fitted.hypothesis.coupling)
    return min(fitted, moved, key=lambda found: found.squares)


def backward_elimination(fitted: Fit, policy: Policy) -> Fit:
    """Without the terms that no longer explain anything beside the later ones; then the shapes of the others settle."""
    for index in range(len(fitted.terms) - 1, -1, -1):
        if len(fitted.terms) < 2:
            break
        less = fit(fitted.rows, fitted.hypothesis.without(index))
        if not policy.needs(fitted, less, index):
            fitted = settled(less, policy)
    return fitted


def settled_elimination(fitted: Fit, policy: Policy) -> tuple[Fit, tuple[Fit, ...]]:
    """The same where the others settle before it is decided; and the fits against which terms were kept."""
    kept: list[Fit] = []
    for index in range(len(fitted.terms) - 1, -1, -1):
        if len(fitted.terms) < 2:
            break
        less = settled(fit(fitted.rows, fitted.hypothesis.without(index)), policy)
        if policy.needs(fitted, less, index):
            kept.insert(0, less)
        else:
            fitted = less
    return fitted, tuple(kept)


def settled(less: Fit, policy: Policy) -> Fit:
    """Without a term, the shapes of the others where they are without it.

    What no catalogue holds stays as it was searched: further off its shape makes up for anything.
    """
    if any(term.effect.decoy for term in less.terms):
        return less
    tried = together(less)
    return tried if policy.physical(tried) else less


def _repeats_a_step(fitted: Fit, steps: Sequence[Step], policy: Policy) -> bool:
    """Whether an earlier step had the same effects and left no more: what is taken up and let go in turn never ends."""
    names = Counter(fitted.hypothesis.names)
    same = [step.fitted for step in steps if Counter(step.fitted.hypothesis.names) == names]
    return any(worth(earlier, fitted) <= policy.by_chance(fitted, 1) for earlier in same)


def instead_of_each(fitted: Fit, effects: Sequence[Effect], policy: Policy) -> list[Fit]:
    """The hypothesis with each of its earlier names exchanged for what saves nearly as much in its place.

    Sequential replacement: A. J. Miller, Journal of the Royal Statistical Society A 147, 1984, 389-425.
    """
    instead = []
    for index, term in enumerate(fitted.terms[:-1]):
        less = fit(fitted.rows, fitted.hypothesis.without(index))
        tried = candidates(less, effects)
        own = [candidate.gain for candidate in tried if candidate.term.effect is term.effect]
        least = policy.as_good * min([worth(less, fitted), *own])  # like with like: its own at a grid's shape, too
        as_good = [each for each in tried if each.gain > least and each.term.effect is not term.effect]
        instead += [refined(less, candidate.term) for candidate in as_good[: policy.exchanges]]
    return instead


def exchanged(fitted: Fit, instead: Sequence[Fit], policy: Policy) -> Fit | None:
    """The one of these hypotheses that leaves least, if that is less by more than chance; else None."""
    found = [after for after in instead if policy.exchanges_for(fitted, after)]
    if not found:
        return None
    return with_hum(backward_elimination(polished(min(found, key=lambda after: after.squares), policy), policy))


def replacement(found: Searched, effect: Effect, effects: Sequence[Effect], policy: Policy) -> Searched | None:
    """Steps with an effect in the place of those it replaces, if that explains clearly more.

    Beside an effect that is hidden still a dead zone bends its shape to that. So it and the others are searched in turn
    (backfitting: A. Buja, T. Hastie, R. Tibshirani, Annals of Statistics 17, 1989, 453-510).
    """
    last, earlier = found.last, found.steps[:-1] or found.steps
    beside = [term for term in last.terms if term.effect.name not in effect.replaces]
    current = without = fit(last.rows, last.hypothesis.with_terms(beside))
    replaced, shape = None, None
    for _ in range(TURNS):
        placed = in_place(current, effect, shape, effects, policy)
        if placed is None or not policy.leads(current, placed):
            break
        replaced = selected(Searched((*earlier, Step(backward_elimination(placed, policy)))), effects, policy)
        others = [term for term in replaced.last.terms if term.effect is not effect]
        if Counter(term.effect for term in others) == Counter(term.effect for term in beside):
            break
        beside = others
        current = fit(last.rows, last.hypothesis.with_terms(beside))
        left = [] if policy.remains(replaced.last) else replaced.last.terms  # bent to what was hidden still
        shape = next((term.shape for term in left if term.effect is effect), None)
    return replaced if replaced is not None and policy.replaces_by(last, replaced.last, without) else None


def in_place(
    current: Fit, effect: Effect, shape: tuple[float, ...] | None, effects: Sequence[Effect], policy: Policy
) -> Fit | None:
    """A fit with an effect whose shape is searched beside it, from one or anywhere; None where none may explain."""
    beside = current.hypothesis
    if not beside.admits(effect):
        return None
    shape = shape or effect.in_place_of(current, partial(policy.promises, current))
    if shape is None:
        return None
    first = fit(current.rows, beside.plus(Term(effect, shape)))
    after = shaped(current.rows, first.hypothesis, len(beside.terms))  # from where levels and loads have settled
    return physical_form(after, effects, policy)
