"""The lab course's report: one HTML file with its figures inside, the same as a PDF, and its results as JSON."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from matplotlib import rc_context

from bench.course.cover import Cover
from bench.course.result import Chart, NotDone, Task
from bench.files import held, whole, write_text
from bench.report.charts import chart_figure
from bench.report.figures import quiet_about_glyphs
from bench.report.lab_json import lab_json
from bench.report.pdf import write_documents
from bench.report.section import section

TITLE = "Industrial Drives, Part 2: Identification of Mechanical Parameters"

Results = Sequence[Task | NotDone]


def write_lab_report(
    out: Path,
    results: Results,
    about: Sequence[str],
    progress: Callable[[float], None] = lambda share: None,
    cover: Cover | None = None,
    axis: str = "",
) -> list[Path]:
    """Write `lab.json`, `lab.html` and `lab.pdf` into a folder.

    Args:
        out: folder, made if it is not there.
        results: of the course.
        about: where the recordings come from, a paragraph each.
        progress: called with the share done.
        cover: who hands it in; a blank sheet without.
        axis: its name.

    Returns:
        Paths written.
    """
    data, html, pdf = out / "lab.json", out / "lab.html", out / "lab.pdf"
    cover = cover or Cover()
    with held(out), quiet_about_glyphs():
        write_text(data, lab_json(results, axis))
        write_text(html, lab_html(results, about, cover))
        progress(0.5)
        with whole(pdf) as temporary:
            write_documents(temporary, TITLE, cover, about, [(section(result), _charts(result)) for result in results])
    progress(1.0)
    return [data, html, pdf]


def lab_html(results: Results, about: Sequence[str], cover: Cover | None = None) -> str:
    """The report as one HTML page that needs no other file."""
    environment = Environment(
        loader=PackageLoader("bench.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    tasks = [
        (section(result), [_svg(c, f"{result.key}-{k}") for k, c in enumerate(_charts(result))]) for result in results
    ]
    page = environment.get_template("lab.html.j2")
    return page.render(title=TITLE, about=about, tasks=tasks, cover=cover or Cover())


def _charts(result: Task | NotDone) -> tuple[Chart, ...]:
    return result.charts if isinstance(result, Task) else ()


def _svg(chart: Chart, salt: str) -> Markup:
    """A chart as an SVG element; `salt` keeps its ids apart from those of the others on the page."""
    buffer = io.StringIO()
    with rc_context({"svg.hashsalt": salt, "svg.fonttype": "none"}):
        chart_figure(chart).savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return Markup(text[text.index("<svg") :])
