"""A fleet: every axis by how much it needs attention and why, what changed since when, and how the recordings went.

As the contract's JSON (`bench.fleet/1`), which has all, and as a document, which stays small however large a fleet is;
below it a page of each axis, with its quantities over time, and one of each recording.
"""

from __future__ import annotations

import hashlib
import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from bench.arrays import NORMAL95, Array
from bench.axis_kind import COULOMB, INERTIA, KINDS, VISCOUS
from bench.files import write_text
from bench.fleet.change_point import FEWEST, expected
from bench.fleet.fleet import RESULTS, TABLE, Fleet
from bench.fleet.store import Plain, Store
from bench.fleet.summary import ALARM, STATUSES, AxisSummary, Changed, History, Summary
from bench.names import counted, readable, short, words
from bench.parameter import Parameter
from bench.report import document as doc
from bench.report.numbers import SPACE, brief, chance, listed, number, sentence, share
from bench.report.parts import MOVES, one_panel, parameters_table
from bench.report.publish import write_html
from bench.report.serial import as_json, picked, serialised

SCHEMA = "bench.fleet/1"
FLEET, SUMMARY = "fleet.html", "summary.json"
#: Rows of a table, axes and charts: a page of a large fleet stays small, the table has all.
ROWS, AXES, CHARTS = 100, 1000, 12
#: Recordings of an axis in a chart and in a table, those around a change, and the latest; and those in a sketch.
DOTS, SKETCHED = 200, 40
#: Characters of a reason and of a name.
REASON, NAME = 200, 80
#: Seconds of the units that times are given in, the largest first.
CLOCK = {"d": 86400.0, "h": 3600.0, "min": 60.0, "s": 1.0}
#: Of these units there are at least so many from the first recording to the last.
SEVERAL = 3.0
#: What the table of a fleet and of an axis has of the latest values.
SHOWN = (INERTIA, VISCOUS, COULOMB)
#: Quantities in a row of many.
BRIEFLY = {
    kind.parameter(term): name
    for kind in KINDS
    for term, name in (
        (INERTIA, kind.inertia.split("_")[-1]),
        (VISCOUS, "viscous friction"),
        (COULOMB, "Coulomb friction"),
    )
}
MEANT = {
    "done": "evaluated",
    "missing": "no such file; evaluated by the next run that finds it",
    "refused": "cannot be read, or cannot answer; the column reason states what to record instead",
    "failed": "stopped by an unexpected error; evaluated again with --retry",
    "timed_out": "no result within the deadline; evaluated again with --retry",
}
RETRY = "`--retry --deadline 600` evaluates what failed or timed out again, with more time."
#: What to do about each concern; {} is the recording with its rig.
NEXT = {
    "failed": RETRY,
    "timed_out": RETRY,
    "missing": "Put the file in its place, and run the same command again.",
    "refused": "`bench inspect {}` shows the recording; record what the reason states.",
    "unexplained": "`bench diagnose {} --out found` searches for what is missing.",
    "checks": "`bench inspect {}` shows what was recorded and every check.",
}
AGAIN = "Add the next recordings to the manifest, and run the same command again: only these are evaluated."
#: Effects of a fleet that an answer lists.
FIRST = 3


def fleet_json(fleet: Fleet, provenance: Mapping[str, Any]) -> str:
    """The summary as the contract's JSON."""
    summary = fleet.summary
    return serialised(
        {
            "schema": SCHEMA,
            "recordings": {"total": len(fleet.manifest), **summary.counts},
            "axes": summary.axes,
            "false_alarm_rate": ALARM,
            "compared": summary.compared,
            "changed": summary.changed,
            "named": summary.shown,
            "attention": summary.concerns,
            "table": TABLE,
            "provenance": provenance,
        }
    )


