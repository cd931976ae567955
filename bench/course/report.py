"""The lab course's report: one HTML file with its figures inside, the same as a PDF, and its results as JSON."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from matplotlib import rc_context
from rich import box
from rich.table import Table

from bench import __version__
from bench.course.charts import chart_figure
from bench.course.course import RECORDED, Results, course
from bench.course.handin import Cover, write_sources
from bench.course.pdf import write_pages
from bench.course.recordings import LabRecordings
from bench.course.result import Chart, DoneTask, NotDone, Number
from bench.course.section import section
from bench.files import held, whole, write_text
from bench.report.figures import quiet_about_glyphs
from bench.structured import json_text

TITLE = "Industrial Drives, Part 2: Identification of Mechanical Parameters"
SCHEMA = "bench.lab/1"


@dataclass(frozen=True)
class CourseReport:
    """Results of every task, and the files of the report."""

    results: Results
    files: list[Path]

    @property
    def usable(self) -> bool:
        """Whether any task that needs a recording was done."""
        return any(isinstance(result, DoneTask) and result.key in RECORDED for result in self.results)


def report_course(data: Path | None, out: Path, progress: Callable[[float], None]) -> CourseReport:
    """Do the course and write `lab.json`, `lab.html` and `lab.pdf`, and the sources to hand in.

    Args:
        data: folder with a student's recordings, or None for the synthetic ones.
        out: folder of the report.
        progress: called with the share done.

    Raises:
        InputError: no such folder, a bad rig or group file in it, or a report's folder that cannot be written to.
    """
    recordings, cover = LabRecordings.in_folder(data), Cover.in_folder(data)
    results = course(recordings, lambda share: progress(0.7 * share))
    with held(out):
        about = about_recordings(recordings, results)
        files = write_lab_report(
            out, results, about, lambda share: progress(0.7 + 0.3 * share), cover, recordings.rig.name
        )
        sources = write_sources(out / "sources", recordings, results)
    return CourseReport(results, [*sources, *files])


def about_recordings(recordings: LabRecordings, results: Results) -> list[str]:
    """Where the recordings come from, a paragraph each."""
    done = [result for result in results if isinstance(result, DoneTask)]
    own = sum(not result.example for result in done)
    origin = (
        "Synthetic recordings of the rig in MuJoCo" if recordings.synthetic else f"Recordings in {recordings.folder}"
    )
    about = [
        f"{origin}; axis: {recordings.rig.name}. {own} of {len(results)} sections done on them, "
        f"{len(done) - own} on the embedded example, {len(results) - len(done)} not done.",
        "Beside every number stands where it comes from: the recording, the rig file, the motor's datasheet, "
        "the course, an assumption, a simulation, or the embedded example.",
    ]
    if recordings.synthetic:
        about.append("Where a truth stands beside a number, it is the value that the axis was simulated with.")
    return about


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
            write_pages(temporary, TITLE, cover, about, [(section(result), _charts(result)) for result in results])
    progress(1.0)
    return [data, html, pdf]


def lab_html(results: Results, about: Sequence[str], cover: Cover | None = None) -> str:
    """The report as one HTML page that needs no other file."""
    environment = Environment(
        loader=PackageLoader("bench.course"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    tasks = [
        (section(result), [_svg(c, f"{result.key}-{k}") for k, c in enumerate(_charts(result))]) for result in results
    ]
    page = environment.get_template("lab.html.j2")
    return page.render(title=TITLE, about=about, tasks=tasks, cover=cover or Cover())


def _charts(result: DoneTask | NotDone) -> tuple[Chart, ...]:
    return result.charts if isinstance(result, DoneTask) else ()


def _svg(chart: Chart, salt: str) -> Markup:
    """A chart as an SVG element; `salt` keeps its ids apart from those of the others on the page."""
    buffer = io.StringIO()
    with rc_context({"svg.hashsalt": salt, "svg.fonttype": "none"}):
        chart_figure(chart).savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return Markup(text[text.index("<svg") :])


def lab_json(results: Results, axis: str) -> str:
    """Every number with unit, truth where it is known, and source; of what was not done, what is missing.

    Args:
        results: of the course.
        axis: its name.
    """
    content = {"schema": SCHEMA, "version": __version__, "axis": axis, "tasks": [_task(result) for result in results]}
    return json_text(content, ascii_only=False) + "\n"


def _task(result: DoneTask | NotDone) -> dict[str, object]:
    named = {"key": result.key, "title": result.title}
    if isinstance(result, NotDone):
        return {**named, "status": "not_done", "reason": str(result.reason)}
    return {
        **named,
        "status": "done",
        "embedded_example": result.example,
        "says": list(result.findings),
        "numbers": [_number(number) for number in result.numbers],
    }


def _number(number: Number) -> dict[str, object]:
    value = number.value if math.isfinite(number.value) else None
    return {"name": number.name, "value": value, "unit": number.unit, "truth": number.truth, "source": number.source}


def course_table(results: Results) -> Table:
    """Every number with its unit, beside its truth where that is known; of what was not done, what is missing."""
    table = Table(box=box.SIMPLE_HEAD, title="Lab course", title_justify="left")
    table.add_column("task", no_wrap=True)
    table.add_column("quantity", overflow="fold")
    for heading in ("value", "truth", "error"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for printed in map(section, results):
        if printed.missing:
            table.add_row(printed.key, f"not done: {printed.missing}", style="yellow")
        for k, row in enumerate(printed.rows):
            key = printed.key if k == 0 else ""
            table.add_row(key, row.name, row.value, row.truth, row.error, row.unit)
    return table
