"""Why each effect of the catalogue was accepted or rejected, by search, doubts and held-out motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bench.diagnosis.add.add import Added
from bench.diagnosis.found import Considered, NamedEffect
from bench.diagnosis.name.candidates import Candidate
from bench.diagnosis.name.name import Suspects
from bench.diagnosis.name.search import Searched
from bench.diagnosis.recordings import Recordings
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.fit.fit import Fit


@dataclass(frozen=True)
class Trial:
    """A round of the search: the fit, the effects tried, and the one accepted; None in the last."""

    beside: Fit
    candidates: tuple[Candidate, ...]
    taken: Effect | None

    def share(self, effect: Effect) -> float | None:
        """Share of the squared gap that an effect explains; None if it was not tried."""
        gains = [candidate.gain for candidate in self.candidates if candidate.term.effect is effect]
        return max(0.0, *gains) / max(self.beside.squares, 1e-300) if gains else None


def considered(recordings: Recordings, suspects: Suspects, added: Added) -> tuple[Considered, ...]:
    """All effects: those accepted in the order of addition, then the others by the share they explain."""
    trials = trials_of(suspects.searched)
    named = {one.effect: one for one in added.refined.effects}
    found = []
    for effect in catalogue().values():
        shares = [share for trial in trials if (share := trial.share(effect)) is not None]
        reason = _evidence(named[effect]) if effect in named else _against(effect, recordings, suspects, added, trials)
        last = trials[-1].share(effect) if len(trials) > 1 and effect not in named else None
        found.append(Considered(effect, effect in named, shares[0] if shares else None, last, reason))
    order = list(named)
    taken = sorted((one for one in found if one.taken), key=lambda one: order.index(one.effect))
    return (*taken, *sorted((one for one in found if not one.taken), key=lambda one: -(one.alone or 0.0)))


def _against(effect: Effect, recordings: Recordings, suspects: Suspects, added: Added, trials: Sequence[Trial]) -> str:
    """Why an effect is not in the model."""
    rejected = {one.name: one.reason for one in added.rejected}
    if effect.name in suspects.excluded:
        return "was not to be tried"
    if effect.name in rejected:
        return rejected[effect.name]
    if any(effect is term.effect for trial in trials for term in trial.beside.terms):
        return "was taken up and let go: the others explain it too, or a doubt spoke against it"
    if not effect.sought(recordings.rows.scope):
        return "such a recording cannot show it"
    left = trials[-1].share(effect) if trials else None
    if left is not None:
        last = trials[-1].beside
        chance = left * last.squares < suspects.policy.significant.threshold(last, 1)
        return "no more than chance" if chance else "too little, or with values that physics forbids"
    if not suspects.searched.last.hypothesis.admits(effect):
        return "the recording tells but one of it and what was taken"
    return "nothing in the recording points to it"


def trials_of(searched: Searched) -> list[Trial]:
    """Rounds of a search; the last one accepts no effect."""
    found = []
    for before, step in zip(searched.steps, searched.steps[1:], strict=False):
        new = [term.effect for term in step.fitted.terms if term.effect not in {t.effect for t in before.fitted.terms}]
        found.append(Trial(before.fitted, step.rivals, new[-1] if new else None))
    if searched.ended is not None:
        found.append(Trial(searched.ended.fitted, searched.ended.rivals, None))
    return found


def _evidence(named: NamedEffect) -> str:
    """The figures that support an effect."""
    return ", ".join(f"{key.replace('_', ' ')} {value:.3g}" for key, value in named.evidence.items()) or "named"
