"""A part of a document as Markdown, for a file or a server that renders it."""

from __future__ import annotations

from collections.abc import Sequence

from bench.report.document import Code, Paragraph, Points, Table


def markdown(part: object) -> str:
    """A table, a text or a list as Markdown; empty of what only a page can show."""
    match part:
        case Table():
            rule = ["---:" if column.number else "---" for column in part.columns]
            rows = ([column.heading for column in part.columns], rule, *part.rows)
            return "\n".join([*((f"## {part.caption}", "") if part.caption else ()), *map(_line, rows)])
        case Paragraph():
            return part.text
        case Points():
            return "\n".join(f"- {item}" for item in part.items)
        case Code():
            return f"```\n{part.text}\n```"
        case _:
            return ""


def _line(cells: Sequence[str]) -> str:
    """A row, in which what would end a cell is escaped."""
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
