"""Which axes of a fleet changed, and since when: a step in what their recordings tell of inertia and friction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, OFFSET, VISCOUS
from bench.comparison.difference import holm
from bench.comparison.step import Step, largest_step
from bench.fleet.manifest import Manifest
from bench.fleet.plan import Planned
from bench.fleet.recording import Plain

#: Chance of being told that any axis changed of a fleet in which none did.
ALARM = 0.01
#: Standard errors over the median one beyond which a recording says too little of a quantity to be compared.
VAGUE = 5.0
#: Quantities of the axis itself; what follows from them, or is the drive's, would be told twice.
COMPARED = (INERTIA, VISCOUS, COULOMB, OFFSET)
_UNKNOWN: Plain = {"std_error": None}


@dataclass(frozen=True)
class Series:
    """What the recordings of one axis tell of one quantity, in the order of time.

    Attributes:
        axis, quantity, unit: what it is of.
        rows: of the manifest (n,).
        values, errors: with standard errors (n,).
    """

    axis: str
    quantity: str
    unit: str
    rows: tuple[int, ...]
    values: Array
    errors: Array


@dataclass(frozen=True)
class Changed:
    """A quantity of one axis that is not what it was.

    Attributes:
        axis: of the manifest.
        quantity: by the name of the contract.
        unit: of its values.
        step: by how much, and how sure.
        since: time of the first recording after the change, as the manifest has it.
        file: of that recording.
        counts: recordings before and after.
        chance: that a fleet without a change shows one like it anywhere, at most.
        series: that it was found in.
    """

    axis: str
    quantity: str
    unit: str
    step: Step
    since: str
    file: str
    counts: tuple[int, int]
    chance: float
    series: Series


def changes(
    manifest: Manifest, planned: Sequence[Planned], results: Sequence[Plain], order: Sequence[int]
) -> tuple[int, list[Changed]]:
    """How many series could be compared, and the steps that stand out of all of them together, surest first.

    Args:
        manifest: of the fleet (n rows).
        planned, results: of its recordings (n,).
        order: of its rows by time (n,).
    """
    series = _series(manifest, planned, results, order)
    steps = [(one, found) for one in series if (found := largest_step(one.values, one.errors)) is not None]
    files, times = manifest.text("file"), manifest.text("time")
    chances = holm(np.array([step.chance for _, step in steps]))
    alarms = []
    for (one, step), chance in sorted(zip(steps, chances.tolist(), strict=True), key=lambda each: each[0][1].chance):
        if chance < ALARM:
            first, counts = one.rows[step.place], (step.place, len(one.rows) - step.place)
            alarms.append(
                Changed(one.axis, one.quantity, one.unit, step, times[first], files[first], counts, chance, one)
            )
    return len(steps), alarms


def _series(
    manifest: Manifest, planned: Sequence[Planned], results: Sequence[Plain], order: Sequence[int]
) -> Iterator[Series]:
    """Of what was recorded at a known time and evaluated by one rig: another rig is no other axis, but other values."""
    axes, times = manifest.text("axis"), manifest.times
    groups: dict[tuple[str, str, str, str], list[tuple[int, float, float]]] = {}
    for row in order:
        task = planned[row].task
        if task is None or np.isnan(times[row]) or results[row]["status"] != "done":
            continue
        for name in map(task.rig.axis_kind.parameter, COMPARED):
            found = results[row]["parameters"].get(name, _UNKNOWN)
            if found["std_error"] is not None:
                key = (axes[row], planned[row].basis["rig_sha256"], name, found["unit"])
                groups.setdefault(key, []).append((row, found["value"], found["std_error"]))
    for (axis, _, name, unit), found in groups.items():
        vague = VAGUE * median(error for *_, error in found)
        kept = [one for one in found if one[-1] <= vague]
        rows, values, errors = zip(*kept, strict=True)
        yield Series(axis, name, unit, rows, np.array(values), np.array(errors))
