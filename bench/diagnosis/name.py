"""Name what is missing: in the torque balance by search, elsewhere by what the recording shows of drive and sensor.

Events exceed the residual of a search, whatever that is: no name for the rest is needed to see them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, SupportsIndex, overload

import numpy as np

from bench.arrays import NORMAL95
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS
from bench.diagnosis.policy import Policy, Reason
from bench.diagnosis.probability import Probabilities, key_of, probabilities, weighed
from bench.diagnosis.recordings import Recordings
from bench.diagnosis.search import Search, search
from bench.effects.catalogue import catalogue
from bench.effects.effect import Detected, Effect, Lag, Occasional, Stage
from bench.effects.signals import AxisState
from bench.effects.torque import Torque
from bench.fit.estimate import load_inertia
from bench.fit.fit import Fit, fit, hint, shaped, unbiased
from bench.fit.hypothesis import BASE, Term
from bench.fit.quantities import strengths_are_sure, uncertain
from bench.fit.solution import solution_of
from bench.names import meant
from bench.parameter import Parameter
from bench.presented import ByName


@dataclass(frozen=True)
class NamedEffect(ByName):
    """An effect that the recording shows.

    Attributes:
        effect: of the catalogue.
        parameters: its quantities with intervals.
        ambiguous_with: names of effects that this recording cannot distinguish from it.
        evidence: figures that support it, by name.
    """

    effect: Effect
    parameters: dict[str, Parameter]
    ambiguous_with: tuple[str, ...]
    evidence: Mapping[str, float]

    def __getitem__(self, name: str) -> Parameter:
        return meant(name, self.parameters)

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effect.name

    @property
    def values(self) -> dict[str, float]:
        """Values of its quantities - SI."""
        return {key: parameter.value for key, parameter in self.parameters.items()}


class NamedEffects(list[NamedEffect]):
    """Effects in their order, each by its place or its name."""

    @overload
    def __getitem__(self, which: SupportsIndex | str) -> NamedEffect: ...
    @overload
    def __getitem__(self, which: slice) -> list[NamedEffect]: ...
    def __getitem__(self, which: SupportsIndex | str | slice) -> NamedEffect | list[NamedEffect]:
        """The effect of a name or place; KeyError with the names that there are."""
        return meant(which, {one.name: one for one in self}) if isinstance(which, str) else super().__getitem__(which)


@dataclass(frozen=True)
class Suspects:
    """What was named, and what it was weighed against.

    Attributes:
        fitted: with the effects of the torque balance.
        visited: all fits that are possible, the first without an effect.
        probabilities: of these and of others.
        detected: what the torque balance does not hold.
        policy: that decided.
        excluded: names that were not to be tried.
        rejected: why the size of what was found at first is not determined, by name; it was then not tried either.
        stopped: what ended the search before it was done; None if nothing did.
        of_gap: share of the squared gap that each effect which was tried explains as the only one.
        of_residual: share of the squared residual that it explains in addition to those named.
        against: the criterion by which it is not in `fitted`.
    """

    fitted: Fit
    visited: tuple[Fit, ...]
    probabilities: Probabilities
    detected: Mapping[Effect, Detected]
    policy: Policy
    excluded: frozenset[str] = frozenset()
    rejected: Mapping[str, Reason] = field(default_factory=dict)
    stopped: str | None = None
    of_gap: Mapping[Effect, float] = field(default_factory=dict)
    of_residual: Mapping[Effect, float] = field(default_factory=dict)
    against: Mapping[Effect, str] = field(default_factory=dict)


def name(recordings: Recordings, bare: Fit, excluded: frozenset[str], policy: Policy) -> Suspects:
    """The likeliest names of those that a search finds and their neighbours, and what the signals show directly.

    An effect whose size the recording does not determine is not found: the search is repeated without it. It is
    repeated where torque and speed differ by a delay, too, which is then undone, and where links are off their encoder.
    """
    kept = {effect: found for effect, found in recordings.detected.items() if effect.name not in excluded}
    direct, unsized = frozenset(effect.name for effect in kept), dict[str, Reason]()
    visited: Sequence[Fit] = ()
    while True:
        untried = excluded | unsized.keys()
        effects = [effect for name, effect in catalogue().items() if name not in untried]
        searched = search(bare, effects, policy, known=visited)
        visited = searched.visited
        likely = probabilities(weighed(visited, recordings.holdout_rows, policy), direct, policy)
        chosen = likely.fits[likely.chosen]
        last = with_events(chosen, effects, policy)
        more, shift, off = without_size(last, recordings), delay(last, policy), misplaced(last, policy)
        if not more and not shift and not off:
            break
        unsized |= more
        if shift or off:
            shift, off = bare.hypothesis.shift + shift, bare.hypothesis.misplaced or off
            bare, visited = fit(bare.rows, replace(bare.hypothesis, shift=shift, misplaced=off)), ()
    events = frozenset(term.effect.name for term in last.terms[len(chosen.terms) :])
    return Suspects(
        fitted=last,
        visited=visited,
        probabilities=replace(likely, detected=likely.detected | events),
        detected=kept,
        policy=policy,
        excluded=excluded,
        rejected=unsized,
        stopped=searched.stopped,
        **tried(searched, last),
    )


def tried(searched: Search, result: Fit) -> dict[str, Mapping[Effect, Any]]:
    """Shares of the effects that a search tried, and why each is not in its result, as `Suspects` has them."""
    shares = {key: of for key, of in searched.shares.items() if of}
    if not shares:
        return {}
    if not result.terms:
        shares = dict([next(iter(shares.items()))])
    own = key_of(result)
    last = shares.pop(own, None) or next(reversed(shares.values()))
    shares[own] = last
    against = {
        effect: "chance"
        if part * result.squares < searched.policy.by_chance(result)
        else searched.refused.get(effect, "others")
        for effect, part in last.items()
    }
    return {
        "of_gap": {effect: part for of in reversed(shares.values()) for effect, part in of.items()},
        "of_residual": last if result.terms else {},
        "against": against | {effect: "removed" for key in shares for effect, _ in key},
    }


def delay(fitted: Fit, policy: Policy) -> float:
    """By how much torque and speed surely differ beyond the bound of their shift - s -; else 0.

    A lag is an effect, so effects are searched within the bound first. 0 with a lag, too, and where more than noise
    remains without the bound: what a model lacks may look like a delay.
    """
    if BASE.index(MISALIGNMENT) not in fitted.held or fitted.hypothesis.of_kind(Lag):
        return 0.0
    free = solution_of(fitted.rows, fitted.hypothesis, offset=False)
    if not free.delayed or free.held:
        return 0.0
    moved = replace(fitted.hypothesis, shift=fitted.hypothesis.shift + free.shift[0])
    return 0.0 if policy.remains(fit(fitted.rows, moved, fitted)) else free.shift[0]


def misplaced(fitted: Fit, policy: Policy) -> bool:
    """Whether links that are a little off their encoder surely explain a part of what remains."""
    if fitted.hypothesis.misplaced or not fitted.rows.stretches[0].signals.known:
        return False
    off = fit(fitted.rows, replace(fitted.hypothesis, misplaced=True), fitted)
    return not off.held and fitted.squares - off.squares > policy.by_chance(fitted)


def without_size(fitted: Fit, recordings: Recordings) -> dict[str, Reason]:
    """The effects whose size is not determined, by name: of all their terms the intervals contain their absence.

    An effect of whose presence a strength is sure has a size, however uncertain its shape makes that.
    """
    if not fitted.terms:
        return {}
    numbers, sizes = uncertain(fitted), dict[str, list[tuple[str, Parameter]]]()
    for index, term in enumerate(fitted.terms):
        values = numbers.quantities(index, partial(_unit, recordings))
        known = [(each.name, values[each.name]) for each in term.effect.quantities if each.null is not None]
        sizes.setdefault(term.effect.name, []).extend(known)
    sure = {fitted.terms[k].effect.name for k in fitted.owners[strengths_are_sure(fitted)] if isinstance(k, int)}
    return {
        name: Reason("undetermined", {"quantity": known[0][0], "found": known[0][1]})
        for name, known in sizes.items()
        if known and name not in sure and all(abs(one.value) <= numbers.reach * one.std_error for _, one in known)
    }


def with_events(fitted: Fit, effects: Iterable[Effect], policy: Policy) -> Fit:
    """The fit with the events that exceed its remainder, each with a parabola of the residual around it."""
    if not policy.remains(fitted):
        return fitted
    for effect in (each for each in effects if isinstance(each, Occasional)):
        for shape, around in effect.apart(fitted):
            fitted = _with_event(fitted, Term(effect, shape, around=around), policy)
    return fitted


def _with_event(fitted: Fit, term: Term, policy: Policy) -> Fit:
    """With an event that saves more than chance does, with little residual around its torque."""
    after = shaped(fitted, fitted.hypothesis.plus(term), len(fitted.terms))
    own = after.owners == len(fitted.terms)
    others = np.linalg.qr(after.columns[:, ~own])[0]
    alone = after.columns[:, own] - others @ (others.T @ after.columns[:, own])
    saved = float(np.sum((alone @ after.theta[own]) ** 2))
    near = (fitted.time >= term.around[0]) & (fitted.time <= term.around[1])
    left = float(np.sum(after.residual[near] ** 2)) - np.count_nonzero(near) * fitted.floor**2
    numbers = after.theta[own].size + len(term.shape)
    return after if policy.event_shows(fitted, numbers, saved, left) and policy.physical(after) else fitted


def named(
    recordings: Recordings, fitted: Fit, detected: Mapping[Effect, Detected], policy: Policy
) -> tuple[list[NamedEffect], dict[str, Parameter]]:
    """Effects of a torque balance and outside of it with their quantities, together with J, K_w, K_0."""
    numbers, others = uncertain(fitted), recordings.within_tolerance(fitted)
    hinted, over_noise = hint(fitted, catalogue().values()) or fitted, unbiased(fitted)
    moved = {} if fitted.depends is None else fitted.depends.moved
    parameters = {
        name: found.widened(*(other.value(term) - found.value for other in others))
        .reaching(hinted.value(term))
        .reaching(found.value + moved.get(term, 0.0))
        for term, (name, found) in zip((INERTIA, VISCOUS, COULOMB), recordings.base(numbers).items(), strict=True)
    }
    effects = []
    for index, term in enumerate(fitted.terms):
        less = fit(fitted.rows, fitted.hypothesis.without(index), fitted)
        evidence = {"residual_without": less.rms, "residual_with": fitted.rms, "noise_floor": fitted.floor}
        reports = [term.effect.report(other.strengths(index), term.shape, other.base) for other in others]
        by_hint = term.effect.report(hinted.strengths(index), term.shape, hinted.base)
        by_noise = term.effect.report(over_noise.strengths(index), over_noise.terms[index].shape, over_noise.base)
        found = {
            key: value.widened(*(report[key] - value.value for report in reports))
            .reaching(by_hint[key])
            .reaching(by_noise[key])
            for key, value in numbers.quantities(index, partial(_unit, recordings)).items()
        }
        effects.append(NamedEffect(term.effect, found, alike(fitted, index, policy), evidence))
    gain = _gain(effects, fitted)
    parameters = {name: found.reaching(found.value / gain) for name, found in parameters.items()}
    parameters |= load_inertia(parameters, recordings.rig)
    return [*effects, *(_read(recordings, effect, found) for effect, found in detected.items())], parameters


def alike(fitted: Fit, index: int, policy: Policy) -> tuple[str, ...]:
    """Names of effects that the recording cannot distinguish from a term's: none can, or a wider form fits as well."""
    term, found = fitted.terms[index], []
    for effect in (each for each in catalogue().values() if each.replaces):
        shape = effect.unlike(fitted) if term.effect.name in effect.replaces else None
        if shape is not None:
            other = fit(fitted.rows, fitted.hypothesis.with_term(index, Term(effect, shape)), fitted)
            if policy.replaceable(fitted, other):
                found.append(effect.name)
    for effect in (catalogue()[name] for name in term.effect.looks_like):
        if effect.sought(fitted.scope) and fitted.hypothesis.without(index).admits(effect):
            other = fit(fitted.rows, fitted.hypothesis.with_term(index, Term(effect)), fitted)
            if policy.replaceable(fitted, other):
                found.append(effect.name)
    return (*term.effect.ambiguous(fitted.scope), *found)


