"""Coverage of intervals, and their width over the error, as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from bench.statistics import NORMAL95

#: Nominal coverages stated.
NOMINAL = (0.95, 0.8, 0.5)
QUANTITIES = ("J", "K_w", "K_0")


@dataclass(frozen=True)
class Outcome:
    """One quantity of one recording.

    Attributes:
        error: found less true, over the true value.
        half_width: of the interval of 95 %, over the true value.
    """

    error: float
    half_width: float

    def inside(self, nominal: float) -> bool:
        """Whether the interval of a nominal coverage holds the truth; narrower ones are scaled by the normal's."""
        return abs(self.error) <= self.half_width * float(stats.norm.ppf(0.5 + 0.5 * nominal)) / NORMAL95


#: Of each quantity, what was found of it, and how many recordings told none.
Found = Mapping[str, Sequence[Outcome]]


def markdown(title: str, groups: Mapping[str, tuple[int, Found]]) -> str:
    """A table of groups of recordings, each their number and what was found in them."""
    head = ["recordings", "n", "quantity", "told", *(f"{nominal:.0%}" for nominal in NOMINAL)]
    head += ["RMS error %", "half width over RMS error"]
    lines = [f"## {title}", "", "| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for name, (count, found) in groups.items():
        lines += [_row(name, count, quantity, found[quantity]) for quantity in QUANTITIES]
    whole = {q: [one for _, found in groups.values() for one in found[q]] for q in QUANTITIES}
    total = sum(count for count, _ in groups.values())
    return "\n".join([*lines, *(_row("**all**", total, quantity, whole[quantity]) for quantity in QUANTITIES)])


def _row(name: str, count: int, quantity: str, found: Sequence[Outcome]) -> str:
    cells = [name, str(count), quantity, str(len(found))]
    if found:
        error, half = (np.array([getattr(one, what) for one in found]) for what in ("error", "half_width"))
        typical = float(np.sqrt(np.mean(error**2)))
        cells += [f"{np.mean([one.inside(nominal) for one in found]):.1%}" for nominal in NOMINAL]
        cells += [f"{100.0 * typical:.3g}", f"{np.sqrt(np.mean(half**2)) / typical:.2f}"]
    return "| " + " | ".join(cells + ["-"] * (9 - len(cells))) + " |"
