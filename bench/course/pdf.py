"""A document as pages of a PDF, upright A4: its first section is the cover, the others follow each other."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

from matplotlib import rc_context
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure, SubFigure

from bench.names import plain
from bench.report import figures
from bench.report.document import Chart, Document, Paragraph, Section, Table

#: A4 upright, and its margin all around - inch; height of a line - inch; characters in a line, and in one of a table.
PAGE, MARGIN, LINE, CHARACTERS, IN_TABLE = (8.27, 11.69), 0.45, 0.18, 116, 114
#: No column of words is made narrower - characters.
NARROW = 12
#: Size of a legend's letters, of which four entries stand beside each other - points.
LEGEND = 6.2
#: A chart gives up to this share of its height to stay on a page.
SHRUNK = 0.72


@dataclass(frozen=True)
class Line:
    """A line of text and how it is set."""

    text: str = ""
    bold: bool = False
    table: bool = False


#: What stays together on a page.
Together = Chart | tuple[Line, ...]


@dataclass(frozen=True)
class OnPage:
    """What stays together, and the height it has on its page - inch."""

    content: Together
    height: float


def write_pdf(path: Path, document: Document) -> None:
    """Write a document's title, first section and answers on one page, and the other sections on the following ones."""
    # TrueType, which is searched and copied from; matplotlib's own Type 3 is not
    with rc_context({"pdf.fonttype": 42}), PdfPages(path, metadata={"Title": document.title}) as pages:
        pages.savefig(page([OnPage(lines, height(lines)) for lines in cover(document)]))
        contents = paginated([one for section in document.sections[1:] for one in flowing(section)])
        for number, content in enumerate(contents, 2):
            drawn = page(content)
            drawn.text(0.5, 0.02, f"{number}", size=8.0, ha="center")
            pages.savefig(drawn)


def cover(document: Document) -> Iterator[tuple[Line, ...]]:
    """The first page: a table on it has room to sign between its rows."""
    yield (Line(), Line(), Line(document.title, bold=True), Line())
    for block in document.sections[0].blocks:
        if isinstance(block, Table):
            yield (Line(block.caption, bold=True), Line())
            yield from ((Line(), Line(), row) for row in _rows(block))
        elif isinstance(block, Paragraph):
            yield (Line(), Line(), *_paragraph(block.text))
    for text in (document.verdict, *document.answers.values()):
        yield (Line(), *_paragraph(text))


def flowing(section: Section) -> Iterator[Together]:
    """A section in parts that may stand on different pages; its heading stays with what comes first."""
    head = [Line(), Line(section.heading, bold=True)]
    for block in section.blocks:
        if isinstance(block, Paragraph):
            yield (*head, *_paragraph(block.text))
        elif isinstance(block, Table):
            titles, *rows = _rows(block)
            yield (*(head or [Line()]), titles, *rows[:2])
            yield from ((row,) for row in rows[2:])
        elif isinstance(block, Chart):
            if head:
                yield tuple(head)
            yield block
        head = []


def paginated(contents: Sequence[Together]) -> Iterator[list[OnPage]]:
    """Contents page by page; a heading stays with what follows, and a chart shrinks rather than leave half a page."""
    room = PAGE[1] - 2.0 * MARGIN
    page: list[OnPage] = []
    left = room
    for k, content in enumerate(contents):
        needed = height(content)
        after = contents[k + 1] if k + 1 < len(contents) else None
        kept = height(after) if after is not None and _is_heading(content) else 0.0
        if isinstance(content, Chart) and SHRUNK * needed <= left < needed:
            needed = left
        if page and needed + (SHRUNK * kept if isinstance(after, Chart) else kept) > left:
            yield page
            page, left = [], room
        page.append(OnPage(content, needed))
        left -= needed
    yield page


def height(content: Together) -> float:
    """Height that it takes - inch."""
    return figures.height(content) if isinstance(content, Chart) else LINE * len(content)


@figures.in_style
def page(placed: Sequence[OnPage]) -> Figure:
    """A page with its contents one below the other."""
    figure = Figure(figsize=PAGE, layout="constrained")
    parts = list(_merged(placed))
    heights = [MARGIN, *(part.height for part in parts)]
    rest = max(PAGE[1] - sum(heights), 0.01)
    widths = (MARGIN, PAGE[0] - 2.0 * MARGIN, MARGIN)
    grid = figure.add_gridspec(len(heights) + 1, 3, height_ratios=[*heights, rest], width_ratios=widths)
    for k, part in enumerate(parts, start=1):
        subfigure = figure.add_subfigure(grid[k, 1])
        if isinstance(part.content, Chart):
            with rc_context({"legend.fontsize": LEGEND}):
                figures.draw(subfigure, part.content)
        else:
            _write(subfigure, part.content)
    return figure


def _is_heading(content: Together) -> bool:
    return isinstance(content, tuple) and any(line.bold for line in content[:2])


def _merged(placed: Sequence[OnPage]) -> Iterator[OnPage]:
    """Texts that follow each other as one."""
    lines: tuple[Line, ...] = ()
    for part in placed:
        if isinstance(part.content, tuple):
            lines += part.content
            continue
        if lines:
            yield OnPage(lines, height(lines))
            lines = ()
        yield part
    if lines:
        yield OnPage(lines, height(lines))


def _write(part: SubFigure, lines: Sequence[Line]) -> None:
    for k, line in enumerate(lines):
        part.text(
            0.01,
            1.0 - (k + 0.25) / len(lines),
            plain(line.text),
            va="top",
            size=7.6 if line.table else 11.0 if line.bold else 9.0,
            weight="bold" if line.bold else "normal",
            family="monospace" if line.table else "sans-serif",
            parse_math=False,
        )


def _paragraph(text: str) -> list[Line]:
    return [Line(line) for line in textwrap.wrap(text, CHARACTERS)]


def _rows(table: Table) -> list[Line]:
    """Headings and rows of a table, each cell as wide as the widest of its column; words wrap where all is too wide."""
    rows = [[column.heading for column in table.columns], *table.rows]
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    numbers = [column.number for column in table.columns]
    words = [k for k, number in enumerate(numbers) if not number]
    while words and sum(widths) + 2 * (len(widths) - 1) > IN_TABLE:
        widest = max(words, key=lambda k: widths[k])
        if widths[widest] <= NARROW:
            break
        widths[widest] -= 1
    return [Line(text, table=True) for row in rows for text in _row(row, widths, numbers)]


def _row(cells: Sequence[str], widths: Sequence[int], numbers: Sequence[bool]) -> Iterator[str]:
    wrapped = [textwrap.wrap(cell, width) for cell, width in zip(cells, widths, strict=True)]
    for parts in zip_longest(*wrapped, fillvalue=""):
        columns = zip(parts, widths, numbers, strict=True)
        yield "  ".join(cell.rjust(width) if number else cell.ljust(width) for cell, width, number in columns).rstrip()
