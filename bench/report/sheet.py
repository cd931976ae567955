"""A table of text, for a terminal and for a Markdown file alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rich import box
from rich.table import Table


@dataclass(frozen=True)
class Sheet:
    """Rows under headings.

    Attributes:
        title: of the table.
        headings: of the columns.
        rows: of text; all but the columns of `words` are numbers.
        words: how many columns, from the left, hold words.
        note: below the table.
    """

    title: str
    headings: tuple[str, ...]
    rows: Sequence[Sequence[str]]
    words: int = 1
    note: str = ""

    def table(self) -> Table:
        """For a terminal."""
        table = Table(
            title=self.title,
            caption=self.note or None,
            title_justify="left",
            caption_justify="left",
            box=box.SIMPLE_HEAD,
        )
        for place, heading in enumerate(self.headings):
            table.add_column(heading, justify="left" if place < self.words else "right")
        for row in self.rows:
            table.add_row(*row)
        return table

    def markdown(self) -> str:
        """For a file; what would end a cell is escaped."""
        rule = ["---" if place < self.words else "---:" for place in range(len(self.headings))]
        lines = [f"## {self.title}", "", *map(_line, (self.headings, rule, *self.rows))]
        return "\n".join([*lines, *(["", self.note] if self.note else [])])


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
