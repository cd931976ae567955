"""False alarms and detections of `bench check`, in tables: `--axes 1000 --out docs/check`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import track

from tests.studies.false_alarms.draw import (
    Again,
    Drawn,
    as_it_was,
    drawn,
    heavier,
    more_friction,
    moved_otherwise,
    recorded,
    rigs,
    sampled_otherwise,
    with_effect,
)
from tests.studies.false_alarms.run import SHOWN, Answers, allows, answer, observed
from tests.studies.false_alarms.table import markdown
from tests.studies.frame import publish

#: Spread between recordings in their own errors.
SPREADS = {"none": 0.0, "small": 1.0 / 3.0, "equal to within": 1.0}
#: Recordings of the larger baseline.
SEVERAL = 5
#: What changes, how it is made, and the name under which it is to be found.
CHANGES: dict[str, tuple[Callable[[Drawn], Again], str]] = {
    "+10 % Coulomb friction": (more_friction, "coulomb_friction_torque"),
    "+2 % inertia": (heavier, "moment_of_inertia"),
    "weak backlash appears": (partial(with_effect, name="backlash"), "backlash"),
    "weak cogging appears": (partial(with_effect, name="cogging_torque"), "cogging_torque"),
}
#: By how much, of quantities that are not there or gone.
BY = {"coulomb_friction_torque": 0.1, "moment_of_inertia": 0.02}
OTHERWISE = {"another motion": moved_otherwise, "half the samples": sampled_otherwise}
#: Recordings simulated together.
TOGETHER = 400


def unchanged(axes: list[Drawn], seed: int, spread: float, count: int) -> Answers:
    """Parameters of unchanged axes against a baseline of so many recordings."""
    found, rng, each = Answers(), np.random.default_rng([seed, count]), count + 1
    for batch in _batches(axes, f"unchanged, spread {spread:.2g}, baseline of {count}", each):
        runs = recorded(
            [as_it_was(one, spread, rng) for one in batch for _ in range(each)], seed, each * batch[0].number
        )
        for k, rig in enumerate(rigs(batch)):
            traces = [run.trace for run in runs[k * each : (k + 1) * each]]
            found.add(answer(observed(traces[:-1], rig, False), observed(traces[-1:], rig, False), rig))
    return found


def changes(axes: list[Drawn], seed: int, names: bool) -> dict[str, Answers]:
    """Axes as they were, with one thing changed each time, and recorded otherwise, against one recording."""
    wanted = {name: made for name, (made, _) in CHANGES.items()} | OTHERWISE
    found = {name: Answers() for name in ("unchanged", *wanted)}
    for batch in _batches(axes, f"changes, {'with' if names else 'without'} names", 2 + len(wanted)):
        again = [
            one for each in batch for one in (as_it_was(each), as_it_was(each), *(m(each) for m in wanted.values()))
        ]
        runs = recorded(again, seed, len(again) // len(batch) * batch[0].number)
        each = len(again) // len(batch)
        for k, rig in enumerate(rigs(batch)):
            first, *others = runs[k * each : (k + 1) * each]
            baseline = observed([first.trace], rig, names)
            same = answer(baseline, observed([others[0].trace], rig, names), rig)
            found["unchanged"].add(same)
            for name, run in zip(wanted, others[1:], strict=True):
                _, what = CHANGES.get(name, (None, ""))
                possible = allows(same, what, BY[what]) if what in BY else bool(what) and names and run.ratio > SHOWN
                found[name].add(answer(baseline, observed([run.trace], rig, names), rig), possible, what)
    return found


def _batches(axes: list[Drawn], what: str, each: int) -> Iterable[list[Drawn]]:
    """Axes in batches whose recordings, so many of each, are simulated together."""
    size = max(1, TOGETHER // each)
    return track([axes[k : k + size] for k in range(0, len(axes), size)], what, console=Console(stderr=True))


def main(
    axes: Annotated[int, typer.Option(min=1, help="Unchanged axes against one recording, over all spreads.")] = 1000,
    several: Annotated[int, typer.Option(min=1, help="The same against several recordings.")] = 150,
    changed: Annotated[int, typer.Option(min=1, help="Axes that are changed, without names.")] = 100,
    named: Annotated[int, typer.Option(min=1, help="Axes that are changed, with names.")] = 30,
    seed: int = 1,
    out: Annotated[Path | None, typer.Option(help="Folder for table.md.")] = None,
) -> None:
    """Check unchanged and changed axes; print tables."""
    counts = f"--axes {axes} --several {several} --changed {changed} --named {named} --seed {seed}"
    parts: dict[str, Answers] = {}

    def table() -> str:
        text = markdown(parts, f"python -m tests.studies.false_alarms {counts}")
        publish(out, {"table.md": text})
        return text

    for names, number, how in ((False, changed, "without names"), (True, named, "with names")):
        found = changes(drawn(number, 100 * seed + 50 + names), seed, names)
        parts |= {f"{name}, {how}": answers for name, answers in found.items()}
        table()
    for place, (name, spread) in enumerate(SPREADS.items()):
        for count, number in ((1, axes), (SEVERAL, several)):
            drawn_axes = drawn(-(-number // len(SPREADS)), 100 * seed + 10 * place + count)
            what = f"unchanged, spread {name}, baseline of {count} recording{'s' * (count > 1)}"
            parts[what] = unchanged(drawn_axes, seed, spread, count)
            table()
    typer.echo(table())


if __name__ == "__main__":
    typer.run(main)
