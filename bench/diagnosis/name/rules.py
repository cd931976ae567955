"""Rules of the search for names, in the order in which they are asked; the list of them below reads as the policy.

Every rule is one object that says why it is there; its threshold stands beside the measurement behind it. Halved and
doubled over the blind set, one after the other, the thresholds give the table that
`python -m tests.studies.blind.thresholds` writes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bench.diagnosis.name.candidates import Candidate
from bench.effects.effect import Effect
from bench.fit.fit import Fit, explained
from bench.fit.shapes import free_shapes


def freedom(fitted: Fit) -> int:
    """Numbers that were fitted: strengths and continuous shapes."""
    return fitted.theta.size + sum(len(free_shapes(term, fitted.scope)) for term in fitted.terms)


def worth(without: Fit, having: Fit) -> float:
    """Squares that an effect saves, summed over rows - (N*m)**2 (N**2)."""
    return without.squares - having.squares


#: Residual over white noise above which it is not noise, even if noise is louder than the signals show: encoders that
#: interpolate with an error left 1.1 to 4 without a coupling, a servo's gear behind a coarse speed 6.4 to 7.8.
LOUD = 3.0


def over_noise(fitted: Fit) -> float:
    """RMS residual over that of white sensor noise in the same balance, which effects damp or amplify - 1."""
    return fitted.rms / fitted.noise.white


def only_damps(before: Fit, after: Fit) -> bool:
    """Whether the squares that `after` saves may be noise of the motion that it damps, as a coupling does."""
    return over_noise(before) < LOUD and over_noise(before) <= over_noise(after)


@dataclass(frozen=True)
class Promising:
    """A candidate is worth the search of its shape if it is significant even at a grid's shape and takes enough.

    Attributes:
        share: of what stands above the noise floor: less than any effect needs, as the grid is coarse.
        finalists: candidates at most whose shapes are searched before they are compared.
    """

    share: float = 0.1
    finalists: int = 4

    def of(self, current: Fit, tried: list[Candidate], significant: Significant) -> list[Candidate]:
        """Those of the candidates."""
        least = max(significant.threshold(current, 1), self.share * current.excess)
        return [candidate for candidate in tried if candidate.gain > least][: self.finalists]


@dataclass(frozen=True)
class Exchangeable:
    """A candidate is worth the search of its shape in the place of a name if even at a grid's shape it takes as much.

    Attributes:
        share: of what the name takes.
        finalists: candidates at most whose shapes are searched.
    """

    share: float = 0.9
    finalists: int = 2

    def of(self, less: Fit, tried: list[Candidate], taken: float) -> list[Candidate]:
        """Those of the candidates beside `less`, the fit without the name, which took so much - (N*m)**2 (N**2)."""
        return [candidate for candidate in tried if candidate.gain > self.share * taken][: self.finalists]


@dataclass(frozen=True)
class Significant:
    """An effect must save more squares than chance does in a search over some hundred candidates.

    Attributes:
        least: gain over noise power, per number fitted and independent row. Of 100 nulls the best candidate saves
            6 in the middle and 116 at most per number of its shape (`python -m tests.studies.blind.margins`).
    """

    least: float = 40.0

    def threshold(self, fitted: Fit, numbers: int, noise: float | None = None) -> float:
        """Squares that so many numbers must save - (N*m)**2 (N**2).

        Args:
            fitted: whose noise it is.
            numbers: that are added.
            noise: its power in a row instead - (N*m)**2 (N**2).
        """
        return self.least * numbers * fitted.rows.correlation * (fitted.floor**2 if noise is None else noise)


@dataclass(frozen=True)
class Explains:
    """An effect must explain its share of what stands above the noise floor: the nearest one explains a part of all.

    Noise is what the less coloured of the two floors says: an effect that never pauses, such as the cogging of a steady
    speed, passes for coloured noise until it is named. White noise is that of the model before: an effect that filters
    speed or copies torque lowers its own, and what it damps of noise it does not explain. It must not only damp.

    Attributes:
        of_needed: factor on the share that each effect states as needed of itself.
    """

    of_needed: float = 1.0

    def holds(self, before: Fit, after: Fit, significant: Significant) -> bool:
        """Whether the last term of `after` explains enough, significantly."""
        if only_damps(before, after):
            return False
        saved = explained(before, after)
        noise = min(before.floor, after.floor * before.noise.white / after.noise.white) ** 2
        excess = before.excess or max(before.squares - before.count * noise, 0.0)
        term = after.terms[-1]
        added = after.theta.size - before.theta.size + len(term.shape)
        share = self.of_needed * term.effect.needed_share(term.shape, after.scope)
        return saved > significant.threshold(before, added, noise) and 0.0 < share * excess < saved


@dataclass(frozen=True)
class Physical:
    """Every effect keeps within what physics allows: friction resists, masses are positive, shapes are credible."""

    def holds(self, fitted: Fit) -> bool:
        """Whether all terms do."""
        if fitted.base.inertia <= 0.0:
            return False
        for index, term in enumerate(fitted.terms):
            if not term.effect.physical(fitted.strengths(index), term.shape, fitted.base):
                return False
        return all(self._plausible(effect, fitted) for effect in {term.effect for term in fitted.terms})

    @staticmethod
    def _plausible(effect: Effect, fitted: Fit) -> bool:
        own = [index for index, term in enumerate(fitted.terms) if term.effect is effect]
        strengths, shapes = [fitted.strengths(index) for index in own], [fitted.terms[index].shape for index in own]
        return effect.plausible(strengths, shapes, fitted.scope)


@dataclass(frozen=True)
class NoLongerNeeded:
    """An effect is let go that saves hardly anything beside those that came after it (backward elimination).

    So is one that may only damp noise.

    Attributes:
        share: of what is above the noise floor without it.
    """

    share: float = 0.02

    def holds(self, fitted: Fit, less: Fit, index: int, significant: Significant) -> bool:
        """Whether the term at an index, without which `less` is, may go."""
        lost = worth(less, fitted)
        own = max(len(fitted.strengths(index)) + len(fitted.terms[index].shape), 1)
        if only_damps(less, fitted):
            return True
        return lost < significant.threshold(fitted, own) or lost < self.share * less.excess


@dataclass(frozen=True)
class ReplacesClearly:
    """An effect that is tried in the place of others must leave clearly less, and no more where it is not told.

    Attributes:
        share: of what stands above the noise floor, on the rows that are determined.
        determined: share of rows whose torque the recording determines beside it, at least.
    """

    share: float = 0.5
    determined: float = 0.5

    def holds(self, before: Fit, after: Fit) -> bool:
        """Whether `after`, with its last term in the place of others, may take the place of `before`."""
        index = len(after.terms) - 1
        if not after.terms[index].effect.physical(after.strengths(index), after.terms[index].shape, after.base):
            return False
        left = float(np.sum(before.residual[after.determined] ** 2))
        excess = left - after.count * before.floor**2
        clearly = left - after.squares > self.share * max(excess, 0.0)
        whole = float(np.sum(after.left**2)) < before.squares
        enough = float(after.determined.mean()) > self.determined
        return clearly and whole and enough and not only_damps(before, after)


@dataclass(frozen=True)
class Remainder:
    """What is left stands clearly above noise, which ends in the verdict that something is unexplained.

    Attributes:
        chi: residual over noise floor. Nulls of the blind set leave 1.095 at 95 %, 1.40 at most
            (`python -m tests.studies.blind.margins`).
    """

    chi: float = 1.12

    def holds(self, fitted: Fit) -> bool:
        """Whether it does."""
        return fitted.chi > self.chi


@dataclass(frozen=True)
class Rules:
    """What a search goes by: how names are taken up and let go, and when something is left.

    Attributes:
        promising, significant, explains, physical: what takes a name up.
        exchangeable: what is tried in the place of another name.
        no_longer_needed: what lets go of one.
        replaces: what puts one in the place of others.
        remainder: what is left unexplained.
        most: effects at most; a family of harmonics is one of them.
        members: of a family at most: more waves or events draw anything.
    """

    promising: Promising = field(default_factory=Promising)
    significant: Significant = field(default_factory=Significant)
    explains: Explains = field(default_factory=Explains)
    physical: Physical = field(default_factory=Physical)
    exchangeable: Exchangeable = field(default_factory=Exchangeable)
    no_longer_needed: NoLongerNeeded = field(default_factory=NoLongerNeeded)
    replaces: ReplacesClearly = field(default_factory=ReplacesClearly)
    remainder: Remainder = field(default_factory=Remainder)
    most: int = 12
    members: int = 12
