"""Pages of a PDF: sections one after the other, each its text and its charts, on upright A4."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure, SubFigure

from bench.lab.result import Chart
from bench.report.charts import chart_height, draw_chart
from bench.report.section import Row, Section

#: A4 upright, and its margin all around - inch; height of a line - inch; characters in a line.
PAGE, MARGIN, LINE, CHARACTERS = (8.27, 11.69), 0.45, 0.18, 116


@dataclass(frozen=True)
class Line:
    """A line of text and how it is set."""

    text: str
    bold: bool = False
    table: bool = False


Block = Chart | tuple[Line, ...]


def write_pages(
    path: Path, title: str, about: Sequence[str], sections: Sequence[tuple[Section, tuple[Chart, ...]]]
) -> None:
    """Write a PDF.

    Args:
        path: file to write.
        title: of the document, on its first page.
        about: paragraphs beneath it.
        sections: text and charts of each.
    """
    head = (Line(title, bold=True), Line(""), *(line for text in about for line in _paragraph(text)))
    blocks: list[Block] = [head]
    for section, charts in sections:
        blocks += [_text(section), *charts]
    with PdfPages(path, metadata={"Title": title}) as pages:
        for page in _paginated(blocks):
            pages.savefig(_page(page))


def _paginated(blocks: Sequence[Block]) -> list[list[Block]]:
    """Blocks page by page; a text that its first chart would leave alone goes to the next page with it."""
    room = PAGE[1] - 2.0 * MARGIN
    pages: list[list[Block]] = [[]]
    for k, block in enumerate(blocks):
        after = blocks[k + 1] if k + 1 < len(blocks) else None
        needed = _height(block) + (_height(after) if isinstance(block, tuple) and isinstance(after, Chart) else 0.0)
        if pages[-1] and sum(map(_height, pages[-1])) + needed > room:
            pages.append([])
        pages[-1].append(block)
    return pages


def _height(block: Block) -> float:
    return chart_height(block) if isinstance(block, Chart) else LINE * (len(block) + 1)


def _page(blocks: Sequence[Block]) -> Figure:
    figure = Figure(figsize=PAGE, layout="constrained")
    heights = [MARGIN, *map(_height, blocks)]
    rest = max(PAGE[1] - sum(heights), 0.01)
    widths = (MARGIN, PAGE[0] - 2.0 * MARGIN, MARGIN)
    grid = figure.add_gridspec(len(heights) + 1, 3, height_ratios=[*heights, rest], width_ratios=widths)
    for k, block in enumerate(blocks, start=1):
        part = figure.add_subfigure(grid[k, 1])
        if isinstance(block, Chart):
            draw_chart(part, block)
        else:
            _write(part, block)
    return figure


def _write(part: SubFigure, lines: Sequence[Line]) -> None:
    for k, line in enumerate(lines):
        part.text(
            0.01,
            1.0 - (k + 0.5) / (len(lines) + 1),
            line.text,
            va="top",
            size=8.2 if line.table else 11.0 if line.bold else 9.0,
            weight="bold" if line.bold else "normal",
            family="monospace" if line.table else "sans-serif",
            parse_math=False,
        )


def _text(section: Section) -> tuple[Line, ...]:
    lines = [Line(section.heading, bold=True)]
    if section.missing:
        lines += _paragraph(f"Not done: {section.missing}")
    for paragraph in section.says:
        lines += _paragraph(paragraph)
    if section.rows:
        known = ("truth", "error") if section.has_truth else ("", "")
        titles = Row("quantity", "value", "unit", *known)
        lines += [_table_line(row) for row in (titles, *section.rows)]
    return tuple(lines)


def _paragraph(text: str) -> list[Line]:
    return [Line(line) for line in textwrap.wrap(text, CHARACTERS)]


def _table_line(row: Row) -> Line:
    return Line(f"{row.name:<46}{row.value:>12}  {row.unit:<11}{row.truth:>11}{row.error:>11}".rstrip(), table=True)
