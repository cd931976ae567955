"""The page of a fleet: who needs a person first and why, what changed since when, and how the recordings went."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bench.arrays import Array
from bench.comparison.step import expected
from bench.fleet.fleet import TABLE, Fleet
from bench.fleet.summary import ALARM, STATUSES, Changed, Summary
from bench.names import short, words
from bench.report.document import (
    AnyPart,
    Chart,
    Document,
    Heading,
    Neighbour,
    Neighbours,
    Panel,
    Paragraph,
    Section,
    Series,
    Table,
    Tone,
)
from bench.report.numbers import SPACE, number, sentence, share, unit_text
from bench.statistics import NORMAL95

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


def fleet_page(fleet: Fleet, summary_file: str, provenance: Mapping[str, Any]) -> Document:
    """The page of a fleet; the same for the same results, however many were evaluated now.

    Args:
        fleet: what was found.
        summary_file: name of the file beside the page that holds all of the summary.
        provenance: of it: version, manifest_sha256 and options.
    """
    summary, name = fleet.summary, short(fleet.manifest.path.name, NAME)
    sections = [
        Section(key="people", heading="Who needs a person first", blocks=(_people(summary),)),
        Section(key="changes", heading="What changed", blocks=tuple(_changes(fleet))),
        Section(key="recordings", heading="Recordings", blocks=(_statuses(summary), _beside(summary_file))),
    ]
    if summary.named:
        sections.insert(2, Section(key="effects", heading="Effects that axes show", blocks=(_effects(summary),)))
    options = ", ".join(key for key, value in provenance["options"].items() if value) or "none"
    return Document(
        title=f"{name}: fleet",
        subject=f"Fleet {name}: {len(fleet.manifest)} recordings of {summary.axes} axes",
        verdict=_verdict(summary),
        tone=_tone(summary),
        answers=_answers(fleet),
        sections=tuple(sections),
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


def _tone(summary: Summary) -> Tone:
    if summary.changed:
        return "refused"
    return "open" if summary.concerns or not summary.compared else "sure"


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
        why = f"{words(one.kind)} ({one.count} of {one.of} recordings): {short(one.reason, REASON)}"
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


def _people(summary: Summary) -> AnyPart:
    reasons = _reasons(summary)
    if not reasons:
        return Paragraph(text="Nobody: no axis changed, and every recording gave a result that explains it.")
    rows = [(short(axis, NAME), "; ".join(why)) for axis, why in reasons.items()]
    columns = Heading(heading="axis"), Heading(heading="why", prose=True)
    marked = tuple(range(min(ROWS, len({one.history.axis for one in summary.changed}))))
    return _table("Changed first, then by how grave it is", columns, rows, marked)


def _changes(fleet: Fleet) -> Iterator[AnyPart]:
    """The table of changes, and the first of them over time."""
    changed = fleet.summary.changed
    if not changed:
        yield Paragraph(text=f"Nothing, in {fleet.summary.compared} series of a quantity over time.")
        return
    headings = ("before", "after", "change (95 %)")
    columns = (
        Heading(heading="axis"),
        Heading(heading="quantity"),
        *(Heading(heading=heading, number=True) for heading in headings),
        Heading(heading="since"),
        Heading(heading="recordings before, after", number=True),
    )
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
    yield _table("Surest first", columns, rows)
    if len(changed) > CHARTS:
        yield Paragraph(text=f"The {CHARTS} surest over time:")
    for one in changed[:CHARTS]:
        yield _over_time(one, fleet)


def _over_time(one: Changed, fleet: Fleet) -> Chart:
    """A quantity over time, and where the next recording was to be expected before and after the change."""
    step, series = one.step, one.history
    near = slice(max(0, step.place - DOTS // 2), step.place + DOTS // 2)
    rows = list(series.rows)
    times, label, unit = _clock(fleet, rows)
    x, values, reach = times[near], series.values[near], NORMAL95 * series.errors[near]
    before, after = expected(series.values, series.errors, step.place)
    since = float(times[step.place])
    ends, later = (float(x[0]), float(x[-1])), (since, float(x[-1]))
    drawn = (
        _band("the next recording (95 %), as told before and after", ends, before),
        _band("", later, after),
        Series(name="mean", style="line", colour="model", x=(ends[0], since), y=(step.before,) * 2),
        Series(name="", style="line", colour="model", x=later, y=(step.after,) * 2),
        Series(
            name="recordings, each with its own interval",
            style="dots",
            colour="ink",
            x=tuple(x.tolist()),
            y=tuple(values.tolist()),
            low=tuple((values - reach).tolist()),
            high=tuple((values + reach).tolist()),
        ),
    )
    nearest = "" if len(rows) <= x.size else f" Of {len(rows)} recordings the {x.size} nearest to it are drawn."
    return Chart(
        title=f"{short(one.history.axis, NAME)}: {words(one.history.quantity)}.",
        alternative=f"From {number(step.before)} to {number(step.after, one.history.unit)}, {_share(one)}, since "
        f"{one.since} ({short(one.file, NAME)}).{nearest}",
        y_label=words(one.history.quantity),
        y_unit=unit_text(one.history.unit),
        panels=(Panel(x_label=label, x_unit=unit, series=drawn),),
    )


def _clock(fleet: Fleet, rows: Sequence[int]) -> tuple[Array, str, str]:
    """Times of recordings, what they are called, and their unit: of moments, since the first of them."""
    times = fleet.manifest.times[rows]
    if not fleet.manifest.dated:
        return times, "time", ""
    since = times - times[0]
    unit = next((unit for unit, size in CLOCK.items() if since[-1] >= SEVERAL * size), "s")
    return since / CLOCK[unit], f"time since {fleet.manifest.text('time')[rows[0]]}", unit


def _band(name: str, x: tuple[float, float], around: tuple[float, float]) -> Series:
    low, high = around
    return Series(name=name, style="band", colour="floor", x=x, low=(low, low), high=(high, high))


def _effects(summary: Summary) -> Table:
    columns = (
        Heading(heading="axis"),
        Heading(heading="effect"),
        Heading(heading="recordings", number=True),
        Heading(heading="first"),
    )
    rows = [(short(one.axis, NAME), words(one.effect), f"{one.count} of {one.of}", one.since) for one in summary.named]
    return _table("Those that most recordings of their axis show come first", columns, rows)


def _statuses(summary: Summary) -> Table:
    columns = (
        Heading(heading="status"),
        Heading(heading="recordings", number=True),
        Heading(heading="which", prose=True),
    )
    rows = tuple((words(status), str(summary.counts[status]), MEANT[status]) for status in STATUSES)
    marked = tuple(k for k, status in enumerate(STATUSES) if status != "done" and summary.counts[status])
    return Table(caption="By status", columns=columns, rows=rows, marked=marked)


def _beside(summary_file: str) -> Neighbours:
    return Neighbours(
        files=(
            Neighbour(name=TABLE, about="a row for each recording: parameters, errors, verdict, reason, provenance"),
            Neighbour(name=summary_file, about="all that this page says, without a bound on its length"),
        )
    )


def _table(
    caption: str, columns: tuple[Heading, ...], rows: Sequence[tuple[str, ...]], marked: tuple[int, ...] = ()
) -> Table:
    """A table of the first rows, which says how many there are."""
    more = f"; the first {ROWS} of {len(rows)}" if len(rows) > ROWS else ""
    return Table(caption=f"{sentence(caption)}{more}", columns=columns, rows=tuple(rows[:ROWS]), marked=marked)
