"""A fleet: every axis by how much it needs a person and why, what changed since when, and how the recordings went.

As the contract's JSON (`bench.fleet/1`), which has all, and as a document, which stays small however large a fleet is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from bench.axis_kind import COULOMB, INERTIA, KINDS, VISCOUS
from bench.files import write_text
from bench.fleet.fleet import RESULTS, TABLE, Fleet
from bench.fleet.store import Store
from bench.fleet.summary import ALARM, STATUSES, AxisSummary, Changed, History, Summary
from bench.names import short, words
from bench.report import document as doc
from bench.report.fleet_axis import FLEET, NAME, SHOWN, FleetPages, by_how_much, drawn_values
from bench.report.numbers import brief, chance, number, sentence
from bench.report.publish import write_html
from bench.report.serial import as_json, picked, serialised

SCHEMA = "bench.fleet/1"
#: Rows of a table, axes and charts: a page of a large fleet stays small, the table has all.
ROWS, AXES, CHARTS = 100, 1000, 12
#: Recordings in a sketch, the latest.
SKETCHED = 40
#: Characters of a reason.
REASON = 200
SUMMARY = "summary.json"
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
    "refused": "cannot be read, or cannot answer; the column reason says what to record instead",
    "failed": "raised what nobody foresaw, or its process was ended; --retry does it again",
    "timed_out": "no result within the deadline; --retry does it again",
}


def fleet_json(fleet: Fleet, provenance: Mapping[str, Any]) -> str:
    """The summary as the contract's JSON."""
    summary = fleet.summary
    content = {
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
    return serialised(content)


@as_json.register
def _(one: Changed) -> dict[str, Any]:
    step = one.step
    difference = step.after - step.before
    before, after = one.counts
    return {
        **picked(one.history, "axis", "quantity", "unit"),
        **picked(step, "before", "after"),
        "difference95": [difference - step.reach, difference + step.reach],
        **picked(one, "since", "file"),
        "recordings": {"before": before, "after": after},
        "chance": one.chance,
    }


def write_fleet(folder: Path, fleet: Fleet, provenance: Mapping[str, Any]) -> None:
    """Write summary and pages of a fleet: its own, one of each axis that it shows, and one beside each result.

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
    """The document of a fleet; the same for the same results, however many were evaluated now.

    Args:
        fleet: what was found.
        provenance: of it: version, manifest_sha256 and options.
    """
    pages = FleetPages(fleet, provenance)
    summary, name = fleet.summary, short(fleet.manifest.path.name, NAME)
    rows = [
        (short(one.axis, NAME), words(one.name), f"{one.recordings} of {one.of}", one.since) for one in summary.shown
    ]
    caption = "Those that most recordings of their axis show come first"
    effects = _first(caption, ("axis", "effect", "recordings>", "first"), rows)
    shown = (doc.section("effects", "Effects that axes show", effects),)
    rows_of = "a row for each recording: parameters, errors, verdict, reason, provenance"
    files = {TABLE: rows_of, SUMMARY: "all that this page says, without a bound on its length"}
    options = ", ".join(key for key, value in provenance["options"].items() if value) or "none"
    return doc.Document(
        title=f"{name}: fleet",
        subject=f"Fleet {name}: {len(fleet.manifest)} recordings of {summary.axes} axes",
        verdict=_verdict(summary),
        tone="refused" if summary.changed else "open" if summary.concerns or not summary.compared else "sure",
        answers=_answers(fleet),
        sections=(
            doc.section("axes", "All axes", _dashboard(pages), detail=True),
            doc.section("people", "Who needs a person first", _people(summary)),
            doc.section("changes", "What changed", *_changes(pages)),
            *(shown if summary.shown else ()),
            doc.section("recordings", "Recordings", _statuses(summary), doc.neighbours(files)),
        ),
        origin=(
            f"servobench {provenance['version']}; manifest sha256 {provenance['manifest_sha256']}",
            f"options: {options}",
        ),
    )


def _verdict(summary: Summary) -> str:
    changed, called = {one.history.axis for one in summary.changed}, {one.axis for one in summary.concerns}
    first = f"{len(changed) or 'None'} of {summary.axes} axes changed"
    if not summary.compared:
        first = "No axis could be compared over time"
    beside = len(called - changed)
    verb = "needs" if beside == 1 else "need"
    if changed:
        return f"{first}; {beside} more {verb} a person for another reason." if beside else f"{first}."
    return (
        f"{first}, but {beside} of {summary.axes} {verb} a person." if beside else f"{first}, and none needs a person."
    )


def _answers(fleet: Fleet) -> dict[str, str]:
    summary = fleet.summary
    counts = ", ".join(f"{summary.counts[status]} {words(status)}" for status in STATUSES if summary.counts[status])
    if summary.compared:
        sure = (
            f"{summary.compared} series of a quantity were compared; of a hundred fleets in which nothing changes at "
            f"most {100.0 * ALARM:g} names an axis."
        )
    else:
        sure = "Not known: that needs three recordings of an axis with a time, by one rig."
    first = next(iter(_reasons(summary).items()), None)
    return {
        "Who first?": "Nobody." if first is None else f"{short(first[0], NAME)}: {first[1][0]}.",
        "How sure?": sure,
        "Recordings?": f"{counts}.",
    }


def _reasons(summary: Summary) -> dict[str, list[str]]:
    """By axis, why a person should look: what changed surely comes before what could not be decided, gravest first."""
    reasons: dict[str, list[str]] = {}
    for one in summary.changed:
        why = f"{words(one.history.quantity)} {by_how_much(one)} since {one.since}"
        reasons.setdefault(one.history.axis, []).append(why)
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
    caption = f"Those that need a person most come first{more}; values by the latest recording that has a result"
    made = doc.table(caption, headings, rows, marked)
    links = tuple(pages.axis_place(axis.name) for axis in axes)
    return made.model_copy(update={"links": links, "sketches": sketches, "sought": True})


def _row(pages: FleetPages, axis: AxisSummary) -> tuple[tuple[str, ...], tuple[doc.Series, ...]]:
    """Of an axis, and what is drawn of it."""
    done = next((row for row in reversed(axis.rows) if pages.fleet.results[row]["status"] == "done"), None)
    values = () if done is None else pages.parameters(done)
    changed = max(axis.changed, key=lambda one: pages.times[one.history.rows[one.step.place]], default=None)
    history = max(axis.histories, key=lambda one: pages.times[one.rows[-1]], default=None)
    last = "none" if axis.histories else "–"
    if changed is not None:
        history = changed.history
        last = f"{by_how_much(changed)} since {changed.since}, by chance {chance(changed.chance)}"
    noted = ("changed",) * bool(changed) + tuple(words(one.kind) for one in axis.concerns)
    cells = (
        short(axis.name, NAME),
        "" if history is None else BRIEFLY.get(history.quantity, words(history.quantity)),
        last,
        ", ".join(noted) or "–",
        *("–" if one is None else brief(one) for one in values or (None,) * len(SHOWN)),
        ", ".join(f"{words(one.name)} ({one.recordings} of {one.of})" for one in axis.shown) or "–",
    )
    return cells, () if history is None else _sketch(pages, history, changed)


def _sketch(pages: FleetPages, history: History, changed: Changed | None) -> tuple[doc.Series, ...]:
    """The latest values over time, the last of them a dot, over where the next one was to be expected."""
    x = pages.times[list(history.rows)]
    bands, x, values = drawn_values(x, history, slice(max(0, x.size - SKETCHED), x.size), changed)
    line, dot = doc.series("", "line", "ink", x, values), doc.series("", "dots", "model", x[-1:], values[-1:])
    return (*bands, line, dot)


def _people(summary: Summary) -> doc.AnyPart:
    reasons = _reasons(summary)
    if not reasons:
        return doc.Paragraph(text="Nobody: no axis changed, and every recording gave a result that explains it.")
    rows = [(short(axis, NAME), "; ".join(why)) for axis, why in reasons.items()]
    marked = range(min(ROWS, len({one.history.axis for one in summary.changed})))
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
            short(one.history.axis, NAME),
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


def _statuses(summary: Summary) -> doc.Table:
    rows = ((words(status), str(summary.counts[status]), MEANT[status]) for status in STATUSES)
    marked = (k for k, status in enumerate(STATUSES) if status != "done" and summary.counts[status])
    return doc.table("By status", ("status", "recordings>", "which~"), rows, marked)


def _first(
    caption: str, headings: Sequence[str], rows: Sequence[tuple[str, ...]], marked: Sequence[int] = ()
) -> doc.Table:
    """A table of the first rows, which says how many there are."""
    more = f"; the first {ROWS} of {len(rows)}" if len(rows) > ROWS else ""
    return doc.table(f"{sentence(caption)}{more}", headings, rows[:ROWS], marked)
