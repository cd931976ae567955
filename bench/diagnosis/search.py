"""One local search over sets of effects, which the score that weighs them in the end drives.

The score is the logarithm of a probability (`bench.diagnosis.probability`). From the most likely set of effects that
was not yet expanded, the search tries every effect in addition, the set without each of its effects, and every effect
in the place of each. Effects are ranked by the squares that their columns take from the residual, all of a grid's
shapes at once; shapes are searched for the few best of them. The search is best first and passes LOOKAHEAD sets that do
not raise the score. Where more than noise remains then, two further moves are tried: an effect that replaces others,
and a chain of many small effects, which take little each and most of the residual together. Decoys
(`bench.effects.rivals`) are tried like any other effect; a set with one is not expanded.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnosis.policy import Policy, worth
from bench.diagnosis.probability import Contender, Key, key_of, weighed
from bench.effects.catalogue import simpler_forms
from bench.effects.effect import Effect
from bench.effects.rivals import GAINS, RIVALS, WAVES
from bench.effects.waves import Wave
from bench.fit.fit import Fit, fit, shaped, together
from bench.fit.hum import with_hum
from bench.fit.hypothesis import Term, on_other_side, outer_loads

#: Note on a search that its limit ended.
LIMIT = "limit of effects reached"
#: Terms of a set at most: more waves or events fit anything.
MOST = 12
#: Effects whose shapes are searched in addition to a set, in the place of one of its effects, or as next of a chain.
WIDTH = 3
#: Sets expanded without a higher score before the search ends, if more than noise remains: some pairs need two steps.
LOOKAHEAD = 2
#: Residual above noise at a grid's shape, over that of the best effect or noise, beyond which no shape is searched.
SCREEN = 4.0
#: Score below the best one from which on a set is as good as impossible.
NEGLIGIBLE = 30.0
#: Most likely sets with an effect whose shape was fitted to what was hidden, in which the shape is searched again.
AGAIN = 2


#: An effect of a shape, and the sum of squares that it would take from the residual - (N*m)**2 (N**2).
Candidate = tuple[Term, float]


class Search:
    """A search, and the fits that it visited, the best one of each set of effects.

    Attributes:
        last: the most likely set without a decoy.
        stopped: what ended the search before it was done; None if nothing did.
        refused: why an effect that was fitted was not visited, by effect: the criterion of a `Reason`.
    """

    def __init__(self, bare: Fit, effects: Sequence[Effect], policy: Policy, known: Iterable[Fit] = ()) -> None:
        self.effects, self.policy, self.last = effects, policy, bare
        self.stopped: str | None = None
        self.refused: dict[Effect, str] = {}
        kept = (one for one in known if all(term.effect.decoy or term.effect in effects for term in one.terms))
        self.fits: dict[Key, Fit] = {key_of(fitted): fitted for fitted in (bare, *kept)}
        self.tried: dict[Key, tuple[Candidate, ...]] = {}
        self.grown: set[Key] = set()
        self.expanded: dict[Key, None] = {}
        self.further: set[Key] = set()
        self.settled: set[Key] = set()
        self.weighed: dict[Key, Contender] = {}

    def run(self, most: int) -> None:
        """Visit sets around the most likely one until none is likelier."""
        best, waits = self.last, 0
        while True:
            # the shape of what replaces others is fitted to an effect that is still hidden: it is searched again
            replacing = any(term.effect.replaces for term in best.terms)
            following = self.next() if waits <= (LOOKAHEAD if self.remains(best) and not replacing else 0) else None
            if following is not None and len(following.terms) < most:
                self.expand(following)
            elif following is not None:
                self.expanded[key_of(following)] = None
                self.stopped = LIMIT if following is best else self.stopped
            elif not self.try_further(best, most):
                break
            found = self.best()
            # sets that were found far from the most likely one are expanded, too
            waits = 0 if following is None or key_of(found) != key_of(best) else waits + 1
            best = found
        self.add_decoy_waves(best)
        self.last, self.stopped = best, self.stopped if self.remains(best) else None

    @property
    def visited(self) -> tuple[Fit, ...]:
        """All fits that are possible, the first without an effect."""
        scores, bare = self.scores(), next(iter(self.fits.values()))
        least = max(scores.values()) - NEGLIGIBLE
        likely = [self.fits[key] for key, score in scores.items() if score > least and self.fits[key] is not bare]
        return bare, *likely

    @property
    def shares(self) -> dict[Key, dict[Effect, float]]:
        """Share of the squared residual of each set that was expanded which each effect would take, in order."""
        tried = {key: self.tried[key] for key in self.expanded if key in self.tried}
        wholes = {key: max(self.fits[key].squares, 1e-300) for key in tried}
        return {key: {term.effect: max(0.0, gain) / wholes[key] for term, gain in of} for key, of in tried.items()}

    def add(self, fitted: Fit) -> Fit:
        """Keep a fit that is physical; returns the best one of its effects."""
        key = key_of(fitted)
        possible = self.policy.physical(fitted) and not self.policy.only_misplaces(fitted)
        if possible and (key not in self.fits or fitted.squares < self.fits[key].squares):
            self.fits[key] = fitted
            self.tried.pop(key, None)
            self.weighed = {}
        return self.fits.get(key, fitted)

    def contenders(self) -> dict[Key, Contender]:
        """What speaks for each set that was visited and may be a result."""
        if not self.weighed:
            found = weighed([*self.fits.values()], None, self.policy)
            self.weighed = {key_of(each.fitted): each for each in found}
        return self.weighed

    def scores(self) -> dict[Key, float]:
        """Logarithm of the probability of each set that may be a result, up to a constant."""
        return {key: each.score(self.policy) for key, each in self.contenders().items()}

    def remains(self, fitted: Fit) -> bool:
        """Whether more than noise remains: of its own colour, which what it lacks may raise, or of the best set's."""
        contender = self.contenders().get(key_of(fitted))
        return self.policy.remains(fitted) or (contender is not None and contender.remains(self.policy))

    def named(self) -> list[Key]:
        """Those without a decoy, the most likely first."""
        scores = {key: score for key, score in self.scores().items() if not any(each.decoy for each, _ in key)}
        return sorted(scores, key=lambda key: -scores[key])

    def best(self) -> Fit:
        """The most likely one without a decoy."""
        return self.fits[self.named()[0]]

    def next(self) -> Fit | None:
        """The most likely one that was not expanded, its shapes settled."""
        key = next((key for key in self.named() if key not in self.expanded), None)
        if key is None:
            return None
        return self.add(with_hum(on_its_side(self.settle(self.fits[key]), self.policy)))

    def expand(self, current: Fit) -> None:
        """Visit what a move away is: an effect more, one less, or another in its place."""
        self.expanded[key_of(current)] = None
        self.grow(current)
        for index, term in enumerate(current.terms):
            self.grow(self.without(current, [index]))
            for form in simpler_forms(term.effect, current.scope):
                if form in self.effects and current.hypothesis.without(index).admits(form):
                    self.add(fit(current.rows, current.hypothesis.with_term(index, Term(form)), current))

    def without(self, current: Fit, indices: Sequence[int]) -> Fit:
        """The fit without some terms, the shapes of the others settled."""
        kept = [term for index, term in enumerate(current.terms) if index not in indices]
        less = fit(current.rows, current.hypothesis.with_terms(kept), current)
        known = self.fits.get(key_of(less))
        if known is not None and (len(kept) < 2 or key_of(less) in self.settled):
            return known  # the shape of one alone was searched as it was found
        return self.add(self.settle(min(known or less, less, key=lambda each: each.squares)))

    def settle(self, fitted: Fit) -> Fit:
        """With the shapes of all terms searched at once."""
        self.settled.add(key_of(fitted))
        return settled(fitted, self.policy)

    def candidates(self, fitted: Fit) -> tuple[Candidate, ...]:
        """What may be added to a fit, best first; once for each set of effects."""
        key = key_of(fitted)
        if key not in self.tried:
            decoys = RIVALS if self.remains(fitted) else GAINS if fitted.depends else ()
            self.tried[key] = (*candidates(fitted, [*self.effects, *decoys]),)
        return self.tried[key]

    def grow(self, fitted: Fit) -> None:
        """Visit the fit with each of the few best effects added, and with the best decoy."""
        key = key_of(fitted)
        if key in self.grown or key not in self.fits:
            return
        self.grown.add(key)
        tried = [each for each in self.candidates(fitted) if each[1] > self.policy.by_chance(fitted)]
        least = self.add_best(fitted, (each for each in tried if not each[0].effect.decoy), WIDTH, math.inf)
        self.add_best(fitted, (each for each in tried if each[0].effect.decoy), 1, least)

    def add_best(self, fitted: Fit, tried: Iterable[Candidate], width: int, least: float) -> float:
        """Visit the fit with each of the few best candidates whose residual is not much above the least.

        Returns the least residual above noise of the possible ones, at a grid's shape - (N*m)**2 (N**2).
        """
        noise = fitted.count * fitted.floor**2
        for term, gain in tried:
            rest = max(fitted.squares - gain - noise, 0.0)
            if width == 0 or rest > SCREEN * least:
                break
            if self.added(fitted, term) is not None:  # what is impossible takes no other effect's place
                least, width = min(least, max(rest, noise)), width - 1
        return least

    def added(self, fitted: Fit, term: Term, together: bool = False) -> Fit | None:
        """The fit with a candidate of searched shape; None if impossible, or no more than damped noise.

        `together`: where the candidate is possible and another effect no longer is, all shapes are searched, as those
        that were found without it are not those next to it; what remains impossible was in the candidate's place.
        """
        effect, known = term.effect, self.fits.get(key_of(fitted, term.effect))
        if known is not None and not effect.repeatable:
            return known
        after = shaped(fitted, fitted.hypothesis.plus(term), len(fitted.terms))
        after = physical_form(after, self.effects, self.policy)
        if together and not self.policy.physical(after) and self.policy.last_is_physical(after):
            after = without_impossible(settled(after, self.policy), self.policy)
        if not self.policy.physical(after):
            self.refused[effect] = "impossible"
            return None
        if len(after.terms) <= len(fitted.terms):
            fitted = fit(after.rows, after.hypothesis.without(len(after.terms) - 1), after)
        if self.policy.only_damps(fitted, after):
            self.refused[effect] = "damps"
        elif worth(fitted, after) < effect.needed * fitted.excess:
            self.refused[effect] = "small"
        elif self.policy.only_misplaces(after):
            self.refused[effect] = "misplaced"
        else:
            return self.add(after)
        return None

    def try_further(self, best: Fit, most: int) -> bool:
        """Visit sets beyond one move: an effect in place of those it replaces, and many small ones; whether any is new.

        The shape of an effect that replaces others is searched once with each set; first with none, as what is found
        without it may be bent to it, too.
        """
        before, bare = (len(self.fits), best.squares), next(iter(self.fits.values()))
        for effect in (each for each in self.effects if each.replaces and self.policy.leaves_room(best, each)):
            names = {effect.name, *effect.replaces}
            self.put_in_place(bare, effect)
            others = [k for k, term in enumerate(best.terms) if term.effect.name in names]
            self.put_in_place(self.without(best, others), effect)
        if key_of(best) not in self.further and self.remains(best):
            self.further.add(key_of(best))
            self.add_many(best, most)
        return (len(self.fits), self.best().squares) != before

    def put_in_place(self, less: Fit, effect: Effect) -> None:
        """Visit the fit with an effect whose shape is searched in its own way, and what is a move away from that.

        The shape is bent to what is still hidden: next to each of the most likely of these it is searched again.
        """
        after = self.search_in_place(less, effect)
        if after is None:
            return
        size = len(key_of(after)) + 1
        one_more = [key for key in self.named() if (effect, 1) in key and key_of(less) < key and len(key) == size]
        for fitted in [self.fits[key] for key in one_more[:AGAIN]]:
            if self.policy.leaves_room(fitted, effect):
                own = [k for k, term in enumerate(fitted.terms) if term.effect is effect]
                self.search_in_place(self.without(fitted, own), effect)

    def search_in_place(self, less: Fit, effect: Effect) -> Fit | None:
        """The fit with it, expanded if it takes its part; None if it does not, or was searched with this set before."""
        if key_of(less, effect) in self.further or not less.hypothesis.admits(effect):
            return None
        self.further.add(key_of(less, effect))
        shape = effect.in_place_of(less, lambda gain: gain > self.part(less))
        if shape is None:
            return None
        first = fit(less.rows, less.hypothesis.plus(Term(effect, shape)), less)
        after = shaped(first, first.hypothesis, len(less.terms))  # from where levels and loads have settled
        after = physical_form(after, self.effects, self.policy)
        if self.policy.only_damps(less, after) or not self.policy.physical(after):
            return None
        self.add(after)
        if worth(less, after) <= self.part(less, after.determined):
            return None
        self.expand(self.fits[key_of(after)])  # what else is present may be most of the residual still
        return after

    def part(self, fitted: Fit, among: NDArray[np.bool_] | None = None) -> float:
        """Squares that each of as many effects as there may be takes on average of a residual - (N*m)**2 (N**2).

        More than chance in any case; `among`: of the residual of these rows alone (m,).
        """
        whole = fitted.excess
        if among is not None and not among.all():
            common = among & fitted.determined
            whole = float(np.sum(fitted.left[common] ** 2)) - np.count_nonzero(common) * fitted.floor**2
        return max(whole / MOST, self.policy.by_chance(fitted))

    def add_many(self, fitted: Fit | None, most: int) -> None:
        """Visit a chain of effects each of which takes its part of the residual above noise, no set of them twice."""
        sets = set[Key]()
        while fitted is not None and self.remains(fitted) and len(fitted.terms) < most:
            least, known = self.part(fitted), [each for each in self.candidates(fitted) if not each[0].effect.decoy]
            tried = (self.added(fitted, term, together=True) for term, gain in known[:WIDTH] if gain > least)
            fitted = next((after for after in tried if after is not None and key_of(after) not in sets), None)
            if fitted is not None:
                sets.add(key_of(fitted))

    def add_decoy_waves(self, best: Fit) -> None:
        """Visit a wave of any form in the place of those of one number, and a decoy in the place of all waves."""
        numbers = {
            index: term.effect.wave_number(term.shape)
            for index, term in enumerate(best.terms)
            if isinstance(term.effect, Wave)
        }
        if len(numbers) > 1:
            self.grow(self.without(best, [*numbers]))
        for number in sorted(set(numbers.values())):
            alike = [index for index, own in numbers.items() if own == number]
            kept = best.hypothesis.with_terms(term for k, term in enumerate(best.terms) if k not in alike)
            for decoy in WAVES if len(alike) > 1 else WAVES[:1] if self.remains(best) else ():
                self.add(fit(best.rows, kept.plus(Term(decoy, (number,))), best))


