"""How likely each set of names is, and that of an unknown effect.

A hypothesis about an axis is a set of effects with their shapes, some of them of no catalogue. It is held by what it
residual beyond noise, on the rows whose torque every hypothesis determines, or on all where these are fewer than half,

    E = max(v - f**2, 0) + BESIDE_NOISE*f**2

v - mean squared residual; f - noise floor, its colour that of the hypothesis of least residual, as each one's own would
turn a difference in colour into evidence. A holdout adds what a hypothesis, of the strengths that the recording
gave, has of it beyond twice what the best one does. Then

    ln P = -remaining*(max(U, LEAST) + B) - over*min(V, MUCH) - number*numbers + constant

U, V - logarithm of E relative to the bare axis and relative to noise alone. V counts all rows for a hypothesis that
determines all of them: without impacts it has to explain the rows next to impacts, too. B - logarithm of v/f**2 where
that is negative and the residual of the bare axis exceeds noise, else 0: the true noise is then weaker than its
estimate f. numbers - fitted numbers. A hypothesis with an unknown effect has the weight `outside`;
these hypotheses and a constant weight for those that were not tried make up the unknown effect. A name next to such an
effect counts if the residual without it is at least twice as large, as an outside effect can replace smaller ones. The
weights, of `bench.diagnosis.policy`, maximise the likelihood of recordings whose truth is known
(`python -m tests.studies.certainty`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from bench.arrays import Array
from bench.diagnosis.policy import Policy, freedom
from bench.effects.catalogue import catalogue
from bench.effects.effect import Coupling, Effect, Occasional
from bench.effects.signals import Scope
from bench.fit.fit import Fit, fit
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.names import meant

#: Share of the noise power below which a residual beyond noise no longer counts.
BESIDE_NOISE = 0.03
#: Blocks that a holdout is judged in, and residual over noise floor above which no hypothesis explains one.
BLOCKS, EXPLAINED = 32, 3.0
#: Power over the best hypothesis' up to which a holdout decides nothing, as strengths and shapes have errors.
UNSURE = 2.0
#: Numbers that a scale of the torque counts for beyond its own: more than friction by torque, less than an unbalance.
RESCALED = 0.5
#: Probability of a hypothesis with a decoy below which the effects next to the decoy are not counted.
LITTLE = 0.01
#: Least of U: the residual is no more than noise.
LEAST = -9.0
#: Largest V that counts: real axes leave more than noise whatever is named.
MUCH = 3.0
#: How often a name that the signals show directly is right: 45 of 46 in the sets that the weights come from.
DETECTED = 0.98
#: Where the weights come from.
CALIBRATED_ON = "docs/certainty.md"


@dataclass(frozen=True)
class Probabilities:
    """How likely each set of names is.

    Attributes:
        sets: probability of each set of names of the torque balance, likeliest first; the empty one: it lacks nothing.
        none: probability that it lacks something and the effect is unknown.
        detected: names that the signals show directly.
        with_unknown: probability that each name is there with an unknown effect, a part of `none`.
        fits: the best of each set, as long as they are searched; what is stored of them keeps none.
    """

    sets: Mapping[frozenset[str], float]
    none: float
    detected: frozenset[str] = frozenset()
    with_unknown: Mapping[str, float] = field(default_factory=dict)
    fits: Mapping[frozenset[str], Fit] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        return meant(name, self.names)

    @cached_property
    def names(self) -> dict[str, float]:
        """Probability of every name that was considered, likeliest first."""
        found = dict(self.with_unknown)
        for names, probability in self.sets.items():
            for name in names:
                found[name] = found.get(name, 0.0) + probability
        found |= dict.fromkeys(self.detected, DETECTED)
        return dict(sorted(found.items(), key=lambda one: (-one[1], one[0])))

    def of_any(self, names: Collection[str]) -> float:
        """Probability that the axis has one of some effects that the recording does not distinguish."""
        if self.detected & {*names}:
            return DETECTED
        unknown = max((self.with_unknown.get(name, 0.0) for name in names), default=0.0)
        return unknown + sum(probability for each, probability in self.sets.items() if each & {*names})

    @property
    def nothing(self) -> float:
        """Probability that no effect is missing."""
        return self.sets.get(frozenset(), 0.0) * (1.0 - DETECTED if self.detected else 1.0)

    @property
    def chosen(self) -> frozenset[str]:
        """The names that are likelier than not, or of sets without others the one that misses least of them.

        It predicts best, though another set may be the likeliest (median probability model: M. M. Barbieri, J. O.
        Berger, Annals of Statistics 32, 2004, 870-897): of A with B, .46, and A with C, .29, it is A. Of names that
        some recordings cannot distinguish, the likeliest counts for all of them.
        """
        sure = {name: shared - 0.5 for name in self.names if (shared := self._with_likeness(name)) > 0.5}
        return max(
            (each for each in self.sets if each <= sure.keys()), key=lambda each: sum(sure[name] for name in each)
        )

    def _with_likeness(self, name: str) -> float:
        """Probability of a name or one that looks like it, if none of those is likelier; else its own."""
        looks_like = catalogue()[name].looks_like if name in catalogue() else ()  # a plug-in may be missing by now
        alike = [other for other in looks_like if other in self.names]
        own = self.names[name]
        return self.of_any([name, *alike]) if all(self.names[other] < own for other in alike) else own

    def instead_of(self, name: str) -> dict[str | None, float]:
        """Probability of what replaces a chosen name in the sets without it; None: an unknown effect."""
        found: dict[str | None, float] = {None: self.none - self.with_unknown.get(name, 0.0)}
        for names, probability in self.sets.items():
            for other in names - self.chosen if name not in names else ():
                found[other] = found.get(other, 0.0) + probability
        return dict(sorted(found.items(), key=lambda one: -one[1]))

    def holding(self, level: float) -> list[frozenset[str] | None]:
        """The fewest sets that hold the truth with a probability of at least `level`; None: an unknown effect."""
        ranked = [(probability, names | self.detected) for names, probability in self.sets.items()] + [
            (self.none, None)
        ]
        ranked.sort(key=lambda one: -one[0])
        before = np.cumsum([0.0, *(share for share, _ in ranked)])[:-1]
        return [names for (_, names), sure in zip(ranked, before, strict=True) if sure < level]

    def without(self, names: frozenset[str]) -> Probabilities:
        """Given that something else is in the place of some names: what held-out motion spoke against.

        The other names are as likely as before; a set that would be empty without it becomes an unknown effect.
        """
        bare, rest = self.sets.get(frozenset(), 0.0), dict[frozenset[str], float]()
        for each, probability in self.sets.items():
            rest[each - names] = rest.get(each - names, 0.0) + probability
        lost = rest.get(frozenset(), 0.0) - bare
        unknown = {name: share for name, share in self.with_unknown.items() if name not in names}
        return Probabilities(ranked({**rest, frozenset(): bare}), self.none + lost, self.detected - names, unknown)


def ranked(shares: Mapping[frozenset[str], float]) -> dict[frozenset[str], float]:
    """Sets of names, likeliest first."""
    return dict(sorted(shares.items(), key=lambda one: -one[1]))


@dataclass(frozen=True)
class Contender:
    """A hypothesis, and what speaks for it.

    Attributes:
        fitted: to the recording.
        remaining: logarithm of its residual beyond noise over that of the bare axis.
        over: the same over BESIDE_NOISE of the noise.
        below: logarithm of its residual power relative to the noise where that is less, else 0.
        numbers: fitted beyond those of the bare axis, and RESCALED for a scale of the torque.
        outside: whether it has an unknown effect.
    """

    fitted: Fit
    remaining: float
    over: float
    below: float
    numbers: float
    outside: bool

    def score(self, policy: Policy) -> float:
        """ln P, up to a constant."""
        distance = policy.remaining * (max(self.remaining, LEAST) + self.below) + policy.over * min(self.over, MUCH)
        return -distance - policy.number * self.numbers - policy.outside * self.outside

    def remains(self, policy: Policy) -> bool:
        """Whether its residual is clearly above the noise that the best hypothesis shows."""
        return self.over > math.log1p((policy.remainder**2 - 1.0) / BESIDE_NOISE)


#: Effects of a hypothesis with how many terms each has.
Key = frozenset[tuple[Effect, int]]


def key_of(fitted: Fit, *more: Effect) -> Key:
    """The effects of a fit, and more of them."""
    return frozenset(Counter([*(term.effect for term in fitted.terms), *more]).items())


def credible(fitted: Fit) -> bool:
    """Whether a result may have such a coupling: one that hardly rings damps noise."""
    return all(term.effect.credible(term.shape) for term in fitted.terms if isinstance(term.effect, Coupling))


def weighed(visited: Sequence[Fit], holdout: Rows | None, policy: Policy) -> list[Contender]:
    """What speaks for each credible one of some physical fits of different effects, the first of them the bare axis."""
    physical = [each for each in visited if credible(each)]
    common = np.logical_and.reduce([each.determined for each in physical])
    if float(common.mean()) <= 0.5:  # the other rows have to speak for it, too
        common = np.ones_like(common)
    power = np.array([np.mean(each.left[common] ** 2) for each in physical])
    certain = [each.determined.all() for each in physical]
    claimed = np.where(certain, [np.mean(each.left**2) for each in physical], power)
    white = np.array([each.noise.white**2 for each in physical])
    outside = np.array([any(term.effect.decoy for term in each.terms) for each in physical])
    white[outside] = np.minimum(white[outside], white[~outside].max())  # its inertia may be any, and noise with that
    best = int(np.argmin(power / white))
    floor = white * (physical[best].floor / physical[best].noise.white) ** 2
    if visited[0].depends is not None:  # the fit that explains the dependence bounds the noise
        floor = np.minimum(floor, power.min())
    elif len(physical) == 1 and not policy.remains(visited[0]):  # noise, whose level is known no better
        floor = np.maximum(floor, claimed)
    beyond = _on_holdout(physical, holdout, floor) if holdout is not None else 0.0
    excess, claimed = (np.maximum(of - floor, 0.0) + beyond for of in (power, claimed))
    left = np.log(excess + BESIDE_NOISE * floor[0])  # of one noise: damping it does not lower the residual
    over = np.log1p(claimed / (BESIDE_NOISE * floor))
    rescaled = [RESCALED * each.layout.rescaling.size for each in physical]
    numbers = [freedom(each) - freedom(visited[0]) + more for each, more in zip(physical, rescaled, strict=True)]
    least = np.minimum(floor, floor[best])  # neither who damps noise gains by it, nor who raises it
    below = np.minimum(np.log(power / least), 0.0) * policy.remains(visited[0])  # of noise alone nothing is explained
    columns = (left - left[0]).tolist(), over.tolist(), below.tolist(), numbers, outside.tolist()
    return [Contender(*each) for each in zip(physical, *columns, strict=True)]


def _on_holdout(physical: Sequence[Fit], holdout: Rows, floor: Array) -> Array:
    """The residual of each hypothesis on a holdout beyond the best one, by the strengths of the recording (h,).

    In blocks that some hypothesis explains, as it may hold an event of its own; but who claims that what happens is an
    event has to explain those, too.
    """
    blocks = np.stack([_blocks(each, holdout) for each in physical], axis=1)
    explained = (blocks < EXPLAINED**2 * floor).any(axis=1)
    if not explained.any():
        return np.zeros(len(physical))
    power = blocks[explained].mean(axis=0)
    eventful = np.array([any(isinstance(term.effect, Occasional) for term in each.terms) for each in physical])
    least = UNSURE * np.maximum(power.min(), floor)
    return np.maximum(np.where(eventful, blocks.mean(axis=0), power) - least, 0.0)


def _blocks(fitted: Fit, holdout: Rows) -> Array:
    """Mean squared residual of a holdout in BLOCKS stretches, each event there or not, whichever is less (b,).

    What the recording does not determine of an event, as when it began at standstill, is as fits best, too.
    """
    balance = Balance.of(fitted).repeating(True)
    events = [
        (k, term.effect, term.shape) for k, term in enumerate(fitted.terms) if isinstance(term.effect, Occasional)
    ]
    for index, effect, shape in events:
        alike = effect.indistinct(shape, fitted.time, fitted.scope)
        if len(alike) > 1:
            tried = [replace(balance, hypothesis=balance.hypothesis.reshaped(index, each)) for each in alike]
            balance = min(tried, key=lambda each: each.gap(holdout))
    left, layout = balance.left(holdout), balance.laid(holdout)
    for index, *_ in events:
        own = layout.owners == index
        without = left + layout.columns[:, own] @ balance.theta[own]
        left = min(left, without, key=lambda residual: float(residual @ residual))
    return np.array([float(np.mean(part**2)) for part in np.array_split(left, BLOCKS) if part.size])


def probabilities(scored: Sequence[Contender], detected: frozenset[str], policy: Policy) -> Probabilities:
    """Of hypotheses together, the first of them the bare axis, and of names that the signals show directly."""
    logs = [each.score(policy) for each in scored]
    weights = np.exp(np.array([*logs, policy.none]) - max(*logs, policy.none))
    shares = (weights / weights.sum()).tolist()
    called: dict[str, str] = {}
    shared: dict[frozenset[str], float] = {}
    with_unknown: dict[str, float] = {}
    fits: dict[frozenset[str], Fit] = {}
    for each, share in sorted(zip(scored, shares, strict=False), key=lambda one: (one[0].outside, -one[1])):
        if each.outside and share < LITTLE:
            continue
        held = standing(each.fitted, policy) if each.outside else [term.effect for term in each.fitted.terms]
        names = frozenset(_called(effect, each.fitted.scope, called) for effect in held)
        if each.outside:
            with_unknown |= {name: with_unknown.get(name, 0.0) + share for name in names}
        else:
            fits.setdefault(names, each.fitted)
            shared[names] = shared.get(names, 0.0) + share
    return Probabilities(ranked(shared), 1.0 - sum(ranked(shared).values()), detected, with_unknown, fits)


def standing(fitted: Fit, policy: Policy) -> list[Effect]:
    """Effects next to an unknown one that cannot replace them."""
    own = [(index, term.effect) for index, term in enumerate(fitted.terms) if not term.effect.decoy]
    less = (fit(fitted.rows, fitted.hypothesis.without(index), fitted) for index, _ in own)
    return [
        effect for (_, effect), without in zip(own, less, strict=True) if fitted.chi < policy.with_unknown * without.chi
    ]


def _called(effect: Effect, scope: Scope, called: dict[str, str]) -> str:
    """The name under which an effect is counted: that of the likeliest one that is ambiguous with it."""
    name = next((called[other] for other in effect.ambiguous(scope) if other in called), effect.name)
    return called.setdefault(effect.name, name)
