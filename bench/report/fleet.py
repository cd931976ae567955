"""A fleet's summary as JSON (contract `bench.fleet/1`), and as tables for a person."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from rich import box
from rich.table import Table

from bench.fleet.fleet import TABLE, Fleet
from bench.fleet.summary import ALARM, STATUSES, Changed, Concern, ShownEffect
from bench.names import short, words
from bench.structured import json_text

SCHEMA = "bench.fleet/1"
#: Rows of a table in the terminal; the summary has all.
SHOWN = 20


def fleet_json(fleet: Fleet, provenance: Mapping[str, Any]) -> str:
    """The summary as the contract's JSON.

    Args:
        fleet: what was found.
        provenance: of it.
    """
    summary = fleet.summary
    return json_text(
        {
            "schema": SCHEMA,
            "recordings": {"total": len(fleet.manifest), **summary.counts},
            "axes": summary.axes,
            "false_alarm_rate": ALARM,
            "compared": summary.compared,
            "changed": [_changed(one) for one in summary.changed],
            "named": [_named(one) for one in summary.named],
            "attention": [_concern(one) for one in summary.concerns],
            "table": TABLE,
            "provenance": provenance,
        }
    )


def _changed(one: Changed) -> dict[str, Any]:
    step = one.step
    difference = step.after - step.before
    return {
        "axis": one.history.axis,
        "quantity": one.history.quantity,
        "unit": one.history.unit,
        "before": step.before,
        "after": step.after,
        "difference95": [difference - step.reach, difference + step.reach],
        "since": one.since,
        "file": one.file,
        "recordings": {"before": one.counts[0], "after": one.counts[1]},
        "chance": one.chance,
    }


def _named(one: ShownEffect) -> dict[str, Any]:
    return {"axis": one.axis, "name": one.effect, "recordings": one.count, "of": one.of, "since": one.since}


def _concern(one: Concern) -> dict[str, Any]:
    counts = {"axis": one.axis, "kind": one.kind, "recordings": one.count, "of": one.of}
    return {**counts, "file": one.file, "reason": one.reason}


def fleet_tables(fleet: Fleet) -> Iterator[Table | str]:
    """What a person wants to know: how many gave a result, which axes changed, which need a look."""
    summary = fleet.summary
    counts = ", ".join(f"{summary.counts[status]} {status.replace('_', ' ')}" for status in STATUSES)
    yield f"{len(fleet.manifest)} recordings of {summary.axes} axes: {counts} ({fleet.evaluated} evaluated now)"
    if summary.changed:
        yield changed_table(summary.changed)
    elif summary.compared:
        yield f"no axis changed: {summary.compared} series of a quantity compared, false alarms at most {ALARM:.0%}"
    else:
        yield "no axis could be compared over time: that needs three recordings with a time, by one rig"
    if summary.named:
        yield named_table(summary.named)
    if summary.concerns:
        yield concerns_table(summary.concerns)


def changed_table(changed: tuple[Changed, ...]) -> Table:
    """Axes that changed, surest first."""
    table = _table(f"changed (false alarms at most {ALARM:.0%} of fleets)", len(changed))
    for heading in ("axis", "quantity", "before", "after", "change", "since", "recordings"):
        table.add_column(heading, justify="right" if heading in ("before", "after", "change") else "left")
    for one in changed[:SHOWN]:
        step = one.step
        difference, unit = step.after - step.before, one.history.unit
        share = f"{difference / abs(step.before):+.1%} ± {step.reach / abs(step.before):.1%}" if step.before else ""
        values = (f"{step.before:.4g}", f"{step.after:.4g} {unit}", share)
        counts = f"{one.counts[0]} before, {one.counts[1]} after"
        table.add_row(one.history.axis, words(one.history.quantity), *values, one.since, counts)
    return table


def named_table(named: tuple[ShownEffect, ...]) -> Table:
    """Effects that the axes show."""
    table = _table("effects named", len(named))
    for heading in ("axis", "effect", "recordings", "first"):
        table.add_column(heading)
    for one in named[:SHOWN]:
        table.add_row(one.axis, one.effect, f"{one.count} of {one.of}", one.since)
    return table


def concerns_table(concerns: tuple[Concern, ...]) -> Table:
    """Axes that need a person, gravest first."""
    table = _table("need a person", len(concerns))
    for heading in ("axis", "why", "recordings", "latest", "reason"):
        table.add_column(heading, no_wrap=heading == "recordings")
    for one in concerns[:SHOWN]:
        counts = f"{one.count} of {one.of}"
        table.add_row(one.axis, words(one.kind), counts, one.file, short(one.reason, 160))
    return table


def _table(title: str, rows: int) -> Table:
    more = f"; the first {SHOWN} of {rows}, the summary has all" if rows > SHOWN else ""
    return Table(title=f"{title}{more}", title_justify="left", box=box.SIMPLE_HEAD)
