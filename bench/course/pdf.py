"""Pages of a PDF: a cover, then sections one after the other, each its text and its charts, on upright A4."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure, SubFigure

from bench.course.charts import chart_height, draw_chart
from bench.course.handin import Cover
from bench.course.result import Chart
from bench.course.section import Row, Section
from bench.names import plain

#: A4 upright, and its margin all around - inch; height of a line - inch; characters in a line, and in one of a table.
PAGE, MARGIN, LINE, CHARACTERS = (8.27, 11.69), 0.45, 0.18, 116
#: A chart gives up to this share of its height to stay on a page.
SHRUNK = 0.72


@dataclass(frozen=True)
class Line:
    """A line of text and how it is set."""

    text: str
    bold: bool = False
    table: bool = False


#: What stays together on a page.
Block = Chart | tuple[Line, ...]


@dataclass(frozen=True)
class Placed:
    """A block on a page, and the height it has there - inch."""

    block: Block
    height: float


def write_pages(
    path: Path,
    title: str,
    cover: Cover,
    about: Sequence[str],
    sections: Sequence[tuple[Section, tuple[Chart, ...]]],
) -> None:
    """Write a PDF.

    Args:
        path: file to write.
        title: of the document, on its cover.
        cover: who hands it in.
        about: paragraphs beneath.
        sections: text and charts of each.
    """
    blocks: list[Block] = [block for section, charts in sections for block in (*_text(section), *charts)]
    with PdfPages(path, metadata={"Title": title}) as pages:
        pages.savefig(_page([Placed(block, _height(block)) for block in _cover(title, cover, about)]))
        for page in _paginated(blocks):
            pages.savefig(_page(page))


def _cover(title: str, cover: Cover, about: Sequence[str]) -> Iterator[tuple[Line, ...]]:
    yield (Line(""), Line(""), Line(title, bold=True), Line(""))
    yield (Line(cover.group_line, bold=True), Line(""))
    for line in cover.lines:
        yield (Line(""), Line(""), Line(line, table=True))
    yield (Line(""), Line(""), Line(cover.declaration), Line(""))
    for text in about:
        yield (Line(""), *_paragraph(text))


def _paginated(blocks: Sequence[Block]) -> Iterator[list[Placed]]:
    """Blocks page by page; a heading stays with what follows, and a chart shrinks rather than leave half a page."""
    room = PAGE[1] - 2.0 * MARGIN
    page: list[Placed] = []
    left = room
    for k, block in enumerate(blocks):
        height = _height(block)
        after = blocks[k + 1] if k + 1 < len(blocks) else None
        kept = _height(after) if after is not None and _is_heading(block) else 0.0
        if isinstance(block, Chart) and SHRUNK * height <= left < height:
            height = left
        if page and height + (SHRUNK * kept if isinstance(after, Chart) else kept) > left:
            yield page
            page, left = [], room
        page.append(Placed(block, height))
        left -= height
    yield page


def _is_heading(block: Block) -> bool:
    return isinstance(block, tuple) and block[0].bold


def _height(block: Block) -> float:
    return chart_height(block) if isinstance(block, Chart) else LINE * len(block)


def _page(placed: Sequence[Placed]) -> Figure:
    figure = Figure(figsize=PAGE, layout="constrained")
    parts = list(_merged(placed))
    heights = [MARGIN, *(part.height for part in parts)]
    rest = max(PAGE[1] - sum(heights), 0.01)
    widths = (MARGIN, PAGE[0] - 2.0 * MARGIN, MARGIN)
    grid = figure.add_gridspec(len(heights) + 1, 3, height_ratios=[*heights, rest], width_ratios=widths)
    for k, part in enumerate(parts, start=1):
        subfigure = figure.add_subfigure(grid[k, 1])
        if isinstance(part.block, Chart):
            draw_chart(subfigure, part.block)
        else:
            _write(subfigure, part.block)
    return figure


def _merged(placed: Sequence[Placed]) -> Iterator[Placed]:
    """Texts that follow each other as one."""
    lines: tuple[Line, ...] = ()
    for part in placed:
        if isinstance(part.block, tuple):
            lines += part.block
            continue
        if lines:
            yield Placed(lines, LINE * len(lines))
            lines = ()
        yield part
    if lines:
        yield Placed(lines, LINE * len(lines))


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


def _text(section: Section) -> Iterator[tuple[Line, ...]]:
    """A section's text in parts that may stand on different pages."""
    paragraphs = [_paragraph(text) for text in section.findings]
    if section.missing:
        paragraphs.insert(0, _paragraph(f"Not done: {section.missing}"))
    first = paragraphs[0] if paragraphs else []
    yield (Line(""), Line(section.heading, bold=True), *first)
    yield from (tuple(paragraph) for paragraph in paragraphs[1:])
    if section.rows:
        known = ("truth", "error") if section.has_truth else ("", "")
        titles = _table_line(Row("quantity", "value", "unit", *known, "from"))
        rows = [_table_line(row) for row in section.rows]
        yield (Line(""), titles, *rows[:2])
        yield from ((row,) for row in rows[2:])


def _paragraph(text: str) -> list[Line]:
    return [Line(line) for line in textwrap.wrap(text, CHARACTERS)]


def _table_line(row: Row) -> Line:
    values = f"{row.name:<46.46}{row.value:>11}  {row.unit:<10}{row.truth:>8}{row.error:>9}"
    return Line(f"{values}  {row.source:.29}".rstrip(), table=True)
