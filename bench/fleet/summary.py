"""What a fleet's table says: which axes changed and since when, and which need a person and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from bench.arrays import Array
from bench.fleet.change import Change, change
from bench.fleet.manifest import Manifest
from bench.fleet.plan import Planned
from bench.fleet.recording import Plain

#: Chance of being told that any axis changed of a fleet in which none did.
ALARM = 0.01
#: Share of the effort's variance below which the model of an axis misses too much to be believed unseen.
EXPLAINED = 0.9
#: Standard errors over the median one beyond which a recording says too little of a quantity to be compared.
VAGUE = 5.0
STATUSES = ("done", "refused", "failed", "timed_out")


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
    """

    axis: str
    quantity: str
    unit: str
    step: Change
    since: str
    file: str
    counts: tuple[int, int]
    chance: float


@dataclass(frozen=True)
class Concern:
    """Why a person should look at an axis.

    Attributes:
        axis: of the manifest.
        kind: `timed_out`, `failed`, `refused`, `unexplained` or `checks`.
        count: recordings that it holds for.
        of: recordings of the axis.
        file: the latest of them.
        reason: of that one.
    """

    axis: str
    kind: str
    count: int
    of: int
    file: str
    reason: str


@dataclass(frozen=True)
class Summary:
    """Of a fleet.

    Attributes:
        counts: recordings of each status.
        axes: how many there are.
        compared: series of a quantity over the recordings of an axis in which a change could be sought.
        changed: surest first.
        concerns: gravest first.
    """

    counts: Mapping[str, int]
    axes: int
    compared: int
    changed: tuple[Changed, ...]
    concerns: tuple[Concern, ...]


def summarise(manifest: Manifest, planned: Sequence[Planned], results: Sequence[Plain]) -> Summary:
    """Look over a fleet.

    Args:
        manifest: of the fleet (n rows).
        planned: its recordings (n,).
        results: theirs (n,).
    """
    axes = manifest.text("axis")
    files = manifest.text("file")
    in_time = np.argsort(manifest.times, kind="stable")  # recordings without a time come last
    order = sorted(in_time.tolist(), key=lambda row: axes[row])
    series = list(_series(manifest, planned, results, order))
    steps = [(one, found) for one in series if (found := change(one.values, one.errors)) is not None]
    concerns = [one for rows in _by(axes, order).values() for one in _concerns(axes, files, results, rows)]
    return Summary(
        counts={status: Counter(found["status"] for found in results)[status] for status in STATUSES},
        axes=len(set(axes)),
        compared=len(steps),
        changed=tuple(_changed(manifest, steps)),
        concerns=tuple(sorted(concerns, key=lambda one: (KINDS.index(one.kind), -one.count / one.of, one.axis))),
    )


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


def _series(
    manifest: Manifest, planned: Sequence[Planned], results: Sequence[Plain], order: Sequence[int]
) -> Iterator[Series]:
    """Of what was recorded at a known time and evaluated by one rig: another rig is no other axis, but other values."""
    axes, times = manifest.text("axis"), manifest.times
    told: dict[tuple[str, str, str, str], list[tuple[int, float, float]]] = {}
    for row in order:
        if np.isnan(times[row]) or results[row]["status"] != "done":
            continue
        for name, found in results[row]["parameters"].items():
            if found["std_error"] is not None:
                key = (axes[row], planned[row].basis["rig_sha256"], name, found["unit"])
                told.setdefault(key, []).append((row, found["value"], found["std_error"]))
    for (axis, _, name, unit), found in told.items():
        vague = VAGUE * median(error for *_, error in found)
        kept = [one for one in found if one[-1] <= vague]
        rows, values, errors = zip(*kept, strict=True)
        yield Series(axis, name, unit, rows, np.array(values), np.array(errors))


def _changed(manifest: Manifest, steps: Sequence[tuple[Series, Change]]) -> Iterator[Changed]:
    """Steps that stand out of all series together (S. Holm, Scandinavian Journal of Statistics 6(2), 1979, 65-70)."""
    files, times = manifest.text("file"), manifest.text("time")
    chance = 0.0
    for place, (one, step) in enumerate(sorted(steps, key=lambda each: each[1].chance)):
        chance = max(chance, min(1.0, (len(steps) - place) * step.chance))
        if chance >= ALARM:
            return
        first = one.rows[step.place]
        counts = (step.place, len(one.rows) - step.place)
        yield Changed(one.axis, one.quantity, one.unit, step, times[first], files[first], counts, chance)


def _by(axes: Sequence[str], order: Sequence[int]) -> dict[str, list[int]]:
    """Rows of each axis, in the order given."""
    rows: dict[str, list[int]] = {}
    for row in order:
        rows.setdefault(axes[row], []).append(row)
    return rows


#: From gravest to least.
KINDS = ("timed_out", "failed", "unexplained", "refused", "checks")


def _concerns(
    axes: Sequence[str], files: Sequence[str], results: Sequence[Plain], rows: Sequence[int]
) -> Iterator[Concern]:
    """Why a person should look at the recordings of one axis, in the order of time."""
    told = {row: _why(results[row]) for row in rows}
    for kind in KINDS:
        affected = [row for row in rows if kind in told[row]]
        if affected:
            last = affected[-1]
            yield Concern(axes[last], kind, len(affected), len(rows), files[last], told[last][kind])


def _why(found: Plain) -> dict[str, str]:
    """What of one recording needs a person, by kind."""
    if found["status"] != "done":
        return {found["status"]: found["reason"]}
    why = {}
    explained = found.get("explained")
    if found.get("verdict") == "unexplained_remainder":
        why["unexplained"] = "something is left that no effect of the catalogue explains"
    elif "verdict" not in found and explained is not None and explained < EXPLAINED:
        why["unexplained"] = (
            f"inertia and friction explain only {explained:.0%} of the effort; --diagnose says what is missing"
        )
    if found["checks"]:
        why["checks"] = "; ".join(f"{check['name']}: {check['found']}" for check in found["checks"])
    return why
