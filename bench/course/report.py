"""The lab course's report: one document with a section a task, as page, PDF and table, and its results as JSON."""

from __future__ import annotations

import itertools
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench import __version__
from bench.arrays import NORMAL95, Array
from bench.assets import asset
from bench.course import methods
from bench.course.course import TASKS, course
from bench.course.friction import REMAINING
from bench.course.methods import KG_CM2
from bench.course.pdf import EQUATION, no_typst, write_pdf
from bench.course.recordings import LabRecordings
from bench.course.result import Number, TaskResult, thinned
from bench.errors import InputError
from bench.files import held, whole, write_text
from bench.parameter import Parameter
from bench.report.document import AnyPart, Chart, Document, Paragraph, Section, Table, section, table
from bench.report.html import html
from bench.report.numbers import interval
from bench.report.serial import known
from bench.rig.motor import DATASHEET
from bench.structured import json_text, read_toml

TITLE = "Industrial Drives, Part 2: Identification of Mechanical Parameters"
SCHEMA = "bench.lab/1"
SCRIPTS = asset("data", "lab", "scripts")
#: What the scripts import.
SHARED = (SCRIPTS / "course.py", Path(methods.__file__))
#: The same for MATLAB and Octave: the task that has to be done for each; all others are functions that they call.
MATLAB = {"catapult": "1", "JLoad_no_Friction": "6", "JLoad_with_Friction": "9", "SpeedTorqueLimit": "10"}
#: Factors to SI of what task 11 takes from task 9, by the names there.
OF_TASK_9 = {"J": 1.0 / KG_CM2, "K_fric_w": 1.0, "K_fric_0": 1.0}
OF_THE_WINDING = ("rotor_inertia", "cold_resistance_share", "electrical_time_constant", "thermal_time_constant")
#: So many of a task's numbers stand on the first table.
FIRST = 3
#: File of who hands a report in, and rows of a sheet that is filled in by hand.
FILE, BLANK_ROWS = "group.toml", 3
EXAMPLE = 'group = "7", and for each member [[student]] with name = "..." and number = "..."'
DECLARATION = "We recorded and evaluated this ourselves; the sources are in the folder of this report."


@dataclass(frozen=True)
class Cover:
    """Who hands a report in.

    Attributes:
        group: its name or number; empty to be filled in by hand.
        students: name and student number of each; none likewise.
    """

    group: str = ""
    students: tuple[tuple[str, str], ...] = ()

    @classmethod
    def in_folder(cls, folder: Path | None) -> Cover:
        """From `group.toml` in a folder; blank without one. Raises InputError where its content is wrong."""
        path = folder / FILE if folder is not None else None
        if path is None or not path.exists():
            return cls()
        content = read_toml(path, f"a cover sheet, {EXAMPLE},")
        students = content.get("student", [])
        unknown = sorted(set(content) - {"group", "student"})
        named = isinstance(students, list) and all(
            isinstance(entry, dict) and {"name", "number"} == set(entry) for entry in students
        )
        if unknown or not named:
            found = f"found {', '.join(unknown) or 'a student without name or number'}"
            raise InputError(path, found, f"allowed: {EXAMPLE}")
        return cls(str(content.get("group", "")), tuple((str(s["name"]), str(s["number"])) for s in students))

    def sheet(self, synthetic: bool) -> Section:
        """To be signed, with blank rows where no students are given; only a note for `synthetic` recordings."""
        if synthetic:
            note = "Synthetic recordings, simulated in MuJoCo: an example of a report, not one to hand in."
            return section("cover", "Cover sheet", Paragraph(text=note))
        students = self.students or (("", ""),) * BLANK_ROWS
        rows = [(name or "_" * 26, number or "_" * 12, "_" * 24) for name, number in students]
        signed = table(f"Group: {self.group or '_' * 12}", ("name", "student number", "signature"), rows)
        return section("cover", "Cover sheet", signed, Paragraph(text=DECLARATION))


@dataclass(frozen=True)
class CourseReport:
    """Results of every task, and the files of the report."""

    results: Sequence[TaskResult]
    files: list[Path]

    @property
    def usable(self) -> bool:
        """Whether any task that needs a recording was done."""
        recorded = {task.key for task in TASKS if task.needs == "recordings"}
        return any(result.reason is None and result.key in recorded for result in self.results)


