"""How likely each set of names is, and that none of the catalogue's is right.

    ln P = -left*max(U, LEAST) - over*min(V, MUCH) - number*numbers + constant

U, V - logarithms of what a set leaves beyond noise, over what the bare axis leaves and over noise; numbers - fitted
(`bench.diagnosis.score`). What holds an effect from outside the catalogue weighs `outside` less and, together with a
constant weight for what was not tried, makes up "none of the catalogue"; of names beside such an effect the share
`beside` is there. The weights, of `bench.diagnosis.policy`, are those under which recordings whose truth is known were
likeliest (`python -m tests.studies.certainty`). The likelihood of the recording itself adds nothing to U and V: its
weight beside them came out as zero.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from bench.diagnosis.policy import Policy
from bench.diagnosis.score import Contender
from bench.effects.effect import Effect
from bench.effects.rivals import Outside
from bench.effects.signals import Scope
from bench.fit.fit import Fit

#: Least of U: what is left is no more than noise.
LEAST = -9.0
#: Largest V that counts: real axes leave more than noise whatever is named.
MUCH = 3.0
#: How often a name that the signals show directly is right: 45 of 46 in the sets that the weights come from.
DETECTED = 0.98
#: Where the weights come from.
CALIBRATED_ON = "docs/certainty.md"


@dataclass(frozen=True)
class NameSet:
    """A set of names with its probability."""

    names: frozenset[str]
    probability: float


@dataclass(frozen=True)
class Probabilities:
    """How likely each set of names is.

    Attributes:
        sets: of names of the torque balance, likeliest first; the empty one says that it lacks nothing.
        none: probability that it lacks something and none of the catalogue is it.
        detected: names that the signals show directly.
        beside: probability that each name is there beside an effect from outside the catalogue, a part of `none`.
        fits: the best of each set, as long as they are searched; what is stored of them keeps none.
    """

    sets: tuple[NameSet, ...]
    none: float
    detected: frozenset[str] = frozenset()
    beside: Mapping[str, float] = field(default_factory=dict)
    fits: Mapping[frozenset[str], Fit] = field(default_factory=dict)

    @cached_property
    def names(self) -> dict[str, float]:
        """Probability of every name that was considered, likeliest first."""
        found = dict(self.beside)
        for each in self.sets:
            for name in each.names:
                found[name] = found.get(name, 0.0) + each.probability
        found |= dict.fromkeys(self.detected, DETECTED)
        return dict(sorted(found.items(), key=lambda one: (-one[1], one[0])))

    @property
    def nothing(self) -> float:
        """Probability that nothing is missing."""
        bare = sum(each.probability for each in self.sets if not each.names)
        return bare * (1.0 - DETECTED) if self.detected else bare

    @property
    def chosen(self) -> NameSet:
        """The names that are likelier than not, or of sets without others the one that misses least of them.

        It predicts best, though another set may be the likeliest (median probability model: M. M. Barbieri, J. O.
        Berger, Annals of Statistics 32, 2004, 870-897): of A beside B, .46, and A beside C, .29, it is A.
        """
        sure = {name: probability - 0.5 for name, probability in self.names.items() if probability > 0.5}
        return max(
            (each for each in self.sets if each.names <= sure.keys()),
            key=lambda each: sum(sure[name] for name in each.names),
        )

    def instead_of(self, name: str) -> dict[str | None, float]:
        """What stands in the place of a chosen name in the sets without it; None: none of the catalogue."""
        found: dict[str | None, float] = {None: self.none - self.beside.get(name, 0.0)}
        for each in self.sets:
            for other in each.names - self.chosen.names if name not in each.names else ():
                found[other] = found.get(other, 0.0) + each.probability
        return dict(sorted(found.items(), key=lambda one: -one[1]))

    def holding(self, level: float) -> list[frozenset[str] | None]:
        """The fewest sets that hold the truth with a probability of at least `level`; None: none of the catalogue."""
        ranked = [(each.probability, each.names | self.detected) for each in self.sets] + [(self.none, None)]
        ranked.sort(key=lambda one: -one[0])
        before = np.cumsum([0.0, *(share for share, _ in ranked)])[:-1]
        return [names for (_, names), sure in zip(ranked, before, strict=True) if sure < level]

    def showing(self, names: Collection[str]) -> Probabilities:
        """Given that what is left shows some names directly."""
        return replace(self, detected=self.detected | frozenset(names)) if names else self

    def without(self, names: frozenset[str]) -> Probabilities:
        """Given that something else is in the place of some names: what held-out motion spoke against.

        Names beside them are as likely as before; what nothing else would be missing beside is none of the catalogue.
        """
        left: dict[frozenset[str], float] = {}
        for each in self.sets:
            left[each.names - names] = left.get(each.names - names, 0.0) + each.probability
        bare = sum(each.probability for each in self.sets if not each.names)
        lost = left.pop(frozenset(), 0.0) - bare
        sets = [NameSet(frozenset(), bare), *(NameSet(*each) for each in left.items())]
        sets.sort(key=lambda one: -one.probability)
        beside = {name: share for name, share in self.beside.items() if name not in names}
        return Probabilities(tuple(sets), self.none + lost, self.detected - names, beside)


def probabilities(scored: Sequence[Contender], detected: frozenset[str], policy: Policy) -> Probabilities:
    """Of hypotheses beside each other, the first of them the bare axis, and of names that the signals show directly."""
    logs = [_log(each, policy) for each in scored]
    weights = np.exp(np.array([*logs, policy.none]) - max(*logs, policy.none))
    shares = (weights / weights.sum()).tolist()
    ranked = sorted(zip(scored, shares, strict=False), key=lambda one: (one[0].outside, -one[1]))
    called: dict[str, str] = {}
    shared: dict[frozenset[str], float] = {}
    beside: dict[str, float] = {}
    fits: dict[frozenset[str], Fit] = {}
    for each, share in ranked:
        held = (term.effect for term in each.fitted.terms if not isinstance(term.effect, Outside))
        names = frozenset(_called(effect, each.fitted.scope, called) for effect in held)
        if each.outside:
            beside |= {name: beside.get(name, 0.0) + policy.beside * share for name in names}
        else:
            fits.setdefault(names, each.fitted)
            shared[names] = shared.get(names, 0.0) + share
    sets = sorted((NameSet(*each) for each in shared.items()), key=lambda one: -one.probability)
    return Probabilities(tuple(sets), 1.0 - sum(each.probability for each in sets), detected, beside, fits)


def _log(one: Contender, policy: Policy) -> float:
    """Logarithm of a hypothesis' weight."""
    return (
        -policy.left * max(one.left, LEAST)
        - policy.over * min(one.over, MUCH)
        - policy.number * one.numbers
        - policy.outside * one.outside
    )


def _called(effect: Effect, scope: Scope, called: dict[str, str]) -> str:
    """The name under which an effect is counted: that of the likeliest one which the recording cannot tell from it."""
    name = next((called[other] for other in effect.ambiguous(scope) if other in called), effect.name)
    return called.setdefault(effect.name, name)