@as_json.register
def _(one: Changed) -> dict[str, Any]:
    step = one.step
    difference = step.after - step.before
    return {
        **picked(one.history, "axis", "quantity", "unit"),
        **picked(step, "before", "after"),
        "difference95": [difference - step.reach, difference + step.reach],
        **picked(one, "since", "file"),
        "recordings": dict(zip(("before", "after"), one.counts, strict=True)),
        "chance": one.chance,
    }


def write_fleet(folder: Path, fleet: Fleet, provenance: Mapping[str, Any]) -> None:
    """Write summary and pages of a fleet: its own, one of each axis that it shows, and one next to each result.

    Raises:
        InputError: the folder cannot be written to.
    """
    write_text(folder / SUMMARY, fleet_json(fleet, provenance) + "\n")
    write_html(folder / FLEET, fleet_document(fleet, provenance))
    pages, store, manifest = FleetPages(fleet, provenance), Store(folder / RESULTS), fleet.manifest.path
    for axis in fleet.summary.by_need()[:AXES]:
        results = {row: store.path(key) for row in axis.rows if (key := fleet.planned[row].key)}
        page = folder / pages.axis_place(axis.name)
        if _older(page, manifest, *results.values()):
            write_html(page, pages.axis(axis), lasting=False)
        for row, result in results.items():
            if _older(page := folder / pages.recording_place(row), manifest, result):
                write_html(page, pages.recording(row), lasting=False)


def _older(page: Path, *files: Path) -> bool:
    """Whether a page is not there, not whole, or of a time before the files that it is made from."""
    state = page.stat() if page.exists() else None
    return state is None or not state.st_size or state.st_mtime < max(file.stat().st_mtime for file in files)


def fleet_document(fleet: Fleet, provenance: Mapping[str, Any]) -> doc.Document:
    """The document of a fleet; the same for the same results, however many were evaluated now."""
    pages = FleetPages(fleet, provenance)
    summary, name = fleet.summary, short(fleet.manifest.path.name, NAME)
    rows = [
        (short(one.axis, NAME), words(one.name), f"{one.recordings} of {one.of}", one.since) for one in summary.shown
    ]
    caption = "Those that most recordings of their axis show come first"
    shown = [_first(caption, ("axis", "effect", "recordings>", "first"), rows)] if rows else []
    statuses = ((words(status), str(summary.counts[status]), MEANT[status]) for status in STATUSES)
    marked = (k for k, status in enumerate(STATUSES) if status != "done" and summary.counts[status])
    recordings = doc.table("By status", ("status", "recordings>", "which~"), statuses, marked)
    rows_of = "a row for each recording: parameters, errors, verdict, reason, provenance"
    files = {TABLE: rows_of, SUMMARY: "the contents of this page, without a bound on its length"}
    reasons = _reasons(summary)
    options = ", ".join(key for key, value in provenance["options"].items() if value) or "none"
    return doc.Document(
        title=f"{name}: fleet",
        subject=f"Fleet {name}: {counted(len(fleet.manifest), 'recording')} of {counted(summary.axes, 'axis', 'axes')}",
        verdict=_verdict(summary),
        tone="refused" if summary.changed else "open" if summary.concerns or not summary.compared else "sure",
        answers={**_answers(summary, reasons), "What next?": pages.following(next(iter(summary.by_need())))},
        sections=doc.sections(
            doc.section("axes", "All axes", _dashboard(pages), detail=True),
            doc.section("people", "Axes that need attention", _people(summary, reasons)),
            doc.section("changes", "What changed", *_changes(pages)),
            doc.section("effects", "Effects that axes show", *shown),
            doc.section("recordings", "Recordings", recordings, doc.neighbours(files)),
        ),
        origin=(pages.origin, f"options: {options}"),
    )


def _verdict(summary: Summary) -> str:
    changed, called = {one.axis for one in summary.changed}, {one.axis for one in summary.concerns}
    first = f"{len(changed) or 'None'} of {summary.axes} axes changed"
    if not summary.compared:
        first = "No axis could be compared over time"
    beside = len(called - changed)
    verb = "needs" if beside == 1 else "need"
    if changed:
        return f"{first}; {beside} more {verb} attention for another reason." if beside else f"{first}."
    return (
        f"{first}, but {beside} of {summary.axes} {verb} attention."
        if beside
        else f"{first}, and none needs attention."
    )


