"""What a student hands in: the filled form as CSV, or the same as JSON."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.course.answers import ASKED
from bench.course.text import text_of
from bench.errors import InputError
from bench.names import nearest
from bench.structured import parse_json
from bench.units.text import spelled_for_pint

ENDINGS = (".csv", ".json")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_ADVICE = "allowed: a number, and its unit in a column of its own"
#: Powers and products as people write them.
_SIGNS = str.maketrans({"²": "**2", "³": "**3", "·": "*", "^": "**", "Ω": "ohm"})


@dataclass(frozen=True)
class Answer:
    """A value and its unit, empty where the form's own was left."""

    value: float
    unit: str


@dataclass(frozen=True)
class Submission:
    """Answers of a student by the names of the form; what was left blank is not among them."""

    student: str
    answers: dict[str, Answer]
    source: str


def find_submissions(folder: Path) -> list[Path]:
    """Filled forms in a folder and its subfolders, in the order of their names.

    Raises:
        InputError: no such folder, or none in it.
    """
    if not folder.is_dir():
        raise InputError(folder, "no such folder", "give the folder of the submissions")
    found = [path for path in sorted(folder.rglob("*")) if path.suffix.lower() in ENDINGS and _is_form(path)]
    if not found:
        raise InputError(folder, "found no filled form", "allowed: answers.csv of each student, or the same as JSON")
    return found


def read_submission(path: Path) -> Submission:
    """A filled form.

    Raises:
        InputError: a row that cannot be read, a quantity that is not asked for or given twice, or no student.
    """
    text = text_of(path.read_bytes())
    rows = _json_rows(text, path) if path.suffix.lower() == ".json" else _csv_rows(text, path)
    known = {asked.name.lower(): asked.name for asked in ASKED}
    student, answers = "", {}
    for where, name, value, unit in rows:
        if name.lower() == "student":
            student = value.strip()
            continue
        if name.lower() not in known:
            names = [asked.name for asked in ASKED]
            raise InputError(where, f"'{name}' is not asked for{nearest(name, names)}", f"allowed: {', '.join(names)}")
        if not value.strip():
            continue
        if known[name.lower()] in answers:
            raise InputError(where, f"'{name}' stands there twice", "give it once")
        answers[known[name.lower()]] = Answer(_number(value, where), _unit(unit))
    if not student:
        raise InputError(f"{path}: student", "missing", "allowed: the row student,NUMBER as the form has it")
    return Submission(student.zfill(2) if student.isdigit() else student, answers, str(path))


def _is_form(path: Path) -> bool:
    return bool(re.match(r'\W*"?(quantity|student|schema)', text_of(path.read_bytes())[:200], re.IGNORECASE))


def _csv_rows(text: str, path: Path) -> list[tuple[str, str, str, str]]:
    separator = ";" if text.split("\n", 1)[0].count(";") > 0 else ","
    rows = []
    for number, line in enumerate(text.splitlines(), 1):
        cells = [cell.strip().strip('"').strip() for cell in line.split(separator)]
        if not any(cells) or cells[0].lower() == "quantity" or cells[0].startswith("#"):
            continue
        where = f"{path}: line {number}"
        if len(cells) > 3 and any(cells[3:]):
            raise InputError(
                where, f"found {len(cells)} cells", "allowed: quantity,value,unit; a decimal comma takes ; between"
            )
        value = cells[1].replace(",", ".") if separator == ";" and len(cells) > 1 else (cells[1:] or [""])[0]
        rows.append((where, cells[0], value, cells[2] if len(cells) > 2 else ""))
    return rows


def _json_rows(text: str, path: Path) -> list[tuple[str, str, str, str]]:
    try:
        content = parse_json(text, path)
        answers: dict[str, Any] = content["answers"]
        rows = [(f"{path}: student", "student", str(content["student"]), "")]
        for name, entry in answers.items():
            value = "" if entry["value"] is None else str(entry["value"])
            rows.append((f"{path}: {name}", name, value, str(entry.get("unit", ""))))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        form = '{"student": "07", "answers": {"J": {"value": 22.4, "unit": "kg*cm**2"}, ...}}'
        raise InputError(path, f"is no filled form ({error!r})", f"allowed: {form}") from error
    return rows


def _number(text: str, where: str) -> float:
    plain = text.strip().replace("−", "-")
    if not _NUMBER.fullmatch(plain):
        raise InputError(where, f"found the value '{text}'", _ADVICE)
    return float(plain)


def _unit(text: str) -> str:
    plain = text.strip().strip("[]")
    if plain in ("1", "-", "dimensionless"):
        return "dimensionless"
    return spelled_for_pint(plain).translate(_SIGNS)
