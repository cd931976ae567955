"""What became of all cases, in tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from bench.effects.catalogue import catalogue
from bench.validation.coverage import UNEXPLAINED
from bench.validation.into import FATES, PART, RIGHT, WRONG, Own
from tests.studies.blind.score import same, twins
from tests.studies.frame import table
from tests.studies.injected.cases import FAILED, NONE, UNABLE, Row
from tests.studies.injected.sources import Source

#: Edges of the probabilities that are distinguished.
BINS = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)


def markdown(
    rows: Sequence[Row],
    sources: Mapping[str, Source],
    owns: Mapping[str, Own],
    refused: Mapping[str, str],
    command: str,
) -> str:
    """All tables."""
    judged = [row for row in rows if row.fate in FATES]
    real = {name for name, source in sources.items() if source.real}
    parts = [
        "# Known effects put into recordings",
        f"`{command}`",
        headline(judged, {name for name in real if name in owns and owns[name].verdict == UNEXPLAINED}),
        "## By recording and strength",
        grouped(judged, lambda row: ("real" if row.case.source in real else "simulated", f"{row.case.strength:g}")),
        "## How sure",
        reliability(judged),
        "## By effect",
        grouped(judged, lambda row: (row.case.effect, "")),
        "## By recording",
        grouped(judged, lambda row: (row.case.source, "")),
        recordings(owns, refused),
        "## Not right",
        cases([row for row in rows if row.fate not in (RIGHT, UNABLE)]),
    ]
    return "\n\n".join(parts) + "\n"


def headline(rows: Sequence[Row], remaining: Collection[str]) -> str:
    """What it all comes to; `remaining`: real recordings that leave a remainder as they are."""
    inside = [low <= true <= high for row in rows for true, _, low, high in row.quantities.values()]
    fates, answered = Counter(row.fate for row in rows), [row for row in rows if row.sets]
    others = pairs(rows, hidden=False, every=True)
    strengths = sorted({row.case.strength for row in rows})
    named = {each: [row.fate in (RIGHT, PART) for row in rows if row.case.strength == each] for each in strengths}
    found = [
        ("cases", str(len(rows))),
        *((f"named at {strength:g} times", _share(those)) for strength, those in named.items()),
        ("wrong", str(fates[WRONG])),
        ("a false name next to the true one", str(fates[PART])),
        ("mean probability of the true name", f"{sum(row.believed for row in rows) / max(len(rows), 1):.3f}"),
        ("expected calibration error, of all effects", f"{calibration_error(others):.3f}"),
        ("of the true name and those that were considered", f"{calibration_error(pairs(rows, hidden=False)):.3f}"),
        ("the same with what simulated axes contain in addition", f"{calibration_error(pairs(rows)):.3f}"),
        ("sets of 90 % that hold the names", _share([holds(row) for row in answered])),
        ("the same, none where a real axis has a remainder", _share([strictly(row, remaining) for row in answered])),
        ("quantities within their interval of 95 %", _share(inside)),
        ("seconds of CPU of all diagnoses", f"{sum(row.seconds for row in rows):.0f}"),
    ]
    return table(("what", "measured"), found)


def holds(row: Row) -> bool:
    """Whether one of its sets is the effect, and nothing beside it that is not in the recording, too."""
    true, beside = same([row.case.effect]), same(row.hidden)
    return any(names is not None and true <= same(names) <= true | beside for names in row.sets)


def strictly(row: Row, remaining: Collection[str]) -> bool:
    """The same, but in a recording of `remaining` it is right that none of the catalogue is all that is missing."""
    return None in row.sets if row.case.source in remaining else holds(row)


def _share(held: Sequence[bool]) -> str:
    return f"{sum(held)} of {len(held)}, {100.0 * np.mean(held):.1f} %" if held else "none"


def grouped(rows: Sequence[Row], group: Callable[[Row], tuple[str, str]]) -> str:
    """Fates by groups."""
    groups = sorted({group(row) for row in rows})
    lines = []
    for one in groups:
        counted = Counter(row.fate for row in rows if group(row) == one)
        lines.append((" ".join(one).strip(), str(counted.total()), *(str(counted[fate]) for fate in FATES)))
    return table(("of", "cases", *FATES), lines)


def pairs(rows: Iterable[Row], hidden: bool = True, every: bool = False) -> list[tuple[float, bool]]:
    """Probability of each new name, and whether it is there; of two that no recording tells apart, of either.

    Args:
        rows: judged cases.
        hidden: whether names of what a recording holds beside the effect count, visible or not.
        every: whether all effects of the catalogue count, those that were not considered with 0.
    """
    found = []
    for row in rows:
        true, beside = same([row.case.effect]), same(row.hidden)
        stated = dict.fromkeys(same([*catalogue()]) if every else (), 0.0)
        for name, p in row.probabilities.items():
            stated[twins(name)] = stated.get(twins(name), 0.0) + p
        stated.pop(twins(NONE), None)
        found += [(p, name in true | beside) for name, p in stated.items() if hidden or name not in beside - true]
    return found


def calibration_error(stated: Sequence[tuple[float, bool]]) -> float:
    """Mean distance between probability and share that is true, over bins by how many are in them."""
    return sum(len(those) * abs(_mean(those, 0) - _mean(those, 1)) for those in _binned(stated)) / max(len(stated), 1)


def _binned(stated: Sequence[tuple[float, bool]]) -> list[list[tuple[float, bool]]]:
    place = np.searchsorted(BINS, [p for p, _ in stated], side="right").clip(max=len(BINS) - 1)
    return [[one for one, at in zip(stated, place, strict=True) if at == each] for each in range(1, len(BINS))]


def _mean(those: Sequence[tuple[float, bool]], column: int) -> float:
    return float(np.mean([each[column] for each in those])) if those else 0.0


def reliability(rows: Sequence[Row]) -> str:
    """By probability how often a name is there."""
    named = [
        (f"{low:g} to {high:g}", str(len(those)), f"{_mean(those, 0):.3f}", f"{_mean(those, 1):.3f}")
        for (low, high), those in zip(pairwise(BINS), _binned(pairs(rows)), strict=True)
        if those
    ]
    return table(("probability of a name", "names", "mean probability", "share that is there"), named)


def recordings(owns: Mapping[str, Own], refused: Mapping[str, str]) -> str:
    """What the recordings say of themselves."""
    lines = [(name, own.verdict, ", ".join(own.names), f"{own.left:.3g} {own.unit}") for name, own in owns.items()]
    lines += [(name, "refused", reason, "") for name, reason in refused.items()]
    return table(("recording", "its own diagnosis", "names", "left"), lines)


def cases(rows: Sequence[Row]) -> str:
    """Case by case."""
    head = table(("recording", "effect", "strength", "fate", "names", "verdict", "quantities"), ())
    order = {fate: place for place, fate in enumerate((WRONG, FAILED, PART))}
    ordered = sorted(rows, key=lambda row: (order.get(row.fate, len(order)), row.case.name))
    return "\n".join([head, *(row.line for row in ordered)])
