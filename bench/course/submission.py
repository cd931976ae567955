"""What a student hands in: the form to be filled in, as CSV, or the same as JSON."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.errors import InputError
from bench.files import read_bytes
from bench.names import nearest
from bench.structured import parse_json
from bench.trace.readers.table import cells_of
from bench.trace.source import source_of
from bench.units import convert
from bench.units.conversion import scale_of
from bench.units.grammar import UnitError

#: Name of the form, and endings of filled ones.
FORM, ENDINGS = "answers.csv", (".csv", ".json")
#: How a form begins; the table of grades that an earlier run wrote begins with student,task.
_FORM = re.compile(r'\W*"?(quantity|student(?!\W*task)|schema)', re.IGNORECASE)
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
#: A student is called by the number alone, or as the own folder is.
_NAMED = re.compile(r"^student[ _-]*(?=\w)", re.IGNORECASE)
#: The place of a row, and its quantity, value and unit as they were written.
Entry = tuple[str, str, str, str]


@dataclass(frozen=True)
class Question:
    """A quantity that a student hands in.

    Attributes:
        task: number in the course.
        name: of the quantity in the form.
        unit: as pint reads it; of the form, answers in another one are converted.
        tolerance: share by which a right answer may be off at least: rounding, and other ways to read a drawing. What
            its change by noise and other filters on a student's own recordings may be more. None where they make any
            value; it then only helps to recognise a mistake.
        near_zero: what replaces the value in that share where it is zero.
    """

    task: str
    name: str
    unit: str
    tolerance: float | None
    near_zero: float = 0.0


QUESTIONS = (
    Question("1", "catapult_a", "1/m", 0.02),
    Question("1", "catapult_b", "dimensionless", 0.02),
    Question("1", "catapult_c", "m", 0.02),
    Question("1", "catapult_E", "m**2", 0.05),
    Question("3", "kT_stall", "N*m/A", 0.005),
    Question("3", "kT_peak", "N*m/A", 0.005),
    Question("4", "kT_a", "N*m/A**3", 0.01),
    Question("4", "kT_b", "N*m/A**2", 0.01, near_zero=0.1),
    Question("4", "kT_c", "N*m/A", 0.005),
    Question("6", "alpha_max", "rad/s**2", 0.2),
    Question("6", "J_without_friction", "kg*cm**2", 0.005),
    Question("6", "J_load_without_friction", "kg*cm**2", 0.005),
    Question("9", "J", "kg*cm**2", 0.005),
    Question("9", "K_fric_w", "N*m*s/rad", 0.02),
    Question("9", "K_fric_0", "N*m", 0.02),
    Question("9", "E", "(N*m)**2", None),
    Question("9", "J_load", "kg*cm**2", 0.005),
    Question("10", "M_max", "N*m", 0.03),
    Question("10", "corner", "rpm", 0.05),
)


#: What is handed in on paper and marked by hand, by task, and what to look for.
BY_HAND = {
    "2": "derivative of sin(t) over cos(t), and why they differ by half a sample",
    "5": "four graphs of the recording without friction on one time axis, with units",
    "7": "four graphs of the recording with friction on one time axis, with units",
    "8": "remaining samples over the original ones, alpha_filt in step with alpha",
    "11": "why the corner is higher than the datasheet's: the temperature of the winding, not its inductance",
}


@dataclass(frozen=True)
class GivenAnswer:
    """A value and its unit, empty where the form's own is unchanged."""

    value: float
    unit: str


#: SI units of what the form asks for in another unit.
_SI = {"kg*cm**2": "kg*m**2", "rpm": "rad/s"}


def readings(given: GivenAnswer, question: Question) -> list[float]:
    """The value in the unit that is asked for, by the unit reader of recordings; 1/min counts revolutions.

    A speed in 1/s or Hz has two readings, revolutions and radians. Raises ValueError where the unit measures something
    else, or is none.
    """
    unit = given.unit or question.unit
    si = _SI.get(question.unit, question.unit)
    to_si = float(convert(np.ones(1), question.unit, si)[0])
    try:
        scale = scale_of(unit, (si,))
    except UnitError as error:
        if "may mean" not in error.found:
            raise ValueError(error.found) from error
        # the radian counts as 1, so N*m*s and 1/s**2 are right for what is wanted per radian; of a speed both are read
        radians = given.value * float(convert(np.ones(1), unit, si)[0]) / to_si
        return [2.0 * math.pi * radians, radians] if question.unit == "rpm" else [radians]
    return [given.value * scale.factor / to_si]


