"""Answers against the truth: right, wrong, or neither.

Wrong is what a user would believe and should not:
- a name of what is not there, without an unexplained remainder;
- J further from the truth than three half widths of its interval;
- J more than 1 % off, though no check failed.
`diagnose` answers for all three; `identify` for J where nothing is hidden, since otherwise its model is not the axis'.

Right is the exact set of names with J as above, and no remainder where nothing is missing. Where a nuisance destroys
what it takes to answer, a refusal is right too; where it is no effect of the catalogue, so is a nameless remainder.
All else is neither: names that are missing, and refusals and remainders where the answer was there to be had.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tests.studies.blind.score import same, twins
from tests.studies.nuisance.answer import Answer, ask
from tests.studies.nuisance.draw import Case
from tests.studies.nuisance.nuisance import Nuisance

#: Half widths of its interval that J may be off.
HALF_WIDTHS = 3.0
RIGHT, NEITHER, WRONG = "right", "neither", "wrong"
REMAINDER = "unexplained_remainder"


@dataclass(frozen=True)
class Score:
    """A case, judged.

    Attributes:
        judgement: right, neither or wrong.
        reasons: what is wrong, or what keeps it from being right.
    """

    case: Case
    identified: Answer
    diagnosed: Answer
    judgement: str
    reasons: tuple[str, ...]

    @property
    def fault(self) -> bool:
        """Whether either command ended in a fault of the bench."""
        return self.identified.fault or self.diagnosed.fault


def judged(case: Case, identified: Answer, diagnosed: Answer) -> Score:
    """Judge both commands' answers."""
    nuisance, hidden = case.kind, [effect.name for effect in case.effects]
    bad = [f"false name {name}" for name in _believed(nuisance, hidden, diagnosed)]
    answers = {"diagnose": diagnosed} | ({} if hidden else {"identify": identified})
    for command, answer in answers.items():
        off = inertia_off(nuisance, case.axis.inertia, answer)
        bad += [f"{command}: {off}"] if off else []
    if bad:
        return Score(case, identified, diagnosed, WRONG, tuple(bad))
    short = shortcoming(nuisance, hidden, identified, diagnosed)
    return Score(case, identified, diagnosed, NEITHER if short else RIGHT, (short,) if short else ())


def judge(case: Case, folder) -> Score:
    """Ask both commands about a case's files and judge what they answer."""
    trace, rig = folder / "run.csv.gz", folder / "rig.toml"
    return judged(case, ask("identify", [trace], rig), ask("diagnose", [trace], rig))


def false_names(nuisance: Nuisance, hidden: Sequence[str], named: Sequence[str]) -> list[str]:
    """Names given that are neither hidden, nor the nuisance's own, nor the twin of one hidden."""
    return [name for name in named if twins(name) not in same(hidden) and name not in nuisance.right_names]


def _believed(nuisance: Nuisance, hidden: Sequence[str], answer: Answer) -> list[str]:
    """False names that nothing warns of."""
    if answer.refused or answer.verdict == REMAINDER:
        return []
    return false_names(nuisance, hidden, answer.named)


def inertia_off(nuisance: Nuisance, true: float, answer: Answer) -> str:
    """What is wrong with J, empty if nothing or if a check failed."""
    if answer.refused or answer.inertia is None or nuisance.reported(answer):
        return ""
    value, low, high = answer.inertia
    error, half_width = abs(value - true), 0.5 * (high - low)
    if error > HALF_WIDTHS * half_width and error > 0.0:
        return f"J {100.0 * (value / true - 1.0):+.3g} %, {error / max(half_width, 1e-300):.3g} half widths"
    if error > nuisance.inertia_error * true:
        return f"J {100.0 * (value / true - 1.0):+.3g} %, within three half widths"
    return ""


def shortcoming(nuisance: Nuisance, hidden: Sequence[str], identified: Answer, diagnosed: Answer) -> str:
    """What keeps answers that are not wrong from being right, empty if nothing."""
    if identified.fault or diagnosed.fault:
        return "fault of the bench"
    if diagnosed.refused or (identified.refused and not hidden):
        return "" if nuisance.refusal_is_right else "refused"
    remainder, false = diagnosed.verdict == REMAINDER, false_names(nuisance, hidden, diagnosed.named)
    if false:
        return f"false name {', '.join(false)} next to a remainder"
    own = [name for name in diagnosed.named if name not in nuisance.right_names or twins(name) in same(hidden)]
    if remainder and nuisance.remainder_is_right:
        return ""
    if same(own) != same(hidden):
        return f"{', '.join(hidden)} not named" + ", a remainder" * remainder
    return "a remainder" if remainder and not hidden else ""