def report_course(data: Path | None, out: Path, progress: Callable[[float], None]) -> CourseReport:
    """Do the course and write `lab.json`, `lab.html` and `lab.pdf`, and the sources to hand in, into a folder.

    Args:
        data: folder with a student's recordings, or None for the synthetic ones.
        out: where to write.
        progress: called with the share done.

    Raises:
        InputError: no such folder, a bad rig or group file in it, or a report's folder that cannot be written to.
    """
    recordings, cover = LabRecordings.in_folder(data), Cover.in_folder(data)
    results = course(recordings, lambda share: progress(0.7 * share))
    with held(out):
        document, content = lab_document(results, recordings, cover), lab_json(results, recordings.rig.name)
        files = write_lab_report(out, document, content, lambda share: progress(0.7 + 0.3 * share))
        sources = write_sources(out / "sources", recordings, results)
    return CourseReport(results, [*sources, *files])


def write_lab_report(out: Path, document: Document, json: str, progress: Callable[[float], None]) -> list[Path]:
    """Write results as `lab.json`, `lab.html` and, with Typst, `lab.pdf` into a folder, which is made; the paths."""
    paths = [out / f"lab.{ending}" for ending in ("json", "html", "pdf")]
    with held(out):
        write_text(paths[0], json)
        write_text(paths[1], html(document))
        progress(0.5)
        if no_typst():
            paths.pop()
        else:
            with whole(paths[2]) as temporary:
                write_pdf(temporary, document)
    progress(1.0)
    return paths


def lab_document(results: Sequence[TaskResult], recordings: LabRecordings, cover: Cover) -> Document:
    """The report of results on recordings, with who hands it in."""
    missing = [result.key for result in results if result.reason is not None and result.key.isdigit()]
    count = sum(result.key.isdigit() for result in results)
    not_done = f"; not done: {', '.join(missing)}" if missing else ""
    origin = (
        "Synthetic recordings of the rig in MuJoCo" if recordings.synthetic else f"Recordings in {recordings.folder}"
    )
    record = "Record the axis, and run bench lab --data FOLDER" if recordings.synthetic else "Fill in the cover sheet"
    truth = " A truth next to a number is the value that the axis was simulated with." if recordings.synthetic else ""
    answers = {
        **_first_answers({result.key: result for result in results}),
        "What next?": f"{f'Task {missing[0]} states what it needs' if missing else record}.",
        "Recordings": f"{origin}; axis: {recordings.rig.name}. Tasks 2 to 4 need none: they follow from the datasheet.",
        "Sources": "Each number has its source: the recording, the rig file, the motor's datasheet, the course, an "
        f"assumption or a simulation.{truth}",
    }
    return Document(
        title=TITLE,
        subject=TITLE,
        verdict=f"{count - len(missing)} of {count} tasks done{not_done}.",
        tone="open" if missing else "sure",
        answers=answers,
        sections=(cover.sheet(recordings.synthetic), *numbered((summary(results), *map(task_section, results)))),
        origin=(f"servobench {__version__}",),
    )


def _first_answers(results: Mapping[str, TaskResult]) -> dict[str, str]:
    """What task 9 and the simulation of tracking come to; nothing of a report without task 9."""
    fitted = results.get("9")
    if fitted is None:
        return {}
    if fitted.reason is not None:
        return {"Inertia and friction?": "Not determined: see task 9."}
    left, tracked = fitted[REMAINING], results.get("tracking")
    moves = "Not simulated: the rig lacks what that needs."
    if tracked is not None and tracked.reason is None:
        off, without = (tracked[f"RMS deviation, J_load {which}"].value for which in ("identified", "= 0"))
        moves = f"In simulation the position is {off:.3g}° RMS off its plan with the identified J_load in the "
        moves += f"feed-forward, {without:.3g}° without J_load."
    return {
        "Inertia and friction?": f"{'; '.join(map(_short, fitted.numbers[:FIRST]))}.",
        "How sure?": "± is half of the interval of 95 %, if nothing but inertia and friction acts.",
        "What was missing?": f"{left.value:.3g} {left.unit} RMS of torque, which inertia and friction do not explain. "
        "bench diagnose RECORDING --rig RIG finds its causes.",
        "Does it move like the axis?": moves,
    }