def _gain(effects: Sequence[NamedEffect], fitted: Fit) -> float:
    """Torque per reading at the end of the recording over that at its start, where effects change it.

    The rig does not state when its torque constant is valid, so all torques may be by as much less.
    """
    gain = 1.0
    for one in effects:
        effect = one.effect
        if isinstance(effect, Torque) and effect.stage == Stage.CURRENT_SENSOR:
            lost = [
                effect.torque(one.values, fitted.base, AxisState(time, 0.0, 0.0, effort))
                for time in (fitted.scope.duration, 0.0)
                for effort in (1.0, 0.0)
            ]
            gain *= (1.0 - float(lost[0] - lost[1])) / (1.0 - float(lost[2] - lost[3]))
    return gain


def _read(recordings: Recordings, effect: Effect, found: Detected) -> NamedEffect:
    """An effect outside the torque balance with its quantities."""
    values = {}
    for key, value in found.values.items():
        half = found.errors[key]
        values[key] = Parameter.around(value, _unit(recordings, effect, key), half / NORMAL95, half)
    return NamedEffect(effect, values, effect.ambiguous(recordings.rows.scope), found.evidence)


def _unit(recordings: Recordings, effect: Effect, name: str) -> str:
    """Unit of an effect's quantity."""
    known = (*effect.quantities, *effect.derived, *(shape.quantity for shape in effect.shapes))
    quantity = next(quantity for quantity in known if quantity.name == name)
    return recordings.rig.axis_kind.unit(quantity, recordings.unit)
