"""Conclusions from a fleet's table: which axes changed and since when, what was named, and which axes need attention
and why.

An axis changed where inertia or friction of its recordings steps (`bench.fleet.change_point`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, OFFSET, VISCOUS
from bench.comparison.difference import holm
from bench.fleet.change_point import ChangePoint, change_point
from bench.fleet.evaluate import PlannedRecording
from bench.fleet.manifest import Manifest
from bench.fleet.store import Plain
from bench.names import percent

#: Chance of a report that any axis changed of a fleet in which none did.
ALARM = 0.01
#: Standard errors over the median one beyond which a recording determines too little of a quantity to be compared.
VAGUE = 5.0
#: Quantities of the axis itself; what follows from them, or is the drive's, would be reported twice.
COMPARED = (INERTIA, VISCOUS, COULOMB, OFFSET)
#: Share of the effort's variance below which the model of an axis misses too much to be believed unseen.
EXPLAINED = 0.9
STATUSES = ("done", "missing", "refused", "failed", "timed_out")
#: Why an axis needs attention, from gravest to least.
KINDS = ("failed", "timed_out", "missing", "refused", "unexplained", "checks")


@dataclass(frozen=True)
class History:
    """One quantity by the recordings of one axis, by the name of the contract, in the order of time.

    Rows of the manifest, and values with their standard errors (n,).
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
        step: by how much, and how sure.
        since: time of the first recording after the change, as the manifest has it; `file`: that recording.
        chance: that a fleet without a change shows one like it anywhere, at most.
    """

    history: History
    step: ChangePoint
    since: str
    file: str
    chance: float

    @property
    def axis(self) -> str:
        """Whose it is."""
        return self.history.axis

    @property
    def counts(self) -> tuple[int, int]:
        """Recordings before and after."""
        return self.step.place, len(self.history.rows) - self.step.place


@dataclass(frozen=True)
class ShownEffect:
    """An effect that so many recordings show, `of` those of the axis that were diagnosed, `since` a time."""

    axis: str
    name: str
    recordings: int
    of: int
    since: str


@dataclass(frozen=True)
class Concern:
    """Why an axis needs attention, one of `KINDS`: in so many recordings `of` the axis, the latest and its reason."""

    axis: str
    kind: str
    recordings: int
    of: int
    file: str
    reason: str


@dataclass(frozen=True)
class AxisSummary:
    """The part of a summary that is of one axis, each as `Summary` has it."""

    name: str
    rows: Sequence[int]
    histories: Sequence[History]
    changed: Sequence[Changed]
    shown: Sequence[ShownEffect]
    concerns: Sequence[Concern]


@dataclass(frozen=True)
class Summary:
    """Of a fleet.

    Attributes:
        rows: of the manifest, by axis, in the order of time; those without a time come last.
        histories: each quantity over them.
        counts: recordings of each status.
        compared: series of a quantity over the recordings of an axis in which a change could be sought.
        changed: surest first.
        shown: effects, those shown by most recordings of their axis first.
        concerns: gravest first.
    """

    counts: Mapping[str, int]
    rows: Mapping[str, Sequence[int]]
    histories: Sequence[History]
    compared: int
    changed: tuple[Changed, ...]
    shown: tuple[ShownEffect, ...]
    concerns: tuple[Concern, ...]

    @property
    def axes(self) -> int:
        """How many there are."""
        return len(self.rows)

    def by_need(self) -> list[AxisSummary]:
        """Each axis: what changed comes first, the surest foremost, then the gravest concern, then all others."""
        parts = [_by_axis(each) for each in (self.histories, self.changed, self.shown, self.concerns)]
        order = dict.fromkeys((*parts[1], *parts[3], *self.rows))
        return [AxisSummary(axis, self.rows[axis], *(part.get(axis, ()) for part in parts)) for axis in order]


def _by_axis(found: Iterable[Any]) -> dict[str, list[Any]]:
    """Parts of a summary by the axis that each is of."""
    groups: dict[str, list[Any]] = {}
    for one in found:
        groups.setdefault(one.axis, []).append(one)
    return groups


def summarise(manifest: Manifest, planned: Sequence[PlannedRecording], results: Sequence[Plain]) -> Summary:
    """Look over a fleet: its recordings as planned and their results, (n,) each as the manifest's rows."""
    order = np.argsort(manifest.times, kind="stable").tolist()  # recordings without a time come last
    rows: dict[str, list[int]] = {}
    axes, files, times = (manifest.text(column) for column in ("axis", "file", "time"))
    for row in order:
        rows.setdefault(axes[row], []).append(row)
    histories = tuple(_histories(manifest, planned, results, order))
    compared, changed = _changes(manifest, histories)
    shown = [one for axis, own in rows.items() for one in _shown(axis, times, results, own)]
    concerns = [one for axis, own in rows.items() for one in _concerns(axis, files, results, own)]
    counts = Counter(found["status"] for found in results)
    return Summary(
        counts={status: counts[status] for status in STATUSES},
        rows=rows,
        histories=histories,
        compared=compared,
        changed=changed,
        shown=tuple(sorted(shown, key=lambda one: (-one.recordings / one.of, one.axis, one.name))),
        concerns=tuple(sorted(concerns, key=lambda one: (KINDS.index(one.kind), -one.recordings / one.of, one.axis))),
    )