def _answers(summary: Summary, reasons: Mapping[str, Sequence[str]]) -> dict[str, str]:
    counts = ", ".join(f"{summary.counts[status]} {words(status)}" for status in STATUSES if summary.counts[status])
    sure = "Not known: that needs three recordings of an axis with a time, by one rig."
    if summary.compared:
        sure = (
            f"{summary.compared} series of a quantity were compared; of a hundred fleets in which nothing changes at "
            f"most {100.0 * ALARM:g} names an axis."
        )
    first = next((f"{short(axis, NAME)}: {why[0]}" for axis, why in reasons.items()), "Nobody")
    axes = Counter(one.name for one in summary.shown).most_common()
    missing = ", ".join(f"{words(name)} ({counted(count, 'axis', 'axes')})" for name, count in axes[:FIRST])
    more = f" and {len(axes) - FIRST} more effects" if len(axes) > FIRST else ""
    return {
        "Who first?": f"{first}.",
        **({"What was missing?": f"{sentence(missing)}{more}."} if missing else {}),
        "How sure?": sure,
        "Recordings?": f"{counts}.",
    }


def _reasons(summary: Summary) -> dict[str, list[str]]:
    """By axis, why it needs attention: what changed surely comes before what could not be decided, gravest first."""
    reasons: dict[str, list[str]] = {}
    for one in summary.changed:
        reasons.setdefault(one.axis, []).append(news(one))
    for one in summary.concerns:
        which = f"{one.recordings} of {one.of} recordings, the latest {short(one.file, NAME)}"
        why = f"{words(one.kind)} ({which}): {short(one.reason, REASON)}"
        reasons.setdefault(one.axis, []).append(why)
    return reasons


def _dashboard(pages: FleetPages) -> doc.Table:
    """A row for each axis: drawn over time, last change and how sure, why to look, latest values, effects."""
    axes = pages.fleet.summary.by_need()
    more = f"; the first {AXES} of {len(axes)}" if len(axes) > AXES else ""
    axes = axes[:AXES]
    rows, sketches = zip(*(_row(pages, axis) for axis in axes), strict=True)
    headings = ("axis", "over time", "last change", "noted", "inertia>", "viscous>", "Coulomb>", "effects")
    marked = (k for k, axis in enumerate(axes) if axis.changed)
    caption = f"Those that need attention most come first{more}; values by the latest recording that has a result"
    made = doc.table(caption, headings, rows, marked)
    links = tuple(pages.axis_place(axis.name) for axis in axes)
    return made.model_copy(update={"links": links, "sketches": sketches, "sought": True})


def _row(pages: FleetPages, axis: AxisSummary) -> tuple[tuple[str | None, ...], tuple[doc.Series, ...]]:
    """Of an axis, and what is drawn of it: the latest values over where the next one was to be expected."""
    done = next((row for row in reversed(axis.rows) if pages.fleet.results[row]["status"] == "done"), None)
    values = [None] * len(SHOWN) if done is None else pages.parameters(done)
    changed = max(axis.changed, key=lambda one: pages.times[one.history.rows[one.step.place]], default=None)
    history = max(axis.histories, key=lambda one: pages.times[one.rows[-1]], default=None)
    last = "none" if axis.histories else None
    if changed is not None:
        history = changed.history
        last = f"{by_how_much(changed)} since {changed.since}, by chance {chance(changed.chance)}"
    sketch: list[doc.Series] = []
    if history is not None:
        x = pages.times[list(history.rows)]
        sketch, x, drawn = drawn_values(x, history, slice(max(0, x.size - SKETCHED), x.size), changed)
        sketch.append(doc.series("", "line", "ink", x, drawn))
        sketch.append(doc.series("", "dots", "model", x[-1:], drawn[-1:]))
    noted = ("changed",) * bool(changed) + tuple(words(one.kind) for one in axis.concerns)
    cells = (
        short(axis.name, NAME),
        "" if history is None else BRIEFLY.get(history.quantity, words(history.quantity)),
        last,
        ", ".join(noted) or None,
        *(None if one is None else brief(one) for one in values),
        ", ".join(f"{words(one.name)} ({one.recordings} of {one.of})" for one in axis.shown) or None,
    )
    return cells, tuple(sketch)