def search(bare: Fit, effects: Sequence[Effect], policy: Policy, most: int = MOST, known: Sequence[Fit] = ()) -> Search:
    """Sets of so many effects at most, of those to be tried, around the most likely one.

    `known`: fits of an earlier search from the same one without an effect; those of other effects are left out.
    """
    found = Search(bare, effects, policy, known)
    found.run(most)
    return found


def candidates(current: Fit, effects: Iterable[Effect]) -> list[Candidate]:
    """The best shape of every effect that may be added to a fit, best first."""
    found = list[Candidate]()
    for effect in effects:
        if not effect.sought(current.scope) or not current.hypothesis.admits(effect):
            continue
        tried = [(Term(effect, each.shape), each.gain) for each in effect.propose(current)]
        tried = [(term, gain) for term, gain in tried if not any(term.same(other) for other in current.terms)]
        if tried:
            found.append(max(tried, key=lambda candidate: candidate[1]))
    return sorted(found, key=lambda candidate: -candidate[1])


def physical_form(fitted: Fit, effects: Sequence[Effect], policy: Policy) -> Fit:
    """With an earlier effect in a form that no recording distinguishes, where only that is physical with the last."""
    if policy.physical(fitted):
        return fitted
    for index, term in enumerate(fitted.terms[:-1]):
        alike = term.effect.ambiguous(fitted.scope)
        for effect in (each for each in effects if each.name in alike and len(each.shapes) == len(term.shape)):
            tried = fit(fitted.rows, fitted.hypothesis.with_term(index, Term(effect, term.shape)), fitted)
            if policy.physical(tried):
                return tried
    return fitted


