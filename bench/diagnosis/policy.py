"""The policy of naming: every number that decides on a name in one table, and the questions that it answers.

Most of them are one question: is an explanation of some rows better than another? It is if the squares that it saves
are more than chance saves in a search, and more than a share of the squares at stake.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.effects.effect import Contact, Effect, Occasional
from bench.fit.fit import Fit, explained
from bench.fit.solution import NOISE_ALONE

#: Squares of impacts at wrong instants, or waves out of phase, over their own: they err where they are and are not.
ERRS_TWICE = 2.0


def freedom(fitted: Fit) -> int:
    """Numbers that were fitted: strengths and continuous shapes, in whatever way these were searched."""
    return fitted.theta.size + sum(len(term.fitted(fitted.scope)) for term in fitted.terms)


def worth(without: Fit, having: Fit) -> float:
    """Squares that an effect saves, summed over the rows that both fits determine - (N*m)**2 (N**2)."""
    common = without.determined & having.determined
    if common.all():
        return without.squares - having.squares
    return float(np.sum(without.left[common] ** 2) - np.sum(having.left[common] ** 2))


def over_noise(fitted: Fit) -> float:
    """RMS residual over that of white sensor noise in the same balance, which effects damp or amplify - 1."""
    return fitted.rms / fitted.noise.white


@dataclass(frozen=True)
class Policy:
    """All that decides on a name; "above noise" are squares beyond those of the noise floor.

    `python -m tests.studies.blind.thresholds` halves and doubles each number over the blind set (`docs/thresholds.md`).

    Attributes:
        chance: gain over noise power, per fitted number and independent row, that is more than chance in a search over
            some hundred candidates: on axes that lack nothing the best one saves 6 in the median and 116 at most.
        remainder: residual over noise floor above which the residual is not noise.
        large: residual over white noise from which on it is not noise, even if the noise is stronger than it appears.
        finalists: candidates at most whose shapes are searched before they are compared.
        promising: share of what is above noise that a candidate takes at a grid's shape, so that its shape is searched.
        explains: factor on the share of what is above noise that each effect requires of itself.
        patience: factor on the last two shares of a search for many small effects at once.
        nearly_all: share of what is above noise that those may leave together.
        needed: share of what is above noise without it that a name takes in addition to later ones.
        as_good: share of what a name takes that a candidate takes in its place, both at a grid's shape.
        odds: ratio of likelihoods beyond which what is nearly as good is not weighed.
        exchanges: candidates at most whose shapes are searched in the place of a name.
        undoubted: names up to which the search is not repeated from what was nearly as good as the first.
        replaces: share of what is above noise, on determined rows, that an effect takes in the place of others.
        determined: share of rows that such an effect determines; below it the other rows count, too.
        holdout_gap: torque gap of the holdout over that of the recording, noise at least, that a model may leave.
        beside_event: share of the squares that an event takes which may remain around it.
        periods: periods of a contact that an event lasts at least; shorter ones are impacts of the contact.
        left, over, number, outside, none: weights of a probability (`bench.diagnosis.probability`): of the residual
            over that of the bare axis and over noise, of a fitted number, of an effect from outside the catalogue, and
            of what was not tried (`docs/certainty.md`).
        beside: residual over noise floor, as share of that without a name, up to which the name is present together
            with an effect from outside the catalogue.
        most: effects at most; a family of harmonics is one of them.
        members: of a family at most: more waves or events fit anything.
    """

    chance: float = 40.0
    remainder: float = NOISE_ALONE
    large: float = 3.0
    finalists: int = 4
    promising: float = 0.1
    explains: float = 1.0
    patience: float = 0.4
    nearly_all: float = 0.1
    needed: float = 0.02
    as_good: float = 0.9
    odds: float = 100.0
    exchanges: int = 2
    undoubted: int = 2
    replaces: float = 0.5
    determined: float = 0.5
    holdout_gap: float = 3.0
    beside_event: float = 0.25
    periods: float = 10.0
    left: float = 4.0
    over: float = 1.65
    number: float = 1.35
    outside: float = 1.85
    none: float = -1.85
    beside: float = 0.5
    most: int = 12
    members: int = 12

    @property
    def patient(self) -> Policy:
        """Of a search for many small effects at once."""
        return replace(self, explains=self.patience * self.explains, promising=self.patience * self.promising)

    def by_chance(self, fitted: Fit, numbers: int, noise: float | None = None) -> float:
        """Squares that so many numbers save by chance at most, of a fit's noise or of a power in a row - (N*m)**2."""
        return self.chance * numbers * fitted.rows.correlation * (fitted.floor**2 if noise is None else noise)

    def remains(self, fitted: Fit) -> bool:
        """Whether what is left stands clearly above noise."""
        return fitted.chi > self.remainder

    def noise_hides(self, bare: Fit) -> bool:
        """Whether noise of the motion may hide an effect: the residual is near it, and exceeds the effort's."""
        conditioning = bare.rows.conditioning
        of_effort = conditioning.effort_noise * conditioning.filter.noise_gain(0)
        return over_noise(bare) < self.large and bare.noise.white**2 > 2.0 * of_effort**2

    def leaves_room(self, fitted: Fit, effect: Effect) -> bool:
        """Whether an effect that is tried in the place of others may be there still, as more than noise is left.

        Impacts come in bursts that pass for the colour of noise: to parts that meet, all beyond white noise is left.
        """
        return (over_noise(fitted) if isinstance(effect, Contact) else fitted.chi) > self.remainder

    def only_damps(self, before: Fit, after: Fit) -> bool:
        """Whether the squares that `after` saves may be noise of the motion that it damps, as a coupling does."""
        return over_noise(before) < self.large and over_noise(before) <= over_noise(after)

    def promises(self, current: Fit, gain: float) -> bool:
        """Whether a candidate that takes so much at a grid's shape is worth the search of its shape."""
        return gain > max(self.promising * current.excess, self.by_chance(current, 1))

    def least_coloured(self, before: Fit, after: Fit) -> float:
        """Noise floor of `before` by the less coloured of two - N*m (N)."""
        return min(before.floor, after.floor * before.noise.white / after.noise.white)

    def accepts(self, before: Fit, after: Fit) -> bool:
        """Whether the last term of `after` explains its share of what is above noise, significantly and physically.

        The nearest effect explains a part of all. Noise is what the less coloured of the two floors says: an effect
        that never pauses, such as the cogging of a steady speed, passes for coloured noise until it is named. White
        noise is that of the model before: an effect that filters speed or copies torque lowers its own, and what it
        damps of noise it does not explain. It must not only damp.
        """
        if self.only_damps(before, after):
            return False
        noise = self.least_coloured(before, after) ** 2
        excess = before.excess or max(before.squares - before.count * noise, 0.0)
        term = after.terms[-1]
        added = after.theta.size - before.theta.size + len(term.shape)
        share = self.explains * term.effect.needed_share(term.shape, after.scope) * excess
        saves = explained(before, after) > max(share, self.by_chance(before, added, noise))
        return share > 0.0 and saves and self.physical(after)

    def as_simple(self, current: Fit, best: Fit, other: Fit) -> bool:
        """Whether another candidate with fewer numbers saves as much as the best one but for chance."""
        fewer = freedom(best) - freedom(other)
        return fewer > 0 and worth(other, best) <= self.by_chance(current, fewer)

    def physical(self, fitted: Fit) -> bool:
        """Whether every effect keeps within what physics allows: friction resists, masses are positive."""
        return (
            fitted.base.inertia > 0.0
            and all(
                term.effect.physical(fitted.strengths(index), term.shape, fitted.base)
                for index, term in enumerate(fitted.terms)
            )
            and all(_plausible(fitted, effect) for effect in {term.effect for term in fitted.terms})
            and self.outlasts_impacts(fitted)
        )

    def outlasts_impacts(self, fitted: Fit) -> bool:
        """Whether no event is over while an impact of a contact beside it still oscillates."""
        events = [term.effect.duration(term.shape) for term in fitted.terms if isinstance(term.effect, Occasional)]
        contacts = [term.effect.period(term.shape) for term in fitted.terms if isinstance(term.effect, Contact)]
        return min(events, default=np.inf) >= self.periods * max(contacts, default=0.0)

    def needs(self, fitted: Fit, less: Fit, index: int) -> bool:
        """Whether a term, without which `less` is, still saves something beside those that came after it.

        One that may only damp noise does not.
        """
        numbers = max(len(fitted.strengths(index)) + len(fitted.terms[index].shape), 1)
        saves = worth(less, fitted) > max(self.needed * less.excess, self.by_chance(fitted, numbers))
        return saves and not self.only_damps(less, fitted)

    def exchanges_for(self, before: Fit, after: Fit) -> bool:
        """Whether `after`, with another effect in the place of a name, leaves less by more than chance."""
        numbers = max(freedom(after) - freedom(before), 1)
        return worth(before, after) > self.by_chance(before, numbers) and self.physical(after)

    def undecided(self, one: Fit, other: Fit) -> bool:
        """Whether the likelihood of `other`, of independent rows over noise, is within the odds of that of `one`.

        Or it has fewer numbers, and leaves no more for that than the others save by chance.
        """
        fewer = freedom(one) - freedom(other)
        if fewer > 0 and worth(other, one) < self.by_chance(one, fewer):
            return True
        rows = one.count / one.rows.correlation
        return rows * float(np.log(over_noise(other) / over_noise(one))) < np.log(self.odds)

    def stands_beside(self, without: Fit, having: Fit) -> bool:
        """Whether a name takes more than an effect from outside the catalogue, beside which it stands, makes up for."""
        return having.chi < self.beside * without.chi

    def leads(self, before: Fit, after: Fit) -> bool:
        """Whether an effect in the place of others is worth the search for what else is present with it."""
        return self.physical(after) and self._saves(before, after, self.promising)

    def replaces_by(self, before: Fit, after: Fit, without: Fit) -> bool:
        """Whether `after`, with an effect in the place of others, leaves less by a share where it is determined.

        Where it is not, no more than impacts at the wrong instants would, over what `before` leaves there; less by that
        share, too, if that is most. If it leaves nearly nothing of most rows, over the residual `without` those others.
        """
        mostly = float(after.determined.mean()) > self.determined
        reference = without if mostly and self._saves(before, after, 1.0 - self.nearly_all) else before
        left, after_left = (float(np.sum(each[~after.determined] ** 2)) for each in (reference.residual, after.left))
        allowed = ERRS_TWICE if mostly else 1.0 - self.replaces
        saves = self.physical(after) and self._saves(before, after, self.replaces)
        return saves and after_left <= allowed * left and not self.only_damps(before, after)

    def _saves(self, before: Fit, after: Fit, share: float) -> bool:
        """Whether `after` leaves less by a share of what is above noise, on the rows that it determines."""
        left, noise = float(np.sum(before.residual[after.determined] ** 2)), self.least_coloured(before, after) ** 2
        excess = max(left - after.count * noise, 0.0)
        return left - after.squares > max(share * excess, self.by_chance(before, 1, noise))


def _plausible(fitted: Fit, effect: Effect) -> bool:
    """Whether the terms of an effect, several if it is repeatable, are credible together."""
    own = [index for index, term in enumerate(fitted.terms) if term.effect is effect]
    strengths, shapes = [fitted.strengths(index) for index in own], [fitted.terms[index].shape for index in own]
    return effect.plausible(strengths, shapes, fitted.scope)


#: Default policy of naming.
POLICY = Policy()
