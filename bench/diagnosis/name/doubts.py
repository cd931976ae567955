"""Doubt of the names that a search found: what else speaks against them, though they explain?

The nearest effect of a catalogue explains a part of anything. Each doubt gives back the fit with what it leaves of the
names; where one takes them all, an unexplained remainder is what there is to say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from bench.arrays import Array
from bench.diagnosis.name.candidates import candidates
from bench.diagnosis.name.rules import Rules, freedom, worth
from bench.diagnosis.name.search import Searched, Step, backward_elimination, refined
from bench.effects.catalogue import catalogue, rivals
from bench.effects.effect import Effect
from bench.effects.signals import Signals
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Term
from bench.fit.rows import Rows
from bench.trace.filter import Column


@dataclass(frozen=True)
class Evidence:
    """What doubts are asked with.

    Attributes:
        bare: the fit without an effect.
        holdout: another recording; None without one.
        excluded: names that were not to be tried.
        rules: that the names were found by.
    """

    bare: Fit
    holdout: Rows | None
    excluded: frozenset[str]
    rules: Rules

    def rivals(self) -> list[Effect]:
        """Effects from outside the catalogue."""
        return [effect for effect in rivals() if effect.name not in self.excluded]


class Doubt(Protocol):
    """A reason not to believe a name."""

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """The fit with what this doubt leaves of its names."""
        ...


@dataclass(frozen=True)
class NotInHoldout:
    """An event whose absence the holdout does not explain: what it stood for happens there too.

    Unless it happens as an event there, at the same time of that recording.

    Attributes:
        apart: how much further above its noise the holdout may stand than the recording.
    """

    apart: float = 1.25

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """Without events that are not borne out."""
        events = [term for term in fitted.terms if term.effect.occasional]
        if evidence.holdout is None or not events:
            return fitted
        quiet = fitted.hypothesis.with_terms(term for term in fitted.terms if not term.effect.occasional)
        there = fit(evidence.holdout, quiet)
        least = self.apart * max(fitted.chi, 1.0)
        for event in events:
            if there.chi > least:
                there = self._repeated(there, event)
        return fitted if there.chi < least else fit(fitted.rows, quiet)

    def _repeated(self, there: Fit, event: Term) -> Fit:
        """The holdout's fit with the event it shows, if that overlaps the recording's by half."""
        shown = candidates(there, [event.effect])
        if not shown:
            return there
        again = refined(there, shown[0].term)
        (start, stop), (first, last) = again.terms[-1].shape, event.shape
        shared = min(stop, last) - max(start, first)
        return again if shared > 0.5 * min(stop - start, last - first) else there


@dataclass(frozen=True)
class NotCredible:
    """An effect of a shape that a search may pass but not end with: a coupling that hardly rings."""

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """Without the terms that are not credible."""
        kept = [term for term in fitted.terms if term.effect.credible(term.shape)]
        return fitted if len(kept) == len(fitted.terms) else fit(fitted.rows, fitted.hypothesis.with_terms(kept))


@dataclass(frozen=True)
class Contested:
    """A name that something from outside the catalogue explains better, where a remainder is left.

    A rival that explains more, but of something else, contests nothing: beside it the name keeps its worth.

    Attributes:
        more: share of what stands above the noise floor that the rival must explain beyond the name.
        kept: share of its worth that a name keeps beside a rival that takes nothing of it.
    """

    more: float = 0.25
    kept: float = 0.5

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """Without the names that are contested."""
        if not evidence.rules.remainder.holds(fitted):
            return fitted
        for index in range(len(fitted.terms) - 1, -1, -1):
            less = fit(fitted.rows, fitted.hypothesis.without(index))
            found = candidates(less, evidence.rivals())
            if not found:
                continue
            rival = refined(less, found[0].term)
            beside = fit(fitted.rows, rival.hypothesis.plus(fitted.terms[index]))
            outdone = self._outdone(fitted, rival, evidence.rules)
            if outdone and worth(rival, beside) < self.kept * worth(less, fitted):
                fitted = less
        return fitted

    def _outdone(self, fitted: Fit, rival: Fit, rules: Rules) -> bool:
        """Whether a rival with a quantity or two more explains clearly more."""
        added = max(freedom(rival) - freedom(fitted), 1)
        return worth(fitted, rival) > max(self.more * fitted.excess, rules.significant.threshold(fitted, added))


@dataclass(frozen=True)
class WrongForm:
    """A wave of position whose relatives explain most of the remainder: right where it sits, wrong what it is.

    What the unknown contact of a dead zone leaves, in bursts, speaks against no name.

    Attributes:
        share: of the remainder that relatives explain only if the name is of the wrong form.
        noise: residual over noise floor that they then leave. Eccentricity under another name left 0.8 to 1.1, gravity
            of a pendulum on a gear 2.1.
    """

    share: float = 0.5
    noise: float = 1.25

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """Without the names of the wrong form."""
        if any(term.effect.bursts for term in fitted.terms):
            return fitted
        index = len(fitted.terms) - 1
        while index >= 0 and evidence.rules.remainder.holds(fitted):
            if self._wrong(fitted, fitted.terms[index], evidence.rules):
                fitted = fit(fitted.rows, fitted.hypothesis.without(index))
                index = len(fitted.terms)
            index -= 1
        return fitted

    def _wrong(self, fitted: Fit, term: Term, rules: Rules) -> bool:
        number = term.effect.wave_number(term.shape)
        if number is None:
            return False
        columns = fitted.seen(lambda s: _waves(s, number), of_motion=False)
        saved = float(fitted.gains(columns, columns.shape[1])[0])
        certain = rules.significant.threshold(fitted, columns.shape[1])
        left = (fitted.chi * fitted.floor) ** 2 - saved / fitted.residual.size
        return saved > max(self.share * fitted.excess, certain) and left < (self.noise * fitted.floor) ** 2


@dataclass(frozen=True)
class TwoForOne:
    """Two waves of one period where a single wave of another form, in their place, leaves only noise."""

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """Without both of them."""
        numbers = [term.effect.wave_number(term.shape) for term in fitted.terms]
        waves = [index for index, number in enumerate(numbers) if number is not None]
        pairs = [(late, early) for late in reversed(waves) for early in waves if early < late]
        for late, early in pairs:
            number = numbers[late]
            if number is None or number != numbers[early]:
                continue
            less = fit(fitted.rows, fitted.hypothesis.without(late).without(early))
            columns = less.seen(lambda s, n=number: _waves(s, n), of_motion=False)
            half = columns.shape[1] // 2
            order = np.stack([np.arange(half), half + np.arange(half)], axis=1).ravel()
            left = less.squares - float(less.gains(columns[:, order], 2).max())
            if left < less.count * (evidence.rules.remainder.chi * fitted.floor) ** 2:
                return self.left(less, evidence)
        return fitted


@dataclass(frozen=True)
class OneForMany:
    """Waves of position in the place of which one thing from outside the catalogue leaves only noise.

    A series of harmonics draws any bump at one angle; where a single rival with fewer numbers does, there is no series.
    """

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """Without the waves, and without what is not needed beside the rival."""
        kept = [term for term in fitted.terms if term.effect.wave_number(term.shape) is None]
        if len(fitted.terms) - len(kept) < 2:
            return fitted
        less = fit(fitted.rows, fitted.hypothesis.with_terms(kept))
        tried = [refined(less, found.term) for found in candidates(less, evidence.rivals())]
        spared = [rival for rival in tried if freedom(rival) < freedom(fitted)]
        if not spared:
            return fitted
        rival = min(spared, key=lambda found: found.squares)
        if evidence.rules.remainder.holds(rival):
            return fitted
        needed = backward_elimination(rival, evidence.rules).terms
        return fit(fitted.rows, fitted.hypothesis.with_terms(term for term in kept if any(map(term.same, needed))))


@dataclass(frozen=True)
class Simpler:
    """An effect of which a simpler form explains as much: friction differs by a constant only, which is an offset."""

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """With the simpler form in its place."""
        for index, term in enumerate(fitted.terms):
            for name in term.effect.simpler_forms():
                plain = fit(fitted.rows, fitted.hypothesis.with_term(index, Term(catalogue()[name])))
                if worth(plain, fitted) < evidence.rules.significant.threshold(fitted, 1):
                    return self.left(plain, evidence)
        return fitted


@dataclass(frozen=True)
class Unbelievable:
    """Names beside which so much is left that they are likelier the nearest than the right ones; events soonest.

    Attributes:
        large: residual over noise floor from which a remainder is large.
        share: of what stood above the floor without names that may be left beside them, unless one `tolerates` more.
    """

    large: float = 3.0
    share: float = 0.2

    def left(self, fitted: Fit, evidence: Evidence) -> Fit:
        """Without any name, or without an event."""
        if fitted.chi < self.large:
            return fitted
        bearable = max([self.share, *(term.effect.tolerates or 0.0 for term in fitted.terms)])
        if fitted.excess > bearable * evidence.bare.excess:
            return evidence.bare
        events = [index for index, term in enumerate(fitted.terms) if term.effect.occasional]
        return fit(fitted.rows, fitted.hypothesis.without(events[0])) if events else fitted


#: All doubts, in the order in which they are raised.
DOUBTS: tuple[Doubt, ...] = (
    NotCredible(),
    NotInHoldout(),
    Contested(),
    WrongForm(),
    TwoForOne(),
    OneForMany(),
    Simpler(),
    Unbelievable(),
)


def doubted(searched: Searched, evidence: Evidence, doubts: Sequence[Doubt]) -> Searched:
    """Steps of a search with what doubts, raised one after the other, leave of the last one's names."""
    fitted = searched.last
    for doubt in doubts:
        fitted = doubt.left(fitted, evidence) if fitted.terms else fitted
    if [term.key for term in fitted.terms] == [term.key for term in searched.last.terms]:
        return searched
    steps = searched.steps
    kept = (*steps[:-1], Step(fitted, steps[-1].rivals)) if fitted.terms else steps[:1]
    return replace(searched, steps=kept)


def _waves(s: Signals, number: float) -> list[Column]:
    """Waves of position times whatever a torque may hang on: nothing, omega**2, its direction, torque, acceleration."""
    columns: list[Column] = []
    waves: tuple[Array, Array] = np.sin(number * s.position), np.cos(number * s.position)
    for wave in waves:
        columns += [[(factor * wave, 0)] for factor in (np.ones_like(wave), s.velocity**2, s.sign, s.torque)]
        columns.append([(s.velocity * wave, 1)])
    return columns
