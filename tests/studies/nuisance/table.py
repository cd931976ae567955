"""Results as Markdown, and one line a case as CSV."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import median

from tests.studies.frame import csv_of, table
from tests.studies.nuisance.nuisance import Nuisance, named
from tests.studies.nuisance.score import NEITHER, RIGHT, WRONG, Score, inertia_off

CONTROL = named(Nuisance())
HEADINGS = (
    *("case", "nuisance", "strength", "hidden", "references", "judgement", "reasons"),
    *("identify", "identify_inertia_error", "diagnose", "verdict", "named", "inertia_error", "half_widths", "seconds"),
    "said",
)


def markdown(scores: Sequence[Score], title: str, command: str) -> str:
    """All figures of a run."""
    return "\n\n".join((f"# {title}", f"`{command}`", headline(scores), by_nuisance(scores), not_right(scores))) + "\n"


def share(part: int, whole: int) -> str:
    """`part of whole, per cent`."""
    return f"{part} of {whole}, {100.0 * part / whole:.1f} %" if whole else "-"


def headline(scores: Sequence[Score]) -> str:
    """What the whole set comes to, without the control."""
    damaged = [score for score in scores if score.case.nuisance != CONTROL]
    control = [score for score in scores if score.case.nuisance == CONTROL]
    count = Counter(score.judgement for score in damaged)
    off = [score for score in damaged if score.case.effect is not None and _identified_off(score)]
    wide = [s for s in damaged if s.judgement == WRONG and all(r.endswith("three half widths") for r in s.reasons)]
    total, singles = len(damaged), sum(score.case.effect is not None for score in damaged)
    lines = [
        ("right", share(count[RIGHT], total), "80 %"),
        ("wrong", share(count[WRONG], total), "2 %"),
        ("of these only for J 1 % off within its interval's reach", str(len(wide)), ""),
        ("neither", share(count[NEITHER], total), ""),
        ("fault of the bench", share(sum(s.fault for s in damaged), total), "0"),
        ("J of `identify` off where an effect is hidden", share(len(off), singles), ""),
        ("right where nothing is wrong (control)", share(sum(s.judgement == RIGHT for s in control), len(control)), ""),
        ("nuisances, strengths", f"{len({s.case.nuisance for s in damaged})}, {len(_strengths(damaged))}", "25, 50"),
        ("seconds a case, median and most", _seconds(scores), ""),
    ]
    return table(("what", "measured", "asked"), lines)


def _identified_off(score: Score) -> bool:
    return bool(inertia_off(score.case.kind, score.case.axis.inertia, score.identified))


def _strengths(scores: Sequence[Score]) -> set[tuple[str, int]]:
    return {(score.case.nuisance, score.case.level) for score in scores}


def _seconds(scores: Sequence[Score]) -> str:
    times = [score.identified.seconds + score.diagnosed.seconds for score in scores]
    return f"{median(times):.1f}, {max(times):.1f}"


def by_nuisance(scores: Sequence[Score]) -> str:
    """Judgements by nuisance and strength, in the order drawn."""
    groups: dict[tuple[str, str], list[Score]] = {}
    for score in scores:
        groups.setdefault((score.case.nuisance, score.case.strength_label), []).append(score)
    rows = []
    for (nuisance, strength), those in groups.items():
        count = Counter(score.judgement for score in those)
        rows.append((nuisance, strength, count[RIGHT], count[NEITHER], count[WRONG]))
    return "## By nuisance\n\n" + table(("nuisance", "strength", "right", "neither", "wrong"), rows)


def not_right(scores: Sequence[Score]) -> str:
    """Cases that are not right, the wrong ones first."""
    bad = sorted((s for s in scores if s.judgement != RIGHT), key=lambda score: score.judgement != WRONG)
    rows = []
    for score in bad:
        case, said = score.case, score.diagnosed
        why = "; ".join(score.reasons)
        cells = (case.name, case.strength_label, case.hidden, score.judgement, why, said.verdict, ", ".join(said.named))
        rows.append(cells)
    heads = ("case", "strength", "hidden", "judgement", "why", "verdict", "named")
    return "## Not right\n\n" + (table(heads, rows) if bad else "None.")


def cases_csv(scores: Sequence[Score]) -> str:
    """One line a case."""
    rows = []
    for score in scores:
        case, identified, diagnosed = score.case, score.identified, score.diagnosed
        rows.append(
            (
                *(case.name, case.nuisance, case.strength_label, case.hidden, int(case.references)),
                *(score.judgement, "; ".join(score.reasons), identified.status, _error(score, identified)),
                *(diagnosed.status, diagnosed.verdict, "+".join(diagnosed.named), _error(score, diagnosed)),
                *(_half_widths(score), f"{identified.seconds + diagnosed.seconds:.1f}"),
                diagnosed.said,
            )
        )
    return csv_of(HEADINGS, rows)


def _error(score: Score, answer) -> str:
    return "" if answer.inertia is None else f"{answer.inertia[0] / score.case.axis.inertia - 1.0:.2e}"


def _half_widths(score: Score) -> str:
    found = score.diagnosed.inertia
    if found is None or found[2] <= found[1]:
        return ""
    return f"{2.0 * abs(found[0] - score.case.axis.inertia) / (found[2] - found[1]):.2f}"