def _people(summary: Summary, reasons: Mapping[str, Sequence[str]]) -> doc.AnyPart:
    if not reasons:
        return doc.Paragraph(text="Nobody: no axis changed, and every recording gave a result that explains it.")
    rows = [(short(axis, NAME), "; ".join(why)) for axis, why in reasons.items()]
    marked = range(min(ROWS, len({one.axis for one in summary.changed})))
    return _first("Changed first, then by how grave it is", ("axis", "why~"), rows, marked)


def _changes(pages: FleetPages) -> Iterator[doc.AnyPart]:
    """The table of changes, and the first of them over time."""
    changed = pages.fleet.summary.changed
    if not changed:
        yield doc.Paragraph(text=f"Nothing, in {pages.fleet.summary.compared} series of a quantity over time.")
        return
    headings = ("axis", "quantity", "before>", "after>", "change (95 %)>", "since", "recordings before, after>")
    rows = [
        (
            short(one.axis, NAME),
            words(one.history.quantity),
            number(one.step.before),
            number(one.step.after, one.history.unit),
            by_how_much(one),
            one.since,
            f"{one.counts[0]}, {one.counts[1]}",
        )
        for one in changed
    ]
    yield _first("Surest first", headings, rows)
    if len(changed) > CHARTS:
        yield doc.Paragraph(text=f"The {CHARTS} surest over time:")
    for one in changed[:CHARTS]:
        yield pages.over_time(one.history, one)


