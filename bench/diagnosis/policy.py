"""The policy of naming: the numbers that decide on names, the questions that they answer, and reasons for answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from bench.effects.effect import Contact, Effect, Occasional
from bench.fit.fit import Fit, least_squares
from bench.fit.hypothesis import LINKS, MISPLACED
from bench.fit.rows import slope_of
from bench.fit.solution import NOISE_ALONE
from bench.parameter import Parameter

#: A mistimed impact, or a wave out of phase, costs its squares twice: where it is missing, and where it is predicted.
ERRS_TWICE = 2.0
#: Periods of a contact after which the oscillation that an impact causes has decayed, at a tenth of critical damping.
DECAYED = 10.0


@dataclass(frozen=True)
class Reason:
    """A criterion that decided, with its figures by name; `bench.report.verdict` puts it into words."""

    criterion: str
    figures: Mapping[str, str | float | Parameter] = field(default_factory=dict)


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
    """All numbers that decide on a name.

    `python -m tests.studies.blind.thresholds` halves and doubles each of them (`docs/thresholds.md`).

    Attributes:
        chance: reduction of the squared residual, over noise power, per fitted number and independent row, above which
            an effect is more than chance. On axes that lack nothing, the best of some hundred candidates reaches 6 in
            the median and 116 at most.
        remainder: residual over noise floor above which the residual is not noise.
        large: residual over white noise above which the residual is not noise, whatever the estimate of the noise
            floor.
        holdout_gap: torque gap of the holdout over that of the recording (or over noise, if that is larger) above which
            the model is not confirmed.
        remaining: weight of the residual above noise, relative to the bare axis. It acts like a number of independent
            rows, and is small because other effects of a real axis correlate the rows. All weights are fitted
            (`docs/certainty.md`).
        over: weight of the residual above noise, relative to noise.
        number: weight of a fitted number.
        outside: weight of an unknown effect.
        none: weight of effects that were not tried.
        with_unknown: an effect is named together with an unknown one only if it reduces the residual over the noise
            floor to this share or less.
    """

    chance: float = 40.0
    remainder: float = NOISE_ALONE
    large: float = 3.0
    holdout_gap: float = 3.0
    remaining: float = 4.0
    over: float = 1.65
    number: float = 1.35
    outside: float = 1.85
    none: float = -1.85
    with_unknown: float = 0.5

    def by_chance(self, fitted: Fit, numbers: int = 1) -> float:
        """Squares that so many numbers save by chance at most - (N*m)**2 (N**2)."""
        return self.chance * numbers * fitted.rows.correlation * fitted.floor**2

    def remains(self, fitted: Fit) -> bool:
        """Whether the residual is clearly above noise."""
        return fitted.chi > self.remainder

    def noise_hides(self, bare: Fit) -> bool:
        """Whether noise of the motion may hide an effect: the residual is near it, and exceeds the effort's."""
        conditioning = bare.rows.conditioning
        of_effort = conditioning.effort_noise * conditioning.filter.noise_gain(0)
        return over_noise(bare) < self.large and bare.noise.white**2 > 2.0 * of_effort**2

    def leaves_room(self, fitted: Fit, effect: Effect) -> bool:
        """Whether an effect that replaces others may be present still, as more than noise remains.

        Impacts come in bursts that pass for the colour of noise: for parts that meet, all beyond white noise remains.
        """
        return (over_noise(fitted) if isinstance(effect, Contact) else fitted.chi) > self.remainder

    def only_damps(self, before: Fit, after: Fit) -> bool:
        """Whether the squares that `after` saves may be noise of the motion that it damps, as a coupling does.

        They may where the residual is as large relative to that noise, or what is saved beyond it may be chance.
        """
        if over_noise(before) >= self.large:
            return False
        damped = before.count * (before.noise.white**2 - after.noise.white**2)
        chance = self.by_chance(before, max(freedom(after) - freedom(before), 1))
        return over_noise(before) <= over_noise(after) or worth(before, after) - damped < chance

    def only_misplaces(self, fitted: Fit) -> bool:
        """Whether an effect takes no more than the weight of links that are a little off their encoder."""
        slope = fitted.rows.kept(slope_of) if fitted.rows.stretches[0].signals.known else np.empty(0)
        if not slope.any():  # no links, or none whose torque depends on where they are
            return False
        least = self.chance * fitted.rows.correlation * fitted.noise.white**2
        for index in range(len(fitted.terms)):
            own = fitted.owners == index
            others = np.hstack([fitted.columns[:, ~own & (fitted.owners != LINKS)], slope])
            torque = fitted.columns[:, own] @ fitted.theta[own]
            moved = least_squares(others, torque, np.zeros((others.shape[1],) * 2))
            alike = abs(moved[-1]) < MISPLACED and float(np.sum((torque - others @ moved) ** 2)) < least
            if own.any() and alike:
                return True
        return False

    def physical(self, fitted: Fit) -> bool:
        """Whether every effect keeps within what physics allows: friction resists, masses are positive."""
        return (
            fitted.base.inertia > 0.0
            and all(
                term.effect.physical(fitted.strengths(index), term.shape, fitted.base)
                for index, term in enumerate(fitted.terms)
            )
            and all(_plausible(fitted, effect) for effect in {term.effect for term in fitted.terms})
            and outlasts_impacts(fitted)
        )

    def last_is_physical(self, fitted: Fit) -> bool:
        """Whether the last effect keeps within what physics allows, whatever the others do."""
        term, strengths = fitted.terms[-1], fitted.strengths(len(fitted.terms) - 1)
        return fitted.base.inertia > 0.0 and term.effect.physical(strengths, term.shape, fitted.base)

    def replaceable(self, fitted: Fit, other: Fit) -> bool:
        """Whether the numbers that another fit has fewer, one at least, explain no more than chance."""
        numbers = max(freedom(fitted) - freedom(other), 1)
        return worth(other, fitted) < self.by_chance(fitted, numbers) and self.physical(other)

    def event_shows(self, fitted: Fit, numbers: int, saved: float, left: float) -> bool:
        """Whether an event saves more than chance, and enough of its stretch of time for its numbers.

        It is found next to a remainder, so its score has the weight of an unknown effect, too.
        """
        score = self.remaining * float(np.log1p(saved / max(left, 1e-300))) - self.number * numbers - self.outside
        return saved > self.by_chance(fitted, numbers) and score > 0.0


def outlasts_impacts(fitted: Fit) -> bool:
    """Whether no event is over while an impact of a contact in the same axis still oscillates."""
    events = [term.effect.duration(term.shape) for term in fitted.terms if isinstance(term.effect, Occasional)]
    contacts = [term.effect.period(term.shape) for term in fitted.terms if isinstance(term.effect, Contact)]
    return min(events, default=np.inf) >= DECAYED * max(contacts, default=0.0)


def _plausible(fitted: Fit, effect: Effect) -> bool:
    """Whether the terms of an effect, several if it is repeatable, are credible together."""
    own = [index for index, term in enumerate(fitted.terms) if term.effect is effect]
    strengths, shapes = [fitted.strengths(index) for index in own], [fitted.terms[index].shape for index in own]
    return effect.plausible(strengths, shapes, fitted.scope)


#: Default policy of naming.
POLICY = Policy()
