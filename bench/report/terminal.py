"""A document on a terminal, and all other output of a command; text from files is shown and never executed."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import zip_longest

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

from bench.names import plain
from bench.report.document import Code, Document, Paragraph, Points, Table

#: Columns of a log: a terminal has its own width.
WIDTH = 110
#: Columns between those of a table and the least that a text takes in it, where there is room and where there is less.
LAYOUTS = ((3, WIDTH), (2, WIDTH), (2, 16), (1, 16))
#: Columns that a sentence wants, and those between a question and its answer.
LEAST_PROSE, APART = 30, 2
#: Rows of a table on one screen, which the list of all effects fits.
ROWS = 32
_VERBOSE: ContextVar[bool] = ContextVar("verbose", default=False)
#: Spaces at which no line ends: before a per cent sign, and next to an interval's.
KEPT = re.compile(r"(?<=\d) (?=[%±])|(?<=±) ")
#: Below the headings of a table, and how a headline looks by its tone.
RULE, TONES = "─", {"sure": "bold green", "open": "bold yellow", "refused": "bold red"}
#: Signs of a document in letters that every encoding has, and digits that are raised.
IN_ASCII = str.maketrans(
    {"·": "*", "−": "-", "±": "+-", "–": "-", "\N{NO-BREAK SPACE}": " ", "Ω": "ohm", "√": "sqrt ", "─": "-"}
)
RAISED, DIGITS = re.compile("[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+"), str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def console() -> Console:
    """Standard output, as wide as the terminal is, or as a log may be."""
    found = Console(highlight=False)
    return found if found.is_terminal else Console(highlight=False, width=WIDTH)


def writable(text: str) -> str:
    """Text that standard output can show: its signs in letters where its encoding has none."""
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeError:
        text = RAISED.sub(lambda found: f"**{found[0].translate(DIGITS)}", text).translate(IN_ASCII)
    return plain(text)


@contextmanager
def in_full() -> Iterator[None]:
    """Print every section and every row of a table within the block."""
    token = _VERBOSE.set(True)
    try:
        yield
    finally:
        _VERBOSE.reset(token)


def show(document: Document) -> None:
    """Print the verdict of a document, its answers, and its sections; the detailed ones only `in_full`."""
    width = console().width
    say(document.verdict, TONES[document.tone])
    say(document.subject + "\n" * bool(document.answers))
    beside = max(map(cell_len, document.answers), default=0) + APART
    for question, answer in document.answers.items():
        if width - beside < LEAST_PROSE:
            say(f"{question}\n  {answer}")
        else:
            first, *more = wrapped(writable(answer), width - beside)
            printed(Text("\n".join([_set(question, beside) + first, *(" " * beside + line for line in more)])))
    for section in document.sections:
        hidden = section.detail and not _VERBOSE.get()
        parts = () if hidden else tuple(filter(None, (rendered(part, width) for part in section.blocks)))
        if parts:
            say(f"\n{section.heading}", "bold")
            printed(Text("\n\n").join(parts))


def say(text: str, style: str = "") -> None:
    """Print lines of text, wrapped between words."""
    printed(Text("\n".join(wrapped(writable(text), console().width)), style))


def printed(text: Text) -> None:
    """Print lines that are as wide as they are to be."""
    console().print(text, soft_wrap=True)


def wrapped(text: str, width: int) -> list[str]:
    """Lines of a text no wider than a terminal, indented as it is; a word that is wider alone stays whole."""
    lines = []
    for line in KEPT.sub("\N{NO-BREAK SPACE}", text).split("\n"):
        indent = line[: len(line) - len(line.lstrip(" "))]
        held = indent
        for word in line.strip(" ").split(" "):
            if held.strip() and cell_len(held) + 1 + cell_len(word) > width:
                lines.append(held)
                held = indent + "  " * line.lstrip().startswith("- ")
            held += f" {word}" if held.strip() else word
        lines.append(held)
    return lines


def rendered(part: object, width: int) -> Text | None:
    """A part of a document for a terminal of so many columns; None of what only a page can show."""
    match part:
        case Table():
            return _table(part, width)
        case Paragraph():
            return Text("\n".join(wrapped(writable(part.text), width)))
        case Code():
            return Text(writable(part.text))
        case Points():
            return Text("\n".join(line for item in part.items for line in wrapped(f"- {writable(item)}", width)))
        case _:
            return None


def _table(table: Table, width: int) -> Text:
    """A table side by side where numbers and names have room, with less space between them at need; else stacked."""
    headings = [writable(column.heading) for column in table.columns]
    rows = [list(map(writable, row)) for row in table.rows]
    hidden = 0 if _VERBOSE.get() else len(rows) - ROWS
    if hidden > 1:
        kept = table.model_copy(update={"rows": table.rows[:ROWS], "links": (), "sketches": ()})
        more = Text(f"\n{hidden} more rows: add --verbose")
        return _table(kept, width).append_text(more)
    found = Text("\n".join([*wrapped(writable(table.caption), width), ""]) if table.caption else "")
    for gap, least in LAYOUTS:
        widths = _widths(table, headings, rows, width - gap * (len(headings) - 1), least)
        if widths:
            break
    else:
        return found.append_text(_stacked(table, headings, rows, width))

    def line(cells: list[str]) -> str:
        held = [wrapped(cell, widest) for cell, widest in zip(cells, widths, strict=True)]
        lines = []
        for parts in zip_longest(*held, fillvalue=""):
            set_ = map(_set, parts, widths, (column.number for column in table.columns))
            lines.append((" " * gap).join(set_).rstrip())
        return "\n".join(lines)

    rule = writable(RULE) * (sum(widths) + gap * (len(widths) - 1))
    found.append(line(headings), "bold").append(f"\n{rule}\n")
    shown = [Text(line(row), "bold" * (k in table.marked)) for k, row in enumerate(rows)]
    return found.append_text(Text("\n").join(shown))


def _widths(table: Table, headings: list[str], rows: list[list[str]], room: int, of_text: int) -> list[int]:
    """Width of each column, where texts, but no numbers, are wrapped between words; none where that is too much."""
    least, wanted = [], []
    for place, (column, heading) in enumerate(zip(table.columns, headings, strict=True)):
        cells = max((cell_len(row[place]) for row in rows), default=0)
        every = heading.split(" ") if column.number else [w for row in (headings, *rows) for w in row[place].split(" ")]
        enough = cells if column.number else min(cells, LEAST_PROSE if column.prose else of_text)
        least.append(max(enough, *map(cell_len, every)))
        wanted.append(max(cell_len(heading), cells))
    room -= sum(least)
    for place in sorted(range(len(least)), key=lambda place: table.columns[place].prose):
        more = min(max(room, 0), wanted[place] - least[place])
        least[place] += more
        room -= more
    return least if room >= 0 else []


def _stacked(table: Table, headings: list[str], rows: list[list[str]], width: int) -> Text:
    """A block for each row: its name, and below it each cell with its heading."""
    found = []
    for name, *cells in rows:
        lines = [f"  {heading}: {cell}" for heading, cell in zip(headings[1:], cells, strict=True) if cell]
        found.append(Text("\n".join(wrapped(name, width)), "bold"))
        found += [Text("\n".join(wrapped(line, width))) for line in lines]
    return Text("\n").join(found)


def _set(text: str, width: int, right: bool = False) -> str:
    """Text in so many columns of a terminal."""
    space = " " * (width - cell_len(text))
    return space + text if right else text + space


@contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """A bar on standard error for a piece of work, if that is a terminal, to be called with the share done, 0 to 1."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda share: None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn  # 0.02 s
    from rich.table import Column

    named = TextColumn("{task.description}", markup=False, table_column=Column(overflow="fold"))
    columns = (named, BarColumn(16), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(plain(what), total=1.0)
        yield lambda share: bar.update(task, completed=share)