@dataclass(frozen=True)
class Submission:
    """Answers of a student by the names of the form; what is blank is not among them."""

    student: str
    answers: dict[str, GivenAnswer]
    source: str


def form(student: str) -> str:
    """The form that a student fills in."""
    rows = "".join(f"{question.name},,{question.unit}\n" for question in QUESTIONS)
    sheets = "".join(f"# on paper, task {task}: {what}\n" for task, what in BY_HAND.items())
    return f"quantity,value,unit\nstudent,{student},\n{rows}{sheets}"


def find_submissions(folder: Path) -> list[Path]:
    """Filled forms in a folder and those below, in the order of their names; InputError without any."""
    if not folder.is_dir():
        raise InputError(folder, "no such folder", "give the folder of the submissions")
    found = [path for path in sorted(folder.rglob("*")) if path.suffix.lower() in ENDINGS and _is_form(path)]
    if not found:
        raise InputError(folder, "found no filled form", "allowed: answers.csv of each student, or the same as JSON")
    return found


def _is_form(path: Path) -> bool:
    """Whether it looks like one; what cannot be read is reported as a form that cannot."""
    try:
        content = read_bytes(path, "a filled form", replaced=True)
        return bool(content.strip() and _FORM.match(source_of(path, content).text()[:200]))
    except InputError:
        return True


def read_submission(path: Path) -> Submission:
    """A filled form.

    Raises InputError where a row cannot be read, a quantity is not in the form or given twice, or there is no student.
    """
    text = source_of(path, read_bytes(path, "a filled form")).text()
    entries = _of_json(text, path) if path.suffix.lower() == ".json" else _of_csv(text, path)
    names = {question.name.lower(): question.name for question in QUESTIONS}
    student, answers = "", {}
    for where, written, value, unit in entries:
        if written.lower() == "student":
            student = _NAMED.sub("", value.strip())
            continue
        if written.lower() not in names:
            allowed = [*names.values()]
            found = f"'{written}' is not in the form{nearest(written, allowed)}"
            raise InputError(where, found, f"allowed: {', '.join(allowed)}")
        name = names[written.lower()]
        if value.strip() and name in answers:
            raise InputError(where, f"found '{written}' twice", "give it once")
        if value.strip():
            plain = value.strip().replace("−", "-").replace(",", ".")
            if not _NUMBER.fullmatch(plain):
                allowed = "allowed: a number, and its unit in a column of its own"
                raise InputError(where, f"found the value '{value}'", allowed)
            if not math.isfinite(float(plain)):
                raise InputError(where, f"found the value '{value}', which no quantity reaches", "allowed: a number")
            answers[name] = GivenAnswer(float(plain), "1" if unit == "-" else unit.strip("[] "))
    if not student:
        raise InputError(f"{path}: student", "missing", "allowed: the row student,NUMBER as the form has it")
    return Submission(student.zfill(2) if student.isdigit() else student, answers, str(path))


def _of_csv(text: str, path: Path) -> list[Entry]:
    """Rows of the form, whose cells commas or semicolons separate."""
    separator = ";" if ";" in text.split("\n", 1)[0] else ","
    entries = []
    for number, line in enumerate(text.splitlines(), 1):
        cells = cells_of(line, separator)
        if not any(cells) or cells[0].lower() == "quantity" or cells[0].startswith("#"):
            continue
        where = f"{path}: line {number}"
        if any(cells[3:]):
            allowed = "allowed: quantity,value,unit; a decimal comma takes ; between"
            raise InputError(where, f"found {len(cells)} cells", allowed)
        name, value, unit = [*cells, "", ""][:3]
        entries.append((where, name, value, unit))
    return entries


def _given_once(text: str, path: Path) -> None:
    """InputError where an object of a JSON text has a key twice, of which JSON's reader keeps the last one."""

    def once(pairs: list[tuple[str, object]]) -> dict[str, object]:
        names = [name for name, _ in pairs]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise InputError(path, f"found '{twice}' twice", "give it once")
        return dict(pairs)

    json.loads(text, object_pairs_hook=once)


def _of_json(text: str, path: Path) -> list[Entry]:
    try:
        content = parse_json(text, path)
        _given_once(text, path)
        entries = [(f"{path}: student", "student", str(content["student"]), "")]
        for name, entry in content["answers"].items():
            value = "" if entry["value"] is None else str(entry["value"])
            entries.append((f"{path}: {name}", name, value, str(entry.get("unit", ""))))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        allowed = 'allowed: {"student": "07", "answers": {"J": {"value": 22.4, "unit": "kg*cm**2"}, ...}}'
        raise InputError(path, f"is no filled form ({error!r})", allowed) from error
    return entries
