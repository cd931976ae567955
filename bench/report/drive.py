"""What a drive is given, as tables: a motion to record, and how much better it tracks with what is fed forward."""

from __future__ import annotations

from bench.axis_kind import AxisKind
from bench.export.feedforward import Tracking
from bench.export.plan import PlannedMotion
from bench.names import words
from bench.report.document import Table, table
from bench.report.numbers import number, unit_text


def plan_table(best: PlannedMotion) -> Table:
    """What a motion will tell, and how well."""
    title = f"{best.profile}, {best.motion.time[-1]:.3g} s: what it will tell, and how well"
    rows = (
        (words(name), number(found.value), number(found.std_error, digits=2), unit_text(found.unit))
        for name, found in best.expected.items()
    )
    return table(title, ("quantity", "expected>", "standard error>", "unit"), rows)


def others_line(found: list[PlannedMotion]) -> str:
    """How well all profiles tell the same, in a line."""
    others = [f"{each.profile} {each.worst:.2%}" if not each.reason else f"{each.profile} nothing" for each in found]
    return f"largest standard error over its value: {', '.join(others)}"


def tracking_table(title: str, before: Tracking, after: Tracking, kind: AxisKind) -> Table:
    """RMS tracking errors without and with what is fed forward.

    Args:
        title: axis and motion.
        before, after: without, and with it.
        kind: of the axis.
    """
    rows = []
    for name, unit in (("position", kind.length_unit), ("velocity", kind.speed_unit)):
        was, now = getattr(before, name), getattr(after, name)
        less = number(was / now, digits=3) if now > 0.0 else ""
        rows.append((name, number(was), number(now), less, unit_text(unit)))
    headings = ("RMS tracking error", "as the rig's drive is>", "with the tables>", "times less>", "unit")
    return table(title, headings, rows)
