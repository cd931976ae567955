"""How likely each set of names is, and that none of the catalogue's is right.

    ln P = -left*max(U, LEAST) - over*min(V, MUCH) - each*names - number*numbers - event*events*min(V, MUCH) + constant

U, V - logarithms of what a set leaves beyond noise, over what the bare axis leaves and over noise; numbers - fitted
(`bench.diagnosis.score`). What holds an effect from outside the catalogue weighs `outside` less; the names beside it
stand. "None of the catalogue" is such an effect, and what was not tried, of a constant weight. The weights, of
`bench.diagnosis.policy`, are those under which recordings whose truth is known were likeliest
(`python -m tests.studies.certainty`). The likelihood of the recording itself adds nothing to U and V: its weight beside
them came out as zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from bench.diagnosis.policy import Policy
from bench.diagnosis.score import Contender
from bench.effects.effect import Effect
from bench.effects.rivals import Outside
from bench.effects.signals import Scope
from bench.fit.fit import Fit

#: Least of U: what is left is no longer told from noise.
LEAST = -9.0
#: Largest V that counts: real axes leave more than noise whatever is named.
MUCH = 3.0
#: How often a name that the signals show directly was right there.
DETECTED = 0.98
#: Where the weights come from.
CALIBRATED_ON = "docs/certainty.md"


@dataclass(frozen=True)
class NameSet:
    """A set of names with its probability.

    Attributes:
        names: of effects of the catalogue.
        beyond: whether something acts beside that no catalogue holds.
        probability: of the set.
    """

    names: frozenset[str]
    beyond: bool
    probability: float


@dataclass(frozen=True)
class Probabilities:
    """How likely each set of names is.

    Attributes:
        sets: of names of the torque balance, likeliest first; the empty one says that it lacks nothing, or nothing of
            the catalogue.
        untried: probability of what is not among them.
        detected: names that the signals show directly.
        fits: the likeliest with names, as long as they are searched; what is told of them keeps none.
    """

    sets: tuple[NameSet, ...]
    untried: float
    detected: frozenset[str] = frozenset()
    fits: Mapping[frozenset[str], Fit] = field(default_factory=dict)

    @cached_property
    def names(self) -> dict[str, float]:
        """Probability of every name that was considered, whatever acts beside, likeliest first."""
        every = {name for each in self.sets for name in each.names}
        found = {name: sum(each.probability for each in self.sets if name in each.names) for name in every}
        found |= dict.fromkeys(self.detected, DETECTED)
        return dict(sorted(found.items(), key=lambda one: (-one[1], one[0])))

    @property
    def none(self) -> float:
        """Probability that something acts that none of the catalogue is, whatever acts beside."""
        return self.untried + sum(each.probability for each in self.sets if each.beyond)

    @property
    def nothing(self) -> float:
        """Probability that nothing is missing."""
        bare = sum(each.probability for each in self.sets if not each.names and not each.beyond)
        return bare * (1.0 - DETECTED) if self.detected else bare

    @property
    def chosen(self) -> NameSet:
        """The likeliest set of names each of which is likelier than not."""
        believed = {name for name, probability in self.names.items() if probability > 0.5}
        return next(each for each in self.sets if each.names <= believed)

    def instead_of(self, name: str) -> dict[str | None, float]:
        """What stands in the place of a chosen name in the sets without it; None: none of the catalogue."""
        without = [each for each in self.sets if name not in each.names]
        found: dict[str | None, float] = {None: self.untried + sum(e.probability for e in without if e.beyond)}
        for each in without:
            for other in each.names - self.chosen.names:
                found[other] = found.get(other, 0.0) + each.probability
        return dict(sorted(found.items(), key=lambda one: -one[1]))

    def holding(self, level: float) -> list[frozenset[str | None]]:
        """The fewest sets that hold the truth with a probability of at least `level`; None: what no catalogue holds."""
        shares: dict[frozenset[str | None], float] = {frozenset({None}): self.untried}
        for each in self.sets:
            names = each.names | self.detected | ({None} if each.beyond else frozenset())
            shares[names] = shares.get(names, 0.0) + each.probability
        ranked = sorted(shares.items(), key=lambda one: -one[1])
        before = np.cumsum([0.0, *(share for _, share in ranked)])[:-1]
        return [names for (names, _), sure in zip(ranked, before, strict=True) if sure < level]

    def without(self, names: frozenset[str]) -> Probabilities:
        """Given that some names are wrong: what held-out motion spoke against."""
        kept = [each for each in self.sets if not each.names & names]
        whole = self.untried + sum(each.probability for each in kept)
        sets = (replace(each, probability=each.probability / whole) for each in kept)
        return Probabilities(tuple(sets), self.untried / whole, self.detected - names)


def probabilities(scored: Sequence[Contender], detected: frozenset[str], policy: Policy) -> Probabilities:
    """Of hypotheses beside each other, the first of them the bare axis, and of names that the signals show directly."""
    logs = [_log(each, policy) for each in scored]
    weights = np.exp(np.array([*logs, policy.none]) - max(*logs, policy.none))
    shares = (weights / weights.sum()).tolist()
    called: dict[str, str] = {}
    shared: dict[tuple[frozenset[str], bool], float] = {}
    fits: dict[frozenset[str], Fit] = {}
    for each, share in sorted(zip(scored, shares, strict=False), key=lambda one: -one[1]):
        effects = [term.effect for term in each.fitted.terms if not isinstance(term.effect, Outside)]
        names = frozenset(_called(effect, each.fitted.scope, called) for effect in effects)
        fits.setdefault(names, each.fitted)
        shared[names, each.outside] = shared.get((names, each.outside), 0.0) + share
    ranked = sorted((NameSet(*key, share) for key, share in shared.items()), key=lambda one: -one.probability)
    return Probabilities(tuple(ranked), shares[-1], detected, fits)


def _log(one: Contender, policy: Policy) -> float:
    """Logarithm of a hypothesis' weight."""
    over = min(one.over, MUCH)
    return (
        -policy.left * max(one.left, LEAST)
        - (policy.over + policy.event * one.events) * over
        - policy.each * len(set(one.fitted.hypothesis.names))  # all harmonics of a wave are one effect
        - policy.number * one.numbers
        - policy.outside * one.outside
    )


def _called(effect: Effect, scope: Scope, called: dict[str, str]) -> str:
    """The name under which an effect is counted: that of the likeliest one which the recording cannot tell from it."""
    name = next((called[other] for other in effect.ambiguous(scope) if other in called), effect.name)
    return called.setdefault(effect.name, name)