def without_impossible(fitted: Fit, policy: Policy) -> Fit:
    """Less the effects, the last one aside, that are impossible next to the others."""
    kept = [
        term
        for k, term in enumerate(fitted.terms)
        if k == len(fitted.terms) - 1 or term.effect.physical(fitted.strengths(k), term.shape, fitted.base)
    ]
    less = fit(fitted.rows, fitted.hypothesis.with_terms(kept), fitted) if len(kept) < len(fitted.terms) else fitted
    return less if policy.physical(less) else fitted


def on_its_side(fitted: Fit, policy: Policy) -> Fit:
    """With outer loads on the side of a coupling, motor or load, on which they explain more, if a residual remains."""
    if not policy.remains(fitted) or not outer_loads(fitted.hypothesis) or fitted.hypothesis.coupling is None:
        return fitted
    moved = shaped(fitted, on_other_side(fitted.hypothesis), fitted.hypothesis.coupling)
    return min(fitted, moved, key=lambda found: found.squares)


def settled(fitted: Fit, policy: Policy) -> Fit:
    """The shapes of all terms searched at once; those of a decoy stay, as further off they make up for anything."""
    if any(term.effect.decoy for term in fitted.terms):
        return fitted
    tried = together(fitted)
    return tried if policy.physical(tried) else fitted
