"""Why each effect of the catalogue was accepted or rejected, by search, doubts and held-out motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bench.diagnosis.add import Added
from bench.diagnosis.name import NamedEffect, Suspects
from bench.diagnosis.recordings import Recordings
from bench.diagnosis.search import Searched, Step
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect


@dataclass(frozen=True)
class Considered:
    """An effect of the catalogue, and why it was accepted or not.

    Attributes:
        effect: of the catalogue.
        taken: whether it is in the model.
        alone: share of the squared gap that it explains alone; None if it was not tried.
        beside: share of the squared residual that it explains in addition to the others; None if it was not tried.
        reason: for or against it.
    """

    effect: Effect
    taken: bool
    alone: float | None
    beside: float | None
    reason: str


def considered(recordings: Recordings, suspects: Suspects, added: Added) -> tuple[Considered, ...]:
    """All effects: those accepted in the order of addition, then the others by the share they explain."""
    rounds = rounds_of(suspects.searched)
    named = {one.effect: one for one in added.refined.effects}
    found = []
    for effect in catalogue().values():
        shares = [share for tried in rounds if (share := _share(tried, effect)) is not None]
        reason = _evidence(named[effect]) if effect in named else _against(effect, recordings, suspects, added, rounds)
        last = _share(rounds[-1], effect) if len(rounds) > 1 and effect not in named else None
        found.append(Considered(effect, effect in named, shares[0] if shares else None, last, reason))
    order = list(named)
    taken = sorted((one for one in found if one.taken), key=lambda one: order.index(one.effect))
    return (*taken, *sorted((one for one in found if not one.taken), key=lambda one: -(one.alone or 0.0)))


def rounds_of(searched: Searched) -> list[Step]:
    """Rounds of a search: each fit with what was tried beside it; beside the last nothing was accepted."""
    pairs = zip(searched.steps, searched.steps[1:], strict=False)
    rounds = [Step(before.fitted, after.rivals) for before, after in pairs]
    return rounds if searched.ended is None else [*rounds, searched.ended]


def _share(tried: Step, effect: Effect) -> float | None:
    """Share of the squared residual that an effect explains beside a fit; None if it was not tried."""
    gains = [candidate.gain for candidate in tried.rivals if candidate.term.effect is effect]
    return max(0.0, *gains) / max(tried.fitted.squares, 1e-300) if gains else None


def _against(effect: Effect, recordings: Recordings, suspects: Suspects, added: Added, rounds: Sequence[Step]) -> str:
    """Why an effect is not in the model."""
    rejected = {one.name: one.reason for one in added.rejected}
    if effect.name in suspects.excluded:
        return "was not to be tried"
    if effect.name in rejected:
        return rejected[effect.name]
    if any(effect is term.effect for tried in rounds for term in tried.fitted.terms):
        return "was taken up and let go: the others explain it too, or a doubt spoke against it"
    if not effect.sought(recordings.rows.scope):
        return "such a recording cannot show it"
    share = _share(rounds[-1], effect) if rounds else None
    if share is not None:
        last = rounds[-1].fitted
        chance = share * last.squares < suspects.policy.by_chance(last, 1)
        return "no more than chance" if chance else "too little, or with values that physics forbids"
    if not suspects.searched.last.hypothesis.admits(effect):
        return "the recording tells but one of it and what was taken"
    return "nothing in the recording points to it"


def _evidence(named: NamedEffect) -> str:
    """The figures that support an effect."""
    return ", ".join(f"{key.replace('_', ' ')} {value:.3g}" for key, value in named.evidence.items()) or "named"
