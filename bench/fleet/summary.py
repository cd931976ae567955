"""What a fleet's table says: which axes changed and since when, what was named, and who needs a person and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.fleet.changed import Changed, changes
from bench.fleet.manifest import Manifest
from bench.fleet.plan import Planned
from bench.fleet.recording import Plain

#: Share of the effort's variance below which the model of an axis misses too much to be believed unseen.
EXPLAINED = 0.9
STATUSES = ("done", "refused", "failed", "timed_out")
#: Why a person should look, from gravest to least.
KINDS = ("failed", "timed_out", "refused", "unexplained", "checks")


@dataclass(frozen=True)
class Named:
    """An effect that recordings of an axis show.

    Attributes:
        axis: of the manifest.
        effect: its name.
        count: recordings that show it.
        of: recordings of the axis that were diagnosed.
        since: time of the first of them, as the manifest has it.
    """

    axis: str
    effect: str
    count: int
    of: int
    since: str


@dataclass(frozen=True)
class Concern:
    """Why a person should look at an axis.

    Attributes:
        axis: of the manifest.
        kind: one of `KINDS`.
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
        named: effects, those shown by most recordings of their axis first.
        concerns: gravest first.
    """

    counts: Mapping[str, int]
    axes: int
    compared: int
    changed: tuple[Changed, ...]
    named: tuple[Named, ...]
    concerns: tuple[Concern, ...]


def summarise(manifest: Manifest, planned: Sequence[Planned], results: Sequence[Plain]) -> Summary:
    """Look over a fleet.

    Args:
        manifest: of the fleet (n rows).
        planned: its recordings (n,).
        results: theirs (n,).
    """
    order = np.argsort(manifest.times, kind="stable").tolist()  # recordings without a time come last
    rows: dict[str, list[int]] = {}
    axes, files, times = (manifest.text(column) for column in ("axis", "file", "time"))
    for row in order:
        rows.setdefault(axes[row], []).append(row)
    compared, changed = changes(manifest, planned, results, order)
    named = [one for axis, own in rows.items() for one in _named(axis, times, results, own)]
    concerns = [one for axis, own in rows.items() for one in _concerns(axis, files, results, own)]
    counts = Counter(found["status"] for found in results)
    return Summary(
        counts={status: counts[status] for status in STATUSES},
        axes=len(rows),
        compared=compared,
        changed=tuple(changed),
        named=tuple(sorted(named, key=lambda one: (-one.count / one.of, one.axis, one.effect))),
        concerns=tuple(sorted(concerns, key=lambda one: (KINDS.index(one.kind), -one.count / one.of, one.axis))),
    )


def _named(axis: str, times: Sequence[str], results: Sequence[Plain], rows: Sequence[int]) -> Iterator[Named]:
    """Effects that recordings of one axis show, in the order of time."""
    diagnosed = {row: {one["name"] for one in results[row]["effects"]} for row in rows if "effects" in results[row]}
    for effect in sorted(set[str]().union(*diagnosed.values())):
        showing = [row for row, names in diagnosed.items() if effect in names]
        yield Named(axis, effect, len(showing), len(diagnosed), times[showing[0]])


def _concerns(axis: str, files: Sequence[str], results: Sequence[Plain], rows: Sequence[int]) -> Iterator[Concern]:
    """Why a person should look at the recordings of one axis, in the order of time."""
    reasons = {row: _why(results[row]) for row in rows}
    for kind in KINDS:
        affected = [row for row in rows if kind in reasons[row]]
        if affected:
            last = affected[-1]
            yield Concern(axis, kind, len(affected), len(rows), files[last], reasons[last][kind])


def _why(found: Plain) -> dict[str, str]:
    """What of one recording needs a person, by kind."""
    if found["status"] != "done":
        return {found["status"]: found["reason"]}
    why, explained = {}, found["explained"]
    if found.get("verdict") == "unexplained_remainder":
        why["unexplained"] = "something is left that no effect of the catalogue explains"
    elif "verdict" not in found and explained is not None and explained < EXPLAINED:
        share = f"inertia and friction explain only {explained:.0%} of the effort"
        why["unexplained"] = f"{share}; --diagnose says what is missing"
    if found["checks"]:
        why["checks"] = "; ".join(f"{check['name']}: {check['found']}" for check in found["checks"])
    return why