def _changes(manifest: Manifest, histories: Sequence[History]) -> tuple[int, tuple[Changed, ...]]:
    """How many histories could be compared, and the steps that stand out of all of them together, surest first."""
    steps = [(one, found) for one in histories if (found := change_point(one.values, one.errors)) is not None]
    files, times = manifest.text("file"), manifest.text("time")
    chances = holm(np.array([step.chance for _, step in steps])).tolist()
    changed = []
    for (one, step), chance in sorted(zip(steps, chances, strict=True), key=lambda each: each[0][1].chance):
        first = one.rows[step.place]
        if chance < ALARM:
            changed.append(Changed(one, step, times[first], files[first], chance))
    return len(steps), tuple(changed)


def _histories(
    manifest: Manifest, planned: Sequence[PlannedRecording], results: Sequence[Plain], order: Sequence[int]
) -> Iterator[History]:
    """Of what was recorded at a known time and evaluated by one rig: another rig is no other axis, but other values."""
    axes, times = manifest.text("axis"), manifest.times
    groups: dict[tuple[str, str, str, str], list[tuple[int, float, float]]] = {}
    for row in order:
        job, parameters = planned[row].job, results[row].get("parameters", {})
        if job is None or np.isnan(times[row]) or results[row]["status"] != "done":
            continue
        for name in map(job.rig.axis_kind.parameter, COMPARED):
            found = parameters.get(name)
            if found is not None and found["std_error"] is not None:
                key = (axes[row], planned[row].basis["rig_sha256"], name, found["unit"])
                groups.setdefault(key, []).append((row, found["value"], found["std_error"]))
    for (axis, _, name, unit), found in groups.items():
        vague = VAGUE * median(error for *_, error in found)
        rows, values, errors = zip(*(one for one in found if one[-1] <= vague), strict=True)
        yield History(axis, name, unit, rows, np.array(values), np.array(errors))


def _shown(axis: str, times: Sequence[str], results: Sequence[Plain], rows: Sequence[int]) -> Iterator[ShownEffect]:
    """Effects that recordings of one axis show, in the order of time."""
    diagnosed = {row: {one["name"] for one in results[row]["effects"]} for row in rows if "effects" in results[row]}
    for effect in sorted(set[str]().union(*diagnosed.values())):
        showing = [row for row, names in diagnosed.items() if effect in names]
        yield ShownEffect(axis, effect, len(showing), len(diagnosed), times[showing[0]])


def _concerns(axis: str, files: Sequence[str], results: Sequence[Plain], rows: Sequence[int]) -> Iterator[Concern]:
    """Why the recordings of one axis need attention, in the order of time."""
    reasons = {row: _why(results[row]) for row in rows}
    for kind in KINDS:
        affected = [row for row in rows if kind in reasons[row]]
        if affected:
            last = affected[-1]
            yield Concern(axis, kind, len(affected), len(rows), files[last], reasons[last][kind])


def _why(found: Plain) -> dict[str, str]:
    """What of one recording needs attention, by kind."""
    if found["status"] != "done":
        return {found["status"]: found["reason"]}
    why, explained = {}, found["explained"]
    if found.get("verdict") == "unexplained_remainder":
        why["unexplained"] = "no effect of the catalogue explains the residual"
    elif "verdict" not in found and explained is not None and explained < EXPLAINED:
        share = f"inertia and friction explain only {percent(explained)} of the effort"
        why["unexplained"] = f"{share}; add `--diagnose` to search for the missing effects"
    if found["checks"]:
        why["checks"] = "; ".join(f"{check['name']}: {check['found']}" for check in found["checks"])
    return why
