"""A document as pages of a PDF, typeset by Typst: cover and answers on the first page, contents, a section a task."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from matplotlib import get_data_path, rc_context
from matplotlib.figure import Figure

from bench.assets import asset
from bench.course.course import EQUATIONS
from bench.names import plain
from bench.report import figures
from bench.report.document import AnyPart, Chart, Document, Paragraph, Section, Table

TEMPLATE = asset("data", "lab", "report.typ")
#: Fonts that matplotlib brings along: TrueType, which is searched and copied from.
FONTS = Path(get_data_path()) / "fonts" / "ttf"
#: Width of a diagram - inch, height of what it has on a screen, its most - inch, and size of a legend's letters, of
#: which four entries are next to each other - points.
WIDTH, SHARE, MOST, LEGEND = 6.7, 0.64, 3.6, 6.2
#: Sections of the first page; room above and below a row of a table that is signed, and of others - points.
FRONT, SIGNED, ROW = 2, 9.0, 3.4
#: An equation is a paragraph that ends in this space, and its number in the course's text, where it has one.
EQUATION = "\u2003"
MATHEMATICS = {equation.text: equation.mathematics for equation in EQUATIONS.values()}


def no_typst() -> str:
    """Why no PDF can be written, and what to do; empty where one can."""
    missing = find_spec("typst") is None
    return "no lab.pdf, which needs typst: pip install 'servobench[lab]', or print lab.html" if missing else ""


def write_pdf(path: Path, document: Document) -> None:
    """Write a document: title and its first two sections on one page, then answers, contents and the other sections."""
    with tempfile.TemporaryDirectory() as folder:
        path.write_bytes(compiled(typeset(document, Path(folder)), Path(folder)))


def compiled(content: Mapping[str, Any], folder: Path, **options: Any) -> Any:  # noqa: ANN401, bytes of each file
    """What is typeset, with its diagrams in a folder, as bytes, with options of typst.compile."""
    import typst  # of the extra `lab`

    template = folder / TEMPLATE.name
    (folder / "document.json").write_text(json.dumps(content), encoding="utf-8")
    template.write_bytes(TEMPLATE.read_bytes())
    return typst.compile(template, font_paths=[FONTS], ignore_system_fonts=True, **options)


def typeset(document: Document, folder: Path) -> dict[str, Any]:
    """What the template takes of a document; its diagrams are drawn into a folder."""
    sections = [_section(section, folder, place) for place, section in enumerate(document.sections)]
    about = [document.verdict, *document.answers.values()]
    front, rest = sections[:FRONT], sections[FRONT:]
    return {"title": plain(document.title), "front": front, "about": [*map(plain, about)], "sections": rest}


def _section(section: Section, folder: Path, place: int) -> dict[str, Any]:
    row = ROW if place else SIGNED
    parts = [_part(block, folder / f"{section.key}-{k}.svg", row) for k, block in enumerate(section.blocks)]
    return {"heading": plain(section.heading), "blocks": [part for part in parts if part]}


def _part(block: AnyPart, file: Path, row: float) -> dict[str, Any]:
    """A part of a section; none of what paper does not show."""
    match block:
        case Chart():
            with figures.quiet_about_glyphs(), rc_context({"svg.fonttype": "none"}):  # the text, not its outlines
                _diagram(block).savefig(file)
            alternative = {"title": plain(block.title), "alternative": plain(block.alternative)}
            return {"kind": "chart", "file": file.name, **alternative}
        case Table():
            columns = [
                {"heading": plain(column.heading), "number": column.number, "prose": column.prose}
                for column in block.columns
            ]
            rows = [[plain(cell) for cell in cells] for cells in block.rows]
            return {"kind": "table", "caption": plain(block.caption), "columns": columns, "rows": rows, "row": row}
        case Paragraph() if EQUATION in block.text:
            text, number = block.text.split(EQUATION)
            return {"kind": "equation", "mathematics": MATHEMATICS[text], "text": text, "number": number}
        case Paragraph():
            return {"kind": "paragraph", "text": plain(block.text)}
    return {}


@figures.in_style
def _diagram(chart: Chart) -> Figure:
    """A diagram without its title, which is below it, and with the units of several panels on lines of their own."""
    height, draw = figures.drawing(chart)
    panels = chart.panels
    if len(panels) > 1:
        panels = tuple(one.model_copy(update={"y_label": one.y_label.replace(" / ", " /\n")}) for one in panels)
    with rc_context({"legend.fontsize": LEGEND}):
        figure = Figure(figsize=(WIDTH, min(SHARE * height, MOST)), layout="constrained")
        draw(figure, chart.model_copy(update={"title": "", "panels": panels}))
    return figure
