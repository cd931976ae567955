"""The lab course's report: one document with a section a task, as page, PDF and table, and its results as JSON."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench import __version__
from bench.course.course import RECORDED, Results, course
from bench.course.handin import Cover, write_sources
from bench.course.pdf import write_pdf
from bench.course.recordings import LabRecordings
from bench.course.result import DoneTask, NotDone, Number
from bench.files import held, whole, write_text
from bench.report.document import Document, Paragraph, Section, Table, table
from bench.report.figures import quiet_about_glyphs
from bench.report.html import html
from bench.report.serial import known
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
        document = lab_document(results, recordings, cover)
        json = lab_json(results, recordings.rig.name)
        files = write_lab_report(out, document, json, lambda share: progress(0.7 + 0.3 * share))
        sources = write_sources(out / "sources", recordings, results)
    return CourseReport(results, [*sources, *files])


def write_lab_report(
    out: Path, document: Document, json: str, progress: Callable[[float], None] = lambda share: None
) -> list[Path]:
    """Write `lab.json`, `lab.html` and `lab.pdf` into a folder.

    Args:
        out: folder, made if it is not there.
        document: of the results.
        json: of the same.
        progress: called with the share done.

    Returns:
        Paths written.
    """
    paths = [out / f"lab.{ending}" for ending in ("json", "html", "pdf")]
    with held(out), quiet_about_glyphs():
        write_text(paths[0], json)
        write_text(paths[1], html(document))
        progress(0.5)
        with whole(paths[2]) as temporary:
            write_pdf(temporary, document)
    progress(1.0)
    return paths


def lab_document(results: Results, recordings: LabRecordings, cover: Cover) -> Document:
    """The report.

    Args:
        results: of the course.
        recordings: it was done on.
        cover: who hands it in.
    """
    done = [result for result in results if isinstance(result, DoneTask)]
    own, missing = sum(not result.example for result in done), len(results) - len(done)
    origin = (
        "Synthetic recordings of the rig in MuJoCo" if recordings.synthetic else f"Recordings in {recordings.folder}"
    )
    answers = {
        "Recordings": f"{origin}; axis: {recordings.rig.name}.",
        "Sources": "Beside every number stands where it comes from: the recording, the rig file, the motor's "
        "datasheet, the course, an assumption, a simulation, or the embedded example.",
    }
    if recordings.synthetic:
        answers["Truth"] = "Where a truth stands beside a number, it is the value that the axis was simulated with."
    return Document(
        title=TITLE,
        subject=TITLE,
        verdict=f"{own} of {len(results)} sections done on the recordings, {len(done) - own} on the embedded example, "
        f"{missing} not done.",
        tone="open" if missing else "sure",
        answers=answers,
        sections=(_cover_sheet(cover), *map(task_section, results)),
        origin=(f"servobench {__version__}",),
    )


def _cover_sheet(cover: Cover) -> Section:
    rows = [(name or "_" * 26, number or "_" * 12, "_" * 24) for name, number in cover.rows]
    group = f"Group: {cover.group or '_' * 12}"
    signed = table(group, ("name", "student number", "signature"), rows)
    return Section(key="cover", heading="Cover sheet", blocks=(signed, Paragraph(text=cover.declaration)))


def task_section(result: DoneTask | NotDone) -> Section:
    """A task, or what it is missing."""
    key = f"task-{result.key}"
    heading = f"Task {result.key}: {result.title}" if result.key.isdigit() else result.title
    if isinstance(result, NotDone):
        return Section(key=key, heading=heading, blocks=(Paragraph(text=f"Not done: {result.reason}"),))
    if result.example:
        heading = f"{heading} (embedded example)"
    findings = (Paragraph(text=finding) for finding in result.findings)
    return Section(key=key, heading=heading, blocks=(*findings, _numbers_table(result.numbers), *result.charts))


def _numbers_table(numbers: Sequence[Number]) -> Table:
    """Every number with its unit and source, and where any truth is known beside it."""
    if any(number.truth is not None for number in numbers):
        headings = ("quantity", "value>", "unit", "truth>", "error>", "from")
        return table("Results", headings, [(*_cells(number), number.source) for number in numbers])
    rows = [(*_cells(number)[:3], number.source) for number in numbers]
    return table("Results", ("quantity", "value>", "unit", "from"), rows)


def _cells(number: Number) -> tuple[str, str, str, str, str]:
    """Name, value with five digits, unit, truth, and how far the value is from that."""
    truth = number.truth
    error = f"{number.value / truth - 1.0:+.3%}" if truth else ""
    return number.name, f"{number.value:.5g}", number.unit, "" if truth is None else f"{truth:.5g}", error


def course_table(results: Results) -> Table:
    """Every number with its unit, beside its truth where that is known; of what was not done, what is missing."""
    rows: list[tuple[str, ...]] = []
    marked = []
    for result in results:
        if isinstance(result, NotDone):
            marked.append(len(rows))
            rows.append((result.key, f"not done: {result.reason}", "", "", "", ""))
            continue
        for place, number in enumerate(result.numbers):
            name, value, unit, truth, error = _cells(number)
            rows.append(("" if place else result.key, name, value, truth, error, unit))
    return table("Lab course", ("task", "quantity", "value>", "truth>", "error>", "unit"), rows, marked)


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
        "numbers": [{**vars(number), "value": known(number.value)} for number in result.numbers],
    }
