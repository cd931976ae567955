"""Below the page of a fleet: one of each axis, with its quantities over time, and one of each recording."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from bench.arrays import NORMAL95, Array
from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.comparison.spread import FEWEST, expected
from bench.fleet.fleet import Fleet
from bench.fleet.store import Plain
from bench.fleet.summary import AxisSummary, Changed, History
from bench.names import short, words
from bench.parameter import Parameter
from bench.report import document as doc
from bench.report.numbers import SPACE, brief, chance, listed, number, sentence, share
from bench.report.parts import one_panel, parameters_table

FLEET = "fleet.html"
#: Recordings in a chart and in a table: those around a change, and the latest.
DOTS = 200
#: Characters of a name.
NAME = 80
#: Seconds of the units that times are given in, the largest first.
CLOCK = {"d": 86400.0, "h": 3600.0, "min": 60.0, "s": 1.0}
#: Of these units there are at least so many from the first recording to the last.
SEVERAL = 3.0
#: What the table of a fleet and of an axis has of the latest values.
SHOWN = (INERTIA, VISCOUS, COULOMB)


@dataclass(frozen=True)
class FleetPages:
    """The pages below a fleet's, and where they lie; `provenance`: of the fleet's page."""

    fleet: Fleet
    provenance: Mapping[str, Any]

    @cached_property
    def times(self) -> Array:
        """When each was recorded (n,), as the manifest has it."""
        return self.fleet.manifest.times

    @cached_property
    def text_of(self) -> dict[str, list[str]]:
        """Columns of the manifest as text (n,)."""
        return {column: self.fleet.manifest.text(column) for column in ("file", "time")}

    @cached_property
    def commands(self) -> list[str]:
        """What shows a recording with all that was measured (n,)."""
        places = zip(*(self.fleet.manifest.located(column) for column in ("file", "rig")), strict=True)
        return [f"bench diagnose {shlex.quote(file)} --rig {shlex.quote(rig)} --out found" for file, rig in places]

    def axis_place(self, axis: str) -> str:
        """Where the page of an axis lies, in the folder of the fleet: names are any text."""
        return f"axes/{hashlib.sha256(axis.encode('utf-8', 'surrogatepass')).hexdigest()[:16]}.html"

    def recording_place(self, row: int) -> str:
        """Where that of a recording lies, beside its result; empty of one that could not be begun."""
        key = self.fleet.planned[row].key
        return f"results/{key[:2]}/{key}.html" if key else ""

    def parameters(self, row: int) -> list[Parameter | None]:
        """Inertia, viscous and Coulomb friction by one recording."""
        job, found = self.fleet.planned[row].job, parameters(self.fleet.results[row])
        return [None if job is None else found.get(job.rig.axis_kind.parameter(term)) for term in SHOWN]

    def axis(self, axis: AxisSummary) -> doc.Document:
        """The page of an axis."""
        changed = {(one.history.quantity, one.history.rows): one for one in axis.changed}
        drawn = [self.over_time(one, changed.get((one.quantity, one.rows))) for one in axis.histories]
        news = [f"{words(one.history.quantity)} {by_how_much(one)} since {one.since}" for one in axis.changed]
        needs = {words(one.kind): f"{one.recordings} of {one.of} recordings: {one.reason}" for one in axis.concerns}
        shown = [f"{words(one.name)} ({one.recordings} of {one.of}, since {one.since})" for one in axis.shown]
        effects = {"Effects?": sentence(listed(shown))} if shown else {}
        sure = f"{chance(max(one.chance for one in axis.changed))} that nothing changed" if news else ""
        return doc.Document(
            title=f"{short(axis.name, NAME)}: axis",
            subject=f"Axis {short(axis.name, NAME)}: {len(axis.rows)} recordings",
            verdict=sentence(f"{listed(news)}." if news else "No change." if axis.histories else "Nothing to compare."),
            tone="refused" if news else "open" if axis.concerns or not axis.histories else "sure",
            answers={**({"How sure?": sentence(f"{sure}.")} if sure else {}), **effects}
            | {f"{sentence(kind)}?": why for kind, why in needs.items()},
            sections=(
                *([doc.section("time", "Over time", *drawn)] if drawn else []),
                doc.section("recordings", "Recordings", self._recordings(axis)),
                doc.section("fleet", "The fleet", doc.neighbours({f"../{FLEET}": "all axes"})),
            ),
            origin=self._origin(),
        )

    def _recordings(self, axis: AxisSummary) -> doc.Table:
        latest = list(reversed(axis.rows))[:DOTS]
        rows = []
        for row in latest:
            found = self.fleet.results[row]
            values = ["" if one is None else brief(one) for one in self.parameters(row)]
            names = listed(words(one["name"]) for one in found["effects"]) if found.get("effects") else ""
            noted = found["reason"] or "; ".join(words(check["name"]) for check in found["checks"])
            when, file = self.text_of["time"][row], self.text_of["file"][row]
            rows.append((when or file, words(found["status"]), *values, names, short(noted), short(file, NAME)))
        more = f", the latest {DOTS} of {len(axis.rows)}" if len(axis.rows) > DOTS else ""
        headings = ("recording", "status", "inertia>", "viscous>", "Coulomb>", "effects", "noted~", "file")
        marked = (k for k, row in enumerate(latest) if self.fleet.results[row]["status"] != "done")
        made = doc.table(f"The latest first{more}", headings, rows, marked)
        places = (self.recording_place(row) for row in latest)
        return made.model_copy(update={"links": tuple(place and f"../{place}" for place in places)})

    def recording(self, row: int) -> doc.Document:
        """The page of a recording."""
        found, file, when = self.fleet.results[row], self.text_of["file"][row], self.text_of["time"][row]
        axis = self.fleet.manifest.table["axis"][row].as_py() or ""
        values = parameters(found)
        lacking = [
            parameters_table(sentence(words(one["name"])), parameters(one)) for one in found.get("effects") or ()
        ]
        checks = ((words(one["name"]), one["status"], one["found"], one["advice"]) for one in found.get("checks", ()))
        noted = doc.table("Those that did not pass", ("check", "status", "found~", "advice~"), checks)
        warnings = (doc.Points(items=tuple(found["warnings"])),) if found.get("warnings") else ()
        parts = {
            "parameters": ("Parameters", [parameters_table("", values)] if values else []),
            "effects": ("What was missing", lacking),
            "gap": ("What is left", [_gaps(found["gap"])] if found.get("gap") else []),
            "checks": ("Checks and warnings", [*warnings, *([noted] if noted.rows else [])]),
        }
        name = self.recording_place(row).rpartition("/")[2].replace(".html", ".json")
        above = {name: "all of it", f"../../{self.axis_place(axis)}": "the axis", f"../../{FLEET}": "the fleet"}
        graphs = (doc.Paragraph(text="With all that was measured, as graphs:"), doc.Code(text=self.commands[row]))
        digest = found.get("trace_sha256")
        return doc.Document(
            title=f"{short(file, NAME)}: recording of {short(axis, NAME)}",
            subject=f"Recording {short(file, NAME)} of axis {short(axis, NAME)}{when and f', {when}'}",
            verdict=_verdict(found),
            tone="sure" if (good := found["status"] == "done" and not found["checks"]) else "open",
            answers={} if good else {"Noted?": found["reason"] or f"{len(found['checks'])} checks did not pass."},
            sections=(
                *(doc.section(key, heading, *blocks) for key, (heading, blocks) in parts.items() if blocks),
                doc.section("more", "More", *graphs, doc.neighbours(above)),
            ),
            origin=(*self._origin(), *([f"trace sha256 {digest}"] if digest else [])),
        )

    def over_time(self, history: History, changed: Changed | None) -> doc.Chart:
        """A quantity over time, and where the next recording was to be expected before and after its change."""
        count = len(history.rows)
        middle = count - DOTS // 2 if changed is None else changed.step.place
        near = slice(max(0, middle - DOTS // 2), middle + DOTS // 2)
        times, label, unit = self._clock(history.rows)
        drawn, x, values = drawn_values(times, history, near, changed)
        reach = NORMAL95 * history.errors[near]
        if changed is None:
            trend = f"The latest {number(float(history.values[-1]), history.unit)}; no change stands out."
        else:
            step = changed.step
            until, later = np.array([x[0], times[step.place]]), np.array([times[step.place], x[-1]])
            drawn.append(doc.series("mean", "line", "model", until, np.full(2, step.before)))
            drawn.append(doc.series("", "line", "model", later, np.full(2, step.after)))
            trend = (
                f"From {number(step.before)} to {number(step.after, history.unit)}, {by_how_much(changed)}, since "
                f"{changed.since} ({short(changed.file, NAME)})."
            )
        each = "recordings, each with its own interval"
        drawn.append(doc.series(each, "dots", "ink", x, values, (values - reach, values + reach)))
        which = "latest" if changed is None else "nearest to it"
        alternative = trend + ("" if count <= x.size else f" Of {count} recordings the {x.size} {which} are drawn.")
        title = f"{short(history.axis, NAME)}: {words(history.quantity)}."
        return one_panel(title, alternative, (label, unit), (words(history.quantity), history.unit), drawn)

    def _clock(self, rows: Sequence[int]) -> tuple[Array, str, str]:
        """Times of recordings, what they are called, and their unit: of moments, since the first of them."""
        times = self.times[list(rows)]
        if not self.fleet.manifest.dated:
            return times, "time", ""
        since = times - times[0]
        unit = next((unit for unit, size in CLOCK.items() if since[-1] >= SEVERAL * size), "s")
        return since / CLOCK[unit], f"time since {self.text_of['time'][rows[0]]}", unit

    def _origin(self) -> tuple[str, ...]:
        provenance = self.provenance
        return (f"servobench {provenance['version']}; manifest sha256 {provenance['manifest_sha256']}",)


def parameters(result: Plain) -> dict[str, Parameter]:
    """Parameters of a result; without an interval where it knows none."""
    found = {}
    for name, one in result.get("parameters", {}).items():
        error, low, high = np.array([one["std_error"], *one["ci95"]], dtype=np.float64).tolist()  # nan for null
        found[name] = Parameter(one["value"], one["unit"], error, (low, high))
    return found


def _verdict(found: Plain) -> str:
    """The headline of a recording."""
    names = listed(words(one["name"]) for one in found["effects"]) if found.get("effects") else ""
    if found["status"] != "done":
        return f"{sentence(words(found['status']))}: no result."
    match found.get("verdict"):
        case "unexplained_remainder":
            beside = f" beside {names}" if names else ""
            return f"Something is left{beside} that no effect of the catalogue explains."
        case "explained":
            return f"{sentence(names)} {'was' if len(found['effects']) == 1 else 'were'} missing."
        case "nothing_missing":
            return "Inertia and friction explain it: nothing is missing."
        case _:
            explained = found["explained"]
            known = "" if explained is None else f" and explain {share(explained)} of the effort"
            return f"Inertia and friction are known{known}."


def _gaps(gaps: Mapping[str, Plain]) -> doc.Table:
    """What is left of torque (force) and velocity."""

    def shown(value: float | None, unit: str) -> str:
        return "–" if value is None else number(value, unit)

    keys = ("before", "after", "noise_floor")
    rows = ((name, *(shown(gap[key], gap["unit"]) for key in keys)) for name, gap in gaps.items())
    return doc.table("RMS of what the model leaves", ("signal", "before any effect>", "left>", "noise alone>"), rows)


def by_how_much(one: Changed) -> str:
    """By how much a quantity changed, with the interval of 95 %."""
    step = one.step
    difference = step.after - step.before
    if not step.before:
        return f"{difference:+.3g}{SPACE}±{SPACE}{number(step.reach, one.history.unit, 2)}".replace("-", "−")
    text = f"{100.0 * difference / abs(step.before):+.3g}{SPACE}±{SPACE}{share(step.reach / abs(step.before))}"
    return text.replace("-", "−")


def drawn_values(
    x: Array, history: History, near: slice, changed: Changed | None
) -> tuple[list[doc.Series], Array, Array]:
    """Where the next recording was to be expected, before and after a change, and x and values in sight (b,)."""
    places = [] if changed is None else [changed.step.place]
    end = x[near][-1]
    drawn = []
    if history.values.size >= FEWEST:
        bands = expected(history.values, history.errors, *places)
        if places and places[0] <= near.start:
            places, bands = [], bands[1:]
        named = "the next recording (95 %)" + (", as forecast before and after" if places else "")
        # the first is drawn to the end: what came after a change lies outside of it
        for place, (low, high) in zip((near.start, *places), bands, strict=True):
            ends, bounds = np.array([x[place], end]), (np.full(2, low), np.full(2, high))
            drawn.append(doc.series("" if drawn else named, "band", "floor", ends, bounds=bounds))
    return drawn, x[near], history.values[near]
