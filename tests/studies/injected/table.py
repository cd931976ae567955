"""What became of all cases, in tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from bench.validation.into import FATES, PART, RIGHT, WRONG, Own
from tests.studies.blind.score import same, twins
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
        headline(judged),
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


def headline(rows: Sequence[Row]) -> str:
    """What it all comes to."""
    inside = [low <= true <= high for row in rows for true, _, low, high in row.quantities.values()]
    fates = Counter(row.fate for row in rows)
    strengths = sorted({row.case.strength for row in rows})
    named = {each: [row.fate in (RIGHT, PART) for row in rows if row.case.strength == each] for each in strengths}
    found = [
        ("cases", str(len(rows))),
        *((f"named at {strength:g} times", _share(those)) for strength, those in named.items()),
        ("wrong", str(fates[WRONG])),
        ("a false name beside the true one", str(fates[PART])),
        ("mean probability of the true name", f"{sum(row.believed for row in rows) / max(len(rows), 1):.3f}"),
        ("expected calibration error, of names", f"{calibration_error(pairs(rows)):.3f}"),
        ("the same, but for what simulated axes hold besides", f"{calibration_error(pairs(rows, hidden=False)):.3f}"),
        ("sets of 90 % that hold the truth", _share([row.held for row in rows if row.held is not None])),
        ("quantities within their interval of 95 %", _share(inside)),
        ("seconds of CPU of all diagnoses", f"{sum(row.seconds for row in rows):.0f}"),
    ]
    return _table(("what", "measured"), found)


def _share(held: Sequence[bool]) -> str:
    return f"{sum(held)} of {len(held)}, {100.0 * np.mean(held):.1f} %" if held else "none"


def grouped(rows: Sequence[Row], group: Callable[[Row], tuple[str, str]]) -> str:
    """Fates by groups."""
    groups = sorted({group(row) for row in rows})
    lines = []
    for one in groups:
        counted = Counter(row.fate for row in rows if group(row) == one)
        lines.append((" ".join(one).strip(), str(counted.total()), *(str(counted[fate]) for fate in FATES)))
    return _table(("of", "cases", *FATES), lines)


def pairs(rows: Iterable[Row], hidden: bool = True) -> list[tuple[float, bool]]:
    """Probability of each new name, and whether it is there; what no catalogue holds never is.

    Args:
        rows: judged cases.
        hidden: whether names of what a recording holds beside the effect count, visible or not.
    """
    there = [(row, same([row.case.effect]), same(row.hidden)) for row in rows]
    return [
        (p, twins(name) in true | beside)
        for row, true, beside in there
        for name, p in row.probabilities.items()
        if name != NONE and (hidden or twins(name) not in beside - true)
    ]


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
    return _table(("probability of a name", "names", "mean probability", "share that is there"), named)


def recordings(owns: Mapping[str, Own], refused: Mapping[str, str]) -> str:
    """What the recordings say of themselves."""
    lines = [(name, own.verdict, ", ".join(own.names), f"{own.left:.3g} {own.unit}") for name, own in owns.items()]
    lines += [(name, "refused", reason, "") for name, reason in refused.items()]
    return _table(("recording", "its own diagnosis", "names", "left"), lines)


def cases(rows: Sequence[Row]) -> str:
    """Case by case."""
    head = "| recording | effect | strength | fate | names | verdict | quantities |\n" + "|---" * 7 + "|"
    order = {fate: place for place, fate in enumerate((WRONG, FAILED, PART))}
    ordered = sorted(rows, key=lambda row: (order.get(row.fate, len(order)), row.case.name))
    return "\n".join([head, *(row.line for row in ordered)])


def _table(headings: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    head = f"| {' | '.join(headings)} |\n{'|---' * len(headings)}|"
    return "\n".join([head, *(f"| {' | '.join(line)} |" for line in lines)])
