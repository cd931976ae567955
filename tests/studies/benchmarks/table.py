"""What was measured, as a section of the page."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """One table with what it says.

    Attributes:
        says: what was done and how to read it, a paragraph.
        heads: of the columns.
        rows: as text.
    """

    says: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def __post_init__(self) -> None:
        assert self.rows
        assert all(len(row) == len(self.heads) for row in self.rows)

    @property
    def markdown(self) -> str:
        """The paragraph and the table."""
        lines = [self.heads, ("---", *("---:" for _ in self.heads[1:])), *self.rows]
        return self.says + "\n\n" + "\n".join("| " + " | ".join(line) + " |" for line in lines)