def summary(results: Sequence[TaskResult]) -> Section:
    """What each task comes to, on one table: its answer in words, and its first numbers, or that it was not done."""
    rows: list[tuple[str, ...]] = []
    for result in (result for result in results if result.key.isdigit()):
        if result.reason is not None:
            rows.append((result.key, f"{result.title}: not done, see there", ""))
            continue
        numbers = "; ".join(_short(number) for number in result.numbers[:FIRST])
        rows.append((result.key, result.findings[0], numbers))
    return section("answers", "Answers", table("The answers", ("task", "answer~", "numbers~"), rows))


def _short(number: Number) -> str:
    half, unit = number.half or 0.0, "" if number.unit == "1" else number.unit
    ends = number.value - half, number.value + half
    return f"{number.name} = {interval(Parameter(number.value, unit, half / NORMAL95, ends))}"


def numbered(sections: Iterable[Section]) -> Iterator[Section]:
    """Sections with their diagrams and tables numbered through."""
    figures, tables = (itertools.count(1) for _ in range(2))

    def with_number(block: AnyPart) -> AnyPart:
        match block:
            case Chart():
                return block.model_copy(update={"title": f"Figure {next(figures)}: {block.title}"})
            case Table():
                return block.model_copy(update={"caption": f"Table {next(tables)}: {block.caption}"})
        return block

    for each in sections:
        yield each.model_copy(update={"blocks": tuple(map(with_number, each.blocks))})


def task_section(result: TaskResult) -> Section:
    """A task, or what it is missing."""
    key = f"task-{result.key}"
    heading = f"Task {result.key}: {result.title}" if result.key.isdigit() else result.title
    if result.reason is not None:
        return section(key, heading, Paragraph(text=f"Not done: {result.reason}"), *result.charts)
    solved = [f"{result.equation.text}{EQUATION}{result.equation.number}"] if result.equation else []
    said = (Paragraph(text=text) for text in (*solved, *result.findings))
    numbers = _numbers_table(f"Numbers of {heading.split(':')[0].lower()}", result.numbers)
    return section(key, heading, *said, *result.tables, numbers, *map(thinned, result.charts))


def _numbers_table(caption: str, numbers: Sequence[Number]) -> Table:
    """Every number with its unit and source; with how well it is known and its truth, where any is."""
    halves = ("± (95 %)>",) if any(number.half is not None for number in numbers) else ()
    truths = ("truth>", "error>") if any(number.truth is not None for number in numbers) else ()
    columns = ("quantity", "value>", *halves, "unit", *truths, "from")
    return table(caption, columns, [_cells(number, columns) for number in numbers])


def _cells(number: Number, columns: Iterable[str]) -> list[str]:
    """A number in the columns of a table, empty where it is not known."""
    half, truth = number.half, number.truth
    cells = {"quantity": number.name, "value>": f"{number.value:.5g}", "unit": number.unit, "from": number.source}
    cells["± (95 %)>"] = "" if half is None else f"{half:.2g}"
    cells["truth>"] = "" if truth is None else f"{truth:.5g}"
    cells["error>"] = f"{number.value / truth - 1.0:+z.3%}" if truth else ""
    return [cells[column] for column in columns]


def course_table(results: Sequence[TaskResult]) -> Table:
    """Every number with its unit, with its truth where that is known; of what was not done, what is missing."""
    rows: list[tuple[str, ...]] = []
    marked, columns = [], ("quantity", "value>", "truth>", "error>", "unit")
    for result in results:
        if result.reason is not None:
            marked.append(len(rows))
            rows.append((result.key, f"not done: {result.reason}", "", "", "", ""))
            continue
        for place, number in enumerate(result.numbers):
            rows.append(("" if place else result.key, *_cells(number, columns)))
    return table("Lab course", ("task", *columns), rows, marked)


