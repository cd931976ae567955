"""A document on a terminal, and whatever else a command says there; text from files is shown and never obeyed."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich import box
from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table as Grid
from rich.text import Text

from bench.names import plain
from bench.report.document import Code, Document, Paragraph, Points, Table

#: Columns of a log: a terminal says how wide it is.
WIDTH = 110
#: Signs of a document in letters that every encoding has, and digits that are raised.
IN_ASCII = str.maketrans({"·": "*", "−": "-", "±": "+-", "–": "-", "\N{NO-BREAK SPACE}": " ", "Ω": "ohm", "√": "sqrt "})
RAISED, DIGITS = re.compile("[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+"), str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


class PlainConsole(Console):
    """Shows strings as they are, in titles and cells alike."""

    def render_str(self, text: str, *args: Any, **named: Any) -> Text:  # noqa: ANN401 - as rich has it
        """Without what a terminal would obey, in letters that it has."""
        return super().render_str(writable(text), *args, **named)


def console() -> Console:
    """Standard output, as wide as the terminal is, or as a log may be."""
    found = PlainConsole(highlight=False, markup=False, emoji=False)
    return found if found.is_terminal else PlainConsole(highlight=False, markup=False, emoji=False, width=WIDTH)


def writable(text: str) -> str:
    """Text that standard output can show: its signs in letters where its encoding has none."""
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeError:
        text = RAISED.sub(lambda found: f"**{found[0].translate(DIGITS)}", text).translate(IN_ASCII)
    return plain(text)


def show(document: Document) -> None:
    """Print what a document comes to, and the sections of it that are no detail."""
    shown = console()
    shown.print(Text(writable(document.subject), style="bold"))
    shown.print(Padding(writable(document.verdict), (1, 0)))
    answers = Grid(box=None, show_header=False, pad_edge=False)
    for question, answer in document.answers.items():
        answers.add_row(question, answer)
    if document.answers:
        shown.print(answers)
    for section in document.sections:
        parts = () if section.detail else tuple(filter(None, map(rendered, section.blocks)))
        if parts:
            shown.print(Padding(Text(section.heading, style="bold"), (1, 0, 0, 0)))
            for part in parts:
                shown.print(part)


def rendered(part: object) -> RenderableType | None:
    """A part of a document for a terminal; None of what only a page can show."""
    match part:
        case Table():
            return _grid(part)
        case Paragraph() | Code():
            return Text(writable(part.text))
        case Points():
            return Text(writable("\n".join(f"- {item}" for item in part.items)))
        case _:
            return None


def _grid(table: Table) -> Grid:
    found = Grid(title=table.caption or None, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for column in table.columns:
        found.add_column(column.heading, justify="right" if column.number else "left", overflow="fold")
    for number, row in enumerate(table.rows):
        found.add_row(*row, style="bold" if number in table.marked else "")
    return found


@contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """A bar on standard error for a piece of work, if that is a terminal, to be called with the share done, 0 to 1."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(plain(what), total=1.0)
        yield lambda share: bar.update(task, completed=share)
