"""Faults that change the motion, and motions that differ: `python -m tests.studies.false_alarms.motion`.

Parameters and torque gap alone, so that every effect is one that no model holds: the hardest for what is said of
another motion. The motion of one of the two recordings, drawn by lot, is smaller by a share.
"""

from __future__ import annotations

from collections import Counter
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from scipy.stats import binomtest

from bench.baseline.check import Checked
from bench.baseline.state import TORQUE_GAP
from tests.studies.false_alarms.draw import Again, Drawn, as_it_was, drawn, recorded, rigs, smaller, with_effect
from tests.studies.false_alarms.run import answer, observed
from tests.studies.frame import publish, table

#: Shares by which one of the two motions is smaller.
DIFFER = (0.0, 0.05, 0.15, 0.3)
#: Faults that appear, weak as the blind set's are; and what an unchanged axis has all along.
FAULTS = ("backlash", "cogging_torque", "stribeck_friction", "presliding_friction")
#: A gap that rises so much is to be called changed.
RISES = 5.0
#: Axes that are simulated together.
BATCH = 125
#: Whether the fault appears, and what that is called.
SETS = ((True, "a weak fault appears"), (False, "a weak fault is there all along"))
HEADS = ("what", "one motion smaller by", "checks", "refused", "same", "undecided", "changed", "share", "rises")
HEADS += ("of these changed",)
NOTE = f"""Recordings of the independent integrator, 4 s each, parameters and torque gap without names.
`rises`: checks in which the torque gap is {RISES:g} times the baseline's or more. Bounds are Clopper and Pearson's
at 95 %."""


def share(count: int, of: int) -> str:
    """A share with its bounds."""
    found = binomtest(count, max(of, 1)).proportion_ci(0.95, "exact")
    return f"{count / max(of, 1):.1%} ({found.low:.1%} to {found.high:.1%})"


def pair(one: Drawn, fault: str, by: float, appears: bool) -> tuple[Again, Again]:
    """An axis then and now."""
    made = partial(with_effect, one, fault)
    both = (as_it_was(one) if appears else made(), made())
    first = bool(np.random.default_rng([one.number, 23]).integers(2))
    return (smaller(both[0], by), both[1]) if first else (both[0], smaller(both[1], by))


def risen(checked: Checked) -> bool:
    """Whether the torque gap has."""
    gap = next(one for one in checked.comparisons if one.name == TORQUE_GAP)
    assert gap.now is not None
    assert gap.baseline is not None
    return gap.now > RISES * gap.baseline


def counted(axes: list[Drawn], by: float, appears: bool, seed: int, results: Counter[str]) -> None:
    """Count what checks answer where one motion is smaller."""
    pairs = [pair(one, FAULTS[one.number % len(FAULTS)], by, appears) for one in axes]
    runs = recorded([one for both in pairs for one in both], seed, 2 * axes[0].number)
    for k, rig in enumerate(rigs(axes)):
        then, now = (observed([run.trace], rig, False) for run in runs[2 * k : 2 * k + 2])
        checked = answer(then, now, rig)
        results["refused" if checked is None else checked.result] += 1
        if checked is not None and risen(checked):
            results["rises"] += 1
            results["rises, changed"] += checked.result == "changed"
        if checked is not None and not appears and checked.result == "changed":
            results.update(f"in {one.name}" for one in checked.comparisons if one.result == "changed")


def main(
    axes: int = 125, seed: int = 1, out: Annotated[Path | None, typer.Option(help="Folder for motion.md.")] = None
) -> None:
    """Check them all; print and write the table."""
    lines: list[list[object]] = []
    command = f"python -m tests.studies.false_alarms.motion --axes {axes} --seed {seed}"
    called: Counter[str] = Counter()
    for appears, what in SETS:
        for by in DIFFER:
            found: Counter[str] = Counter()
            for first in range(0, axes, BATCH):
                counted(drawn(axes, 100 * seed + 7)[first : first + BATCH], by, appears, seed, found)
            answered = sum(found[result] for result in ("same", "undecided", "changed"))
            counts = [found[result] for result in ("refused", "same", "undecided", "changed")]
            rises = [found["rises"], share(found["rises, changed"], found["rises"]) if found["rises"] else "-"]
            lines.append([what, f"{by:.0%}", answered + counts[0], *counts, share(found["changed"], answered), *rises])
            typer.echo(" | ".join(map(str, lines[-1])))
            called.update({name: count for name, count in found.items() if name.startswith("in ")})
            text = ["# Faults and motions that differ", "", f"`{command}`", "", NOTE, "", table(HEADS, lines), ""]
            text += [f"Unchanged axes are called changed {name}: {count}." for name, count in called.most_common()]
            publish(out, {"motion.md": "\n".join(text).rstrip() + "\n"})


if __name__ == "__main__":
    typer.run(main)