def first_numbers(results: Sequence[TaskResult]) -> Table:
    """The same on one screen: the first numbers of each task, and whatever was not done."""
    shown = (one for one in results if one.key.isdigit() or one.reason is not None)
    return course_table([replace(one, numbers=one.numbers[:FIRST]) for one in shown])


def lab_json(results: Sequence[TaskResult], axis: str) -> str:
    """Every number of a named axis with unit, truth where it is known, and source; else what is missing."""
    content = {"schema": SCHEMA, "version": __version__, "axis": axis, "tasks": [_task(result) for result in results]}
    return json_text(content, ascii_only=False) + "\n"


def _task(result: TaskResult) -> dict[str, object]:
    named = {"key": result.key, "title": result.title}
    if result.reason is not None:
        return {**named, "status": "not_done", "reason": str(result.reason)}
    return {
        **named,
        "status": "done",
        "says": list(result.findings),
        "numbers": [{**vars(number), "value": known(number.value)} for number in (*result.numbers, *result.tabled)],
    }


def write_sources(folder: Path, recordings: LabRecordings, results: Sequence[TaskResult]) -> list[Path]:
    """Write the scripts of the tasks that were done, their recordings and values; `python taskNN.py` runs each.

    Returns the folder and the zip of its MATLAB sources, if anything was written.
    """
    done = {result.key: result for result in results if result.reason is None}
    scripts = [path for path in sorted(SCRIPTS.glob("task*.py")) if path.stem[4:].lstrip("0") in done]
    if not scripts:
        return []
    for name, run in recordings.readable.items():
        signals = np.column_stack([run.time, run.velocity, run.current])
        _write_table(folder / "recordings" / f"{name}.csv", "time [s],velocity [rad/s],current [A]", signals)
    if "1" in done:
        flights = enumerate(recordings.flights.points, 1)
        rows = np.concatenate([np.column_stack([np.full(len(flight), k), flight]) for k, flight in flights])
        _write_table(folder / "recordings" / "flights.csv", "flight,y [m],z [m]", rows)
    write_text(folder / "values.json", _values(recordings, done))
    for path in (*scripts, *SHARED):
        write_text(folder / path.name, path.read_text(encoding="utf-8"))
    for path in sorted(SCRIPTS.glob("matlab/*.m")):
        if MATLAB.get(path.stem, "3") in done:
            write_text(folder / "matlab" / path.name, path.read_text(encoding="utf-8"))
    return [folder, _write_matlab(folder)]


def _write_matlab(folder: Path) -> Path:
    """Write the MATLAB sources with recordings and values as one zip, which needs no other file."""
    path = folder / "matlab.zip"
    parts = [*(folder / "matlab").glob("*.m"), *(folder / "recordings").glob("*.csv"), folder / "values.json"]
    with whole(path) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
        for part in sorted(parts):
            archive.write(part, part.name if part.parent.name == "matlab" else part.relative_to(folder))
    return path


def _write_table(path: Path, header: str, rows: Array) -> None:
    lines = "\n".join(",".join(map(repr, row)) for row in rows.tolist())
    write_text(path, f"{header}\n{lines}\n")


def _values(recordings: LabRecordings, done: Mapping[str, TaskResult]) -> str:
    """Values that the scripts take, in SI, each with its source."""
    motor, load, sources = recordings.rig.motor, recordings.rig.load, recordings.sources
    found: dict[str, tuple[float | None, str]] = {
        name: (getattr(motor, name), sources("motor", name)) for name in (*DATASHEET, *OF_THE_WINDING)
    }
    for curve in motor.peak_curves[:1]:
        for name in ("corner_speed", "no_load_speed"):
            found[name] = getattr(curve, name), sources("motor", "peak_curves")
    geometry = f"geometry of the disk: {sources('load', 'outer_diameter')}"
    found["disk_inertia"] = load.disk_inertia if load else None, geometry
    if "9" in done:
        found |= {name: (done["9"][name].value * factor, "task 9") for name, factor in OF_TASK_9.items()}
    found |= {f"T_{name}": (run.sample_period, "recording") for name, run in recordings.readable.items()}
    given = {name: {"value": v, "source": source} for name, (v, source) in found.items() if v is not None}
    return json_text(given) + "\n"
