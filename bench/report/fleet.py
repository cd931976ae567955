"""A fleet: who needs a person first and why, what changed since when, and how the recordings went.

As the contract's JSON (`bench.fleet/1`), which has all, and as a document, which stays small however large a fleet is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from bench.arrays import NORMAL95, Array
from bench.comparison.spread import expected
from bench.fleet.fleet import TABLE, Fleet
from bench.fleet.summary import ALARM, STATUSES, Changed, Summary
from bench.names import short, words
from bench.report import document as doc
from bench.report.numbers import SPACE, number, sentence, share, unit_text
from bench.report.serial import as_json, picked, serialised

SCHEMA = "bench.fleet/1"
#: Rows of a table, charts, and recordings in one of them: a page of a large fleet stays small, the table has all.
ROWS, CHARTS, DOTS = 100, 12, 200
#: Characters of a name, and of a reason.
NAME, REASON = 80, 200
#: Seconds of the units that times are told in, the largest first.
CLOCK = {"d": 86400.0, "h": 3600.0, "min": 60.0, "s": 1.0}
#: Of these units there are at least so many from the first recording to the last.
SEVERAL = 3.0
MEANT = {
    "done": "evaluated",
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


def fleet_document(fleet: Fleet, summary_file: str, provenance: Mapping[str, Any]) -> doc.Document:
    """The document of a fleet; the same for the same results, however many were evaluated now.

    Args:
        fleet: what was found.
        summary_file: name of the file beside the page that holds all of the summary.
        provenance: of it: version, manifest_sha256 and options.
    """
    summary, name = fleet.summary, short(fleet.manifest.path.name, NAME)
    rows = [
        (short(one.axis, NAME), words(one.name), f"{one.recordings} of {one.of}", one.since) for one in summary.shown
    ]
    caption = "Those that most recordings of their axis show come first"
    effects = _first(caption, ("axis", "effect", "recordings>", "first"), rows)
    shown = (doc.section("effects", "Effects that axes show", effects),)
    rows_of = "a row for each recording: parameters, errors, verdict, reason, provenance"
    files = {TABLE: rows_of, summary_file: "all that this page says, without a bound on its length"}
    options = ", ".join(key for key, value in provenance["options"].items() if value) or "none"
    return doc.Document(
        title=f"{name}: fleet",
        subject=f"Fleet {name}: {len(fleet.manifest)} recordings of {summary.axes} axes",
        verdict=_verdict(summary),
        tone="refused" if summary.changed else "open" if summary.concerns or not summary.compared else "sure",
        answers=_answers(fleet),
        sections=(
            doc.section("people", "Who needs a person first", _people(summary)),
            doc.section("changes", "What changed", *_changes(fleet)),
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
    """By axis, why a person should look: what changed surely comes before what could not be told, gravest first."""
    reasons: dict[str, list[str]] = {}
    for one in summary.changed:
        why = f"{words(one.history.quantity)} {_share(one)} since {one.since}"
        reasons.setdefault(one.history.axis, []).append(why)
    for one in summary.concerns:
        which = f"{one.recordings} of {one.of} recordings, the latest {short(one.file, NAME)}"
        why = f"{words(one.kind)} ({which}): {short(one.reason, REASON)}"
        reasons.setdefault(one.axis, []).append(why)
    return reasons


def _share(one: Changed) -> str:
    """By how much a quantity changed, with the interval of 95 %."""
    step = one.step
    difference = step.after - step.before
    if not step.before:
        return f"{difference:+.3g}{SPACE}±{SPACE}{number(step.reach, one.history.unit, 2)}".replace("-", "−")
    text = f"{100.0 * difference / abs(step.before):+.3g}{SPACE}±{SPACE}{share(step.reach / abs(step.before))}"
    return text.replace("-", "−")


def _people(summary: Summary) -> doc.AnyPart:
    reasons = _reasons(summary)
    if not reasons:
        return doc.Paragraph(text="Nobody: no axis changed, and every recording gave a result that explains it.")
    rows = [(short(axis, NAME), "; ".join(why)) for axis, why in reasons.items()]
    marked = range(min(ROWS, len({one.history.axis for one in summary.changed})))
    return _first("Changed first, then by how grave it is", ("axis", "why~"), rows, marked)


def _changes(fleet: Fleet) -> Iterator[doc.AnyPart]:
    """The table of changes, and the first of them over time."""
    changed = fleet.summary.changed
    if not changed:
        yield doc.Paragraph(text=f"Nothing, in {fleet.summary.compared} series of a quantity over time.")
        return
    headings = ("axis", "quantity", "before>", "after>", "change (95 %)>", "since", "recordings before, after>")
    rows = [
        (
            short(one.history.axis, NAME),
            words(one.history.quantity),
            number(one.step.before),
            number(one.step.after, one.history.unit),
            _share(one),
            one.since,
            f"{one.counts[0]}, {one.counts[1]}",
        )
        for one in changed
    ]
    yield _first("Surest first", headings, rows)
    if len(changed) > CHARTS:
        yield doc.Paragraph(text=f"The {CHARTS} surest over time:")
    for one in changed[:CHARTS]:
        yield _over_time(one, fleet)


def _over_time(one: Changed, fleet: Fleet) -> doc.Chart:
    """A quantity over time, and where the next recording was to be expected before and after the change."""
    step, history = one.step, one.history
    near = slice(max(0, step.place - DOTS // 2), step.place + DOTS // 2)
    times, label, unit = _clock(fleet, history.rows)
    x, values, reach = times[near], history.values[near], NORMAL95 * history.errors[near]
    until, later = np.array([x[0], times[step.place]]), np.array([times[step.place], x[-1]])
    before, after = expected(history.values, history.errors, step.place)
    drawn = (
        _band("the next recording (95 %), as told before and after", np.array([x[0], x[-1]]), before),
        _band("", later, after),
        doc.series("mean", "line", "model", until, np.full(2, step.before)),
        doc.series("", "line", "model", later, np.full(2, step.after)),
        doc.series(
            "recordings, each with its own interval", "dots", "ink", x, values, (values - reach, values + reach)
        ),
    )
    count = len(history.rows)
    nearest = "" if count <= x.size else f" Of {count} recordings the {x.size} nearest to it are drawn."
    return doc.Chart(
        title=f"{short(history.axis, NAME)}: {words(history.quantity)}.",
        alternative=f"From {number(step.before)} to {number(step.after, history.unit)}, {_share(one)}, since "
        f"{one.since} ({short(one.file, NAME)}).{nearest}",
        y_label=words(history.quantity),
        y_unit=unit_text(history.unit),
        panels=(doc.Panel(x_label=label, x_unit=unit, series=drawn),),
    )


def _clock(fleet: Fleet, rows: Sequence[int]) -> tuple[Array, str, str]:
    """Times of recordings, what they are called, and their unit: of moments, since the first of them."""
    times = fleet.manifest.times[list(rows)]
    if not fleet.manifest.dated:
        return times, "time", ""
    since = times - times[0]
    unit = next((unit for unit, size in CLOCK.items() if since[-1] >= SEVERAL * size), "s")
    return since / CLOCK[unit], f"time since {fleet.manifest.text('time')[rows[0]]}", unit


def _band(name: str, x: Array, around: tuple[float, float]) -> doc.Series:
    return doc.series(name, "band", "floor", x, bounds=(np.full(2, around[0]), np.full(2, around[1])))


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
