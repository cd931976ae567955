"""A task of the lab as it is printed, whether in HTML, PDF or on a terminal."""

from __future__ import annotations

from dataclasses import dataclass

from bench.course.result import DoneTask, NotDone, Number


@dataclass(frozen=True)
class Row:
    """A number as it is printed."""

    name: str
    value: str
    unit: str
    truth: str
    error: str
    source: str


@dataclass(frozen=True)
class Section:
    """A task as it is printed; `missing` says why it was not done, and is empty where it was."""

    key: str
    heading: str
    missing: str
    findings: tuple[str, ...]
    rows: tuple[Row, ...]

    @property
    def has_truth(self) -> bool:
        """Whether any number has a truth beside it."""
        return any(row.truth for row in self.rows)


def section(result: DoneTask | NotDone) -> Section:
    """A task as it is printed."""
    heading = f"Task {result.key}: {result.title}" if result.key.isdigit() else result.title
    if isinstance(result, DoneTask) and result.example:
        heading = f"{heading} (embedded example)"
    if isinstance(result, NotDone):
        return Section(result.key, heading, str(result.reason), (), ())
    return Section(result.key, heading, "", result.findings, tuple(row(number) for number in result.numbers))


def row(number: Number) -> Row:
    """A number with five digits, and how far it is from its truth."""
    truth = number.truth
    error = f"{number.value / truth - 1.0:+.3%}" if truth else ""
    shown = f"{truth:.5g}" if truth is not None else ""
    return Row(number.name, f"{number.value:.5g}", number.unit, shown, error, number.source)
