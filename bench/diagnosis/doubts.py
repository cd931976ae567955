"""Doubt of the names that a search found: what else speaks against them, though they explain?

The nearest effect of a catalogue explains a part of anything. Each doubt is a function that gives back the fit with
what it leaves of the names; where one takes them all, an unexplained remainder is what there is to say.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnosis.policy import Policy, freedom, worth
from bench.diagnosis.search import Searched, Step, backward_elimination, candidates, refined
from bench.effects.catalogue import simpler_forms
from bench.effects.effect import Contact, Coupling, Effect, Occasional
from bench.effects.rivals import RIVALS
from bench.effects.signals import Signals
from bench.effects.waves import Wave
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows
from bench.trace.filter import Column


@dataclass(frozen=True)
class Evidence:
    """What doubts are asked with.

    Attributes:
        bare: the fit without an effect.
        holdout: another recording; None without one.
        excluded: names that were not to be tried.
        policy: that the names were found by.
    """

    bare: Fit
    holdout: Rows | None
    excluded: frozenset[str]
    policy: Policy

    def rivals(self, fitted: Fit) -> Iterator[Fit]:
        """A fit with each effect from outside the catalogue, the most promising first."""
        outside = [effect for effect in RIVALS if effect.name not in self.excluded]
        return (refined(fitted, found.term) for found in candidates(fitted, outside))


#: A reason not to believe a name: the fit with what it leaves of its names.
Doubt = Callable[[Fit, Evidence], Fit]


def not_credible(fitted: Fit, evidence: Evidence) -> Fit:
    """An effect of a shape that a search may pass but not end with: a coupling that hardly rings."""
    kept = [term for term in fitted.terms if not isinstance(term.effect, Coupling) or term.effect.credible(term.shape)]
    return fitted if len(kept) == len(fitted.terms) else fit(fitted.rows, fitted.hypothesis.with_terms(kept))


def not_in_holdout(fitted: Fit, evidence: Evidence) -> Fit:
    """An event whose absence the holdout does not explain: what it stood for happens there too.

    Unless it happens as an event there, at the same time of that recording.
    """
    quiet = _without(fitted.hypothesis, Occasional)
    if evidence.holdout is None or quiet == fitted.hypothesis:
        return fitted
    there = fit(evidence.holdout, quiet)
    most = evidence.policy.holdout_apart * max(fitted.chi, 1.0)
    for event in fitted.terms:
        if isinstance(event.effect, Occasional) and there.chi > most:
            there = _repeated(there, event, evidence.policy)
    return fitted if there.chi < most else fit(fitted.rows, quiet)


def _repeated(there: Fit, event: Term, policy: Policy) -> Fit:
    """The holdout's fit with the event it shows, if that overlaps the recording's."""
    shown = candidates(there, [event.effect])
    if not shown:
        return there
    again = refined(there, shown[0].term)
    (start, stop), (first, last) = again.terms[-1].shape, event.shape
    shared = min(stop, last) - max(start, first)
    return again if shared > policy.overlap * min(stop - start, last - first) else there


def contested(fitted: Fit, evidence: Evidence) -> Fit:
    """A name that something from outside the catalogue explains better, where a remainder is left.

    A rival that explains more, but of something else, contests nothing: beside it the name keeps its worth.
    """
    policy = evidence.policy
    if not policy.remains(fitted):
        return fitted
    for index in range(len(fitted.terms) - 1, -1, -1):
        less = fit(fitted.rows, fitted.hypothesis.without(index))
        rival = next(evidence.rivals(less), None)
        if rival is None:
            continue
        both = fit(fitted.rows, rival.hypothesis.plus(fitted.terms[index]))
        chance = policy.by_chance(fitted, max(freedom(rival) - freedom(fitted), 1))
        outdone = worth(fitted, rival) > max(policy.contested * fitted.excess, chance)
        if outdone and worth(rival, both) <= policy.keeps * worth(less, fitted):
            fitted = less
    return fitted


def wrong_form(fitted: Fit, evidence: Evidence) -> Fit:
    """A wave of position whose relatives explain most of the remainder: right where it sits, wrong what it is.

    What the unknown contact of a dead zone leaves, in bursts, speaks against no name.
    """
    if any(isinstance(term.effect, Contact) for term in fitted.terms):
        return fitted
    index = len(fitted.terms) - 1
    while index >= 0 and evidence.policy.remains(fitted):
        if _of_wrong_form(fitted, fitted.terms[index], evidence.policy):
            fitted = fit(fitted.rows, fitted.hypothesis.without(index))
            index = len(fitted.terms)
        index -= 1
    return fitted


def _of_wrong_form(fitted: Fit, term: Term, policy: Policy) -> bool:
    number = _wave_number(term)
    if number is None:
        return False
    columns = fitted.seen(lambda s: _relatives(s, number), of_motion=False)
    saved = float(fitted.gains(columns, columns.shape[1])[0])
    left = np.sqrt(max(fitted.chi**2 - saved / (fitted.residual.size * fitted.floor**2), 0.0))
    most = max(policy.wrong_form * fitted.excess, policy.by_chance(fitted, columns.shape[1]))
    return saved > most and bool(left <= policy.relatives_leave)


def two_for_one(fitted: Fit, evidence: Evidence) -> Fit:
    """Two waves of one period where a single wave of another form, in their place, leaves only noise."""
    numbers = [_wave_number(term) for term in fitted.terms]
    for late in range(len(numbers) - 1, -1, -1):
        for early in range(late):
            number = numbers[late]
            if number is None or number != numbers[early]:
                continue
            less = fit(fitted.rows, fitted.hypothesis.without(late).without(early))
            columns = less.seen(lambda s, n=number: _relatives(s, n), of_motion=False)
            saved = float(less.gains(columns, 2).max())
            left = np.sqrt(max(less.squares - saved, 0.0) / less.count) / fitted.floor
            if saved > 0.0 and left <= evidence.policy.one_for_several:
                return two_for_one(less, evidence)
    return fitted


def one_for_many(fitted: Fit, evidence: Evidence) -> Fit:
    """Waves of position in the place of which one thing from outside the catalogue leaves only noise.

    A series of harmonics draws any bump at one angle; where a single rival with fewer numbers does, there is no series.
    What is not needed beside the rival goes with the waves.
    """
    plain = _without(fitted.hypothesis, Wave)
    if len(fitted.terms) - len(plain.terms) < 2:
        return fitted
    less = fit(fitted.rows, plain)
    fewer = [rival for rival in evidence.rivals(less) if freedom(rival) < freedom(fitted)]
    rival = min(fewer, key=lambda found: found.squares, default=less)
    if worth(less, rival) <= 0.0 or rival.chi > evidence.policy.one_for_several:
        return fitted
    needed = backward_elimination(rival, evidence.policy).terms
    return fit(fitted.rows, plain.with_terms(term for term in plain.terms if any(map(term.same, needed))))


def simpler(fitted: Fit, evidence: Evidence) -> Fit:
    """An effect of which a simpler form explains as much: friction differs by a constant only, which is an offset."""
    for index, term in enumerate(fitted.terms):
        for form in simpler_forms(term.effect, fitted.scope):
            plain = fit(fitted.rows, fitted.hypothesis.with_term(index, Term(form)))
            if worth(plain, fitted) <= evidence.policy.by_chance(fitted, 1):
                return simpler(plain, evidence)
    return fitted


def unbelievable(fitted: Fit, evidence: Evidence) -> Fit:
    """Names beside which so much is left that they are likelier the nearest than the right ones; events soonest."""
    if fitted.chi < evidence.policy.large:
        return fitted
    contact = any(isinstance(term.effect, Contact) for term in fitted.terms)
    most = evidence.policy.believable_contact if contact else evidence.policy.believable
    if fitted.excess > most * evidence.bare.excess:
        return evidence.bare
    events = [index for index, term in enumerate(fitted.terms) if isinstance(term.effect, Occasional)]
    return fit(fitted.rows, fitted.hypothesis.without(events[0])) if events else fitted


#: All doubts, in the order in which they are raised.
DOUBTS: tuple[Doubt, ...] = (
    not_credible,
    not_in_holdout,
    contested,
    wrong_form,
    two_for_one,
    one_for_many,
    simpler,
    unbelievable,
)


def doubted(searched: Searched, evidence: Evidence, doubts: Sequence[Doubt] = DOUBTS) -> Searched:
    """Steps of a search with what doubts, raised one after the other, leave of the last one's names."""
    fitted = searched.last
    for doubt in doubts:
        fitted = doubt(fitted, evidence) if fitted.terms else fitted
    if [term.key for term in fitted.terms] == [term.key for term in searched.last.terms]:
        return searched
    steps = searched.steps
    kept = (*steps[:-1], Step(fitted, steps[-1].rivals)) if fitted.terms else steps[:1]
    return replace(searched, steps=kept)


def _without(hypothesis: Hypothesis, kind: type[Effect]) -> Hypothesis:
    """A hypothesis less its effects of a kind."""
    return hypothesis.with_terms(term for term in hypothesis.terms if not isinstance(term.effect, kind))


def _wave_number(term: Term) -> float | None:
    return term.effect.wave_number(term.shape) if isinstance(term.effect, Wave) else None


def _relatives(s: Signals, number: float) -> list[Column]:
    """Waves of position times whatever a torque may hang on: nothing, omega**2, its direction, torque, acceleration."""
    factors = (np.ones_like(s.position), 0), (s.velocity**2, 0), (s.sign, 0), (s.torque, 0), (s.velocity, 1)
    waves = np.sin(number * s.position), np.cos(number * s.position)
    return [[(factor * wave, order)] for factor, order in factors for wave in waves]