def _first(
    caption: str, headings: Sequence[str], rows: Sequence[tuple[str, ...]], marked: Sequence[int] = ()
) -> doc.Table:
    """A table of the first rows, which states how many there are."""
    more = f"; the first {ROWS} of {len(rows)}" if len(rows) > ROWS else ""
    return doc.table(f"{sentence(caption)}{more}", headings, rows[:ROWS], marked)


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
    def recorded(self) -> list[str]:
        """Each recording with its rig, as a command takes them (n,)."""
        places = zip(*(self.fleet.manifest.located(column) for column in ("file", "rig")), strict=True)
        return [readable(shlex.join((file, "--rig", rig))) for file, rig in places]

    def following(self, axis: AxisSummary) -> str:
        """What to do next about an axis."""
        if axis.changed:
            one = axis.changed[0]
            command = f"bench diagnose {self.recorded[one.history.rows[one.step.place]]} --out found"
            return f"`{command}` shows the first recording after the change with all that was measured."
        if not axis.concerns:
            return AGAIN
        concern = axis.concerns[0]
        latest = next(row for row in reversed(axis.rows) if self.text_of["file"][row] == concern.file)
        return NEXT[concern.kind].replace("{}", self.recorded[latest])

    def axis_place(self, axis: str) -> str:
        """Where the page of an axis lies, in the folder of the fleet: names are any text."""
        return f"axes/{hashlib.sha256(axis.encode('utf-8', 'surrogatepass')).hexdigest()[:16]}.html"

    def recording_place(self, row: int) -> str:
        """Where that of a recording lies, next to its result; empty of one that could not be begun."""
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
        answers = {}
        if axis.changed:
            answers["How sure?"] = f"{sentence(chance(max(one.chance for one in axis.changed)))} that nothing changed."
        if axis.shown:
            shown = (f"{words(one.name)} ({one.recordings} of {one.of}, since {one.since})" for one in axis.shown)
            answers["What was missing?"] = f"{sentence(listed(shown))}."
        for one in axis.concerns:
            answers[f"{sentence(words(one.kind))}?"] = f"{one.recordings} of {one.of} recordings: {one.reason}"
        answers["What next?"] = self.following(axis)
        unchanged = "No change" if axis.histories else "Nothing to compare"
        return doc.Document(
            title=f"{short(axis.name, NAME)}: axis",
            subject=f"Axis {short(axis.name, NAME)}: {counted(len(axis.rows), 'recording')}",
            verdict=sentence(f"{listed(map(news, axis.changed)) or unchanged}."),
            tone="refused" if axis.changed else "open" if axis.concerns or not axis.histories else "sure",
            answers=answers,
            sections=doc.sections(
                doc.section("time", "Over time", *drawn),
                doc.section("recordings", "Recordings", self._recordings(axis)),
                doc.section("fleet", "The fleet", doc.neighbours({f"../{FLEET}": "all axes"})),
            ),
            origin=(self.origin,),
        )

    def _recordings(self, axis: AxisSummary) -> doc.Table:
        latest = list(reversed(axis.rows))[:DOTS]
        rows = []
        for row in latest:
            found = self.fleet.results[row]
            values = ["" if one is None else brief(one) for one in self.parameters(row)]
            names = listed(words(one["name"]) for one in found.get("effects") or ())
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
        values, checks = parameters(found), found.get("checks")
        lacking = [
            parameters_table(sentence(words(one["name"])), parameters(one)) for one in found.get("effects") or ()
        ]
        warned: list[doc.AnyPart] = [doc.points(found["warnings"])] if found.get("warnings") else []
        if checks:
            rows = ((words(one["name"]), one["status"], one["found"], one["advice"]) for one in checks)
            warned.append(doc.table("Those that did not pass", ("check", "status", "found~", "advice~"), rows))
        name = self.recording_place(row).rpartition("/")[2].replace(".html", ".json")
        above = {name: "all of it", f"../../{self.axis_place(axis)}": "the axis", f"../../{FLEET}": "the fleet"}
        good, digest = found["status"] == "done" and not found["checks"], found.get("trace_sha256")
        return doc.Document(
            title=f"{short(file, NAME)}: recording of {short(axis, NAME)}",
            subject=f"Recording {short(file, NAME)} of axis {short(axis, NAME)}{when and f', {when}'}",
            verdict=_recording_verdict(found),
            tone="sure" if good else "open",
            answers=_recording_answers(found, self.recorded[row]),
            sections=doc.sections(
                doc.section("parameters", "Parameters", *([parameters_table("", values)] if values else [])),
                doc.section("effects", "What was missing", *lacking),
                doc.section("gap", "Residual", *([_gaps(found["gap"])] if found.get("gap") else [])),
                doc.section("checks", "Checks and warnings", *warned),
                doc.section("more", "More", doc.neighbours(above)),
            ),
            origin=(self.origin, *([f"trace sha256 {digest}"] if digest else [])),
        )

    def over_time(self, history: History, changed: Changed | None) -> doc.Chart:
        """A quantity over time, and where the next recording was to be expected before and after its change."""
        count = len(history.rows)
        middle = count - DOTS // 2 if changed is None else changed.step.place
        near = slice(max(0, middle - DOTS // 2), middle + DOTS // 2)
        times, label, unit = self.times[list(history.rows)], "time", ""
        if self.fleet.manifest.dated:  # by moments, since the first of them
            times, label = times - times[0], f"time since {self.text_of['time'][history.rows[0]]}"
            unit = next((unit for unit, size in CLOCK.items() if times[-1] >= SEVERAL * size), "s")
            times = times / CLOCK[unit]
        drawn, x, values = drawn_values(times, history, near, changed)
        reach = NORMAL95 * history.errors[near]
        if changed is None:
            trend = f"The latest {number(float(history.values[-1]), history.unit)}; no significant change."
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

    @property
    def origin(self) -> str:
        """What all pages rest on."""
        return f"servobench {self.provenance['version']}; manifest sha256 {self.provenance['manifest_sha256']}"


def parameters(result: Plain) -> dict[str, Parameter]:
    """Parameters of a result; without an interval where it has none."""
    found = {}
    for name, one in result.get("parameters", {}).items():
        error, low, high = np.array([one["std_error"], *one["ci95"]], dtype=np.float64).tolist()  # nan for null
        found[name] = Parameter(one["value"], one["unit"], error, (low, high))
    return found


def _recording_verdict(found: Plain) -> str:
    names = listed(words(one["name"]) for one in found.get("effects") or ())
    if found["status"] != "done":
        return f"{sentence(words(found['status']))}: no result."
    match found.get("verdict"):
        case "unexplained_remainder":
            found_too = f", in addition to {names}" if names else ""
            return f"No effect of the catalogue explains the remaining residual{found_too}."
        case "explained":
            return f"{sentence(names)} {'was' if len(found['effects']) == 1 else 'were'} missing."
        case "nothing_missing":
            return "Inertia and friction explain it: no missing effect found."
        case _:
            explained = found["explained"]
            known = "" if explained is None else f" and explain {share(explained)} of the effort"
            return f"Inertia and friction are known{known}."


def _recording_answers(found: Plain, recorded: str) -> dict[str, str]:
    """Of one recording, which a command takes as `recorded`."""
    if found["status"] != "done":
        return {"Why?": found["reason"], "What next?": NEXT[found["status"]].replace("{}", recorded)}
    names, gaps = listed(words(one["name"]) for one in found.get("effects", ())), found.get("gap", {})
    missing = "Not searched for: `--diagnose` of the same command does."
    if "effects" in found:
        missing = f"{sentence(names) or 'No effect of the catalogue'}."
    large, moving = (_by_gap(gaps.get(name)) for name in ("torque", "velocity"))
    return {
        "What was missing?": missing,
        "How sure?": "Half widths are those of 95 % intervals.",
        **({"How large is the residual?": large} if large else {}),
        **({MOVES: f"The simulated speed differs by {moving}"} if moving else {}),
        **({"Noted?": f"{counted(len(found['checks']), 'check')} did not pass."} if found["checks"] else {}),
        "What next?": f"`bench diagnose {recorded} --out found` shows it with all that was measured.",
    }


def _by_gap(gap: Plain | None) -> str:
    """RMS residual, that before, and the noise floor; empty where none is known."""
    if gap is None or gap["after"] is None:
        return ""
    before = "" if gap["before"] is None else f" ({number(gap['before'], digits=3)} before)"
    floor = "" if gap["noise_floor"] is None else f"; the noise floor is {number(gap['noise_floor'], digits=3)}"
    return f"{number(gap['after'], gap['unit'], 3)}{before}{floor}."


def _gaps(gaps: Mapping[str, Plain]) -> doc.Table:
    """Residuals of torque (force) and velocity."""
    rows = []
    for name, gap in gaps.items():
        values = (gap[key] for key in ("before", "after", "noise_floor"))
        rows.append((name, *(None if value is None else number(value, gap["unit"]) for value in values)))
    return doc.table("RMS residual", ("signal", "before any effect>", "after>", "noise floor>"), rows)


def news(one: Changed) -> str:
    """What changed, by how much, and since when."""
    return f"{words(one.history.quantity)} {by_how_much(one)} since {one.since}"


def by_how_much(one: Changed) -> str:
    """By how much a quantity changed, with the interval of 95 %."""
    step = one.step
    difference, size = step.after - step.before, abs(step.before)
    if size:
        text = f"{100.0 * difference / size:+.3g}{SPACE}±{SPACE}{share(step.reach / size)}"
    else:
        text = f"{difference:+.3g}{SPACE}±{SPACE}{number(step.reach, one.history.unit, 2)}"
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
