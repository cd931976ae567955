"""Why each effect of the catalogue was taken or was not: what search, doubts and held-out motion said of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bench.balance.fit import Fit
from bench.diagnose.add.add import Added
from bench.diagnose.found import Considered, NamedEffect
from bench.diagnose.name.candidates import Candidate, joins
from bench.diagnose.name.name import Suspects
from bench.diagnose.name.search import Searched
from bench.diagnose.recordings import Recordings
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect


@dataclass(frozen=True)
class Trial:
    """A round of the search: what was fitted, what was tried beside it, and what was taken up; None in the last."""

    beside: Fit
    candidates: tuple[Candidate, ...]
    taken: Effect | None

    def share(self, effect: Effect) -> float | None:
        """Of the squared gap that an effect would take; None if it was not tried."""
        gains = [candidate.gain for candidate in self.candidates if candidate.term.effect is effect]
        return max(0.0, *gains) / max(self.beside.squares, 1e-300) if gains else None


def considered(recordings: Recordings, suspects: Suspects, added: Added) -> tuple[Considered, ...]:
    """All effects: those taken in the order in which they were added, then the others, what explains most first."""
    trials = trials_of(suspects.searched)
    named = {one.effect: one for one in added.refined.effects}
    rejected = {one.name: one.reason for one in added.rejected}
    let_go = {term.effect for trial in trials for term in trial.beside.terms}
    found = []
    for effect in catalogue().values():
        alone = next((share for trial in trials if (share := trial.share(effect)) is not None), None)
        if effect in named:
            reason = _spoken(named[effect])
        elif effect.name in rejected:
            reason = rejected[effect.name]
        elif effect in let_go:
            reason = "was taken up, and let go: the others explain it too, or a doubt spoke against it"
        elif alone is not None:
            reason = _outdone(effect, trials, suspects)
        elif not effect.sought(recordings.rows.scope):
            reason = "such a recording cannot show it"
        elif not joins(suspects.searched.last, effect):
            reason = "not beside what was taken: the recording tells but one of them"
        else:
            reason = "the recording shows no sign of it, or it was not to be tried"
        found.append(Considered(effect, effect in named, alone, reason))
    order = list(named)
    taken = sorted((one for one in found if one.taken), key=lambda one: order.index(one.effect))
    return (*taken, *sorted((one for one in found if not one.taken), key=lambda one: -(one.share or 0.0)))


def trials_of(searched: Searched) -> list[Trial]:
    """Rounds of a search, the last one without an effect taken up."""
    found = []
    for before, step in zip(searched.steps, searched.steps[1:], strict=False):
        new = [term.effect for term in step.fitted.terms if term.effect not in {t.effect for t in before.fitted.terms}]
        found.append(Trial(before.fitted, step.rivals, new[-1] if new else None))
    if searched.ended is not None:
        found.append(Trial(searched.ended.fitted, searched.ended.rivals, None))
    return found


def _spoken(named: NamedEffect) -> str:
    """The figures that speak for an effect."""
    return ", ".join(f"{key.replace('_', ' ')} {value:.3g}" for key, value in named.evidence.items()) or "named"


def _outdone(effect: Effect, trials: Sequence[Trial], suspects: Suspects) -> str:
    """What an effect would explain, beside what was taken in its place, and what is left for it."""
    said = []
    first = next(trial for trial in trials if trial.share(effect) is not None)
    winner = None if first.taken is None else first.share(first.taken)
    if first.taken is not None and winner is not None:
        other = first.taken.name.replace("_", " ")
        said.append(f"alone it explains {first.share(effect):.0%} of the gap, {other} {winner:.0%}")
    last = trials[-1]
    left = last.share(effect)
    if left is not None:
        chance = left * last.beside.squares < suspects.policy.significant.threshold(last.beside, 1)
        why = "no more than chance" if chance else "too little, or with values that physics forbids"
        said.append(f"{left:.1%} {'of what is left' if last.beside.terms else 'of the gap'}, {why}")
    return "; ".join(said) or "another explains more"
