"""Cover sheet of a report: the group, its members with their student numbers, and room for their signatures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bench.errors import InputError
from bench.structured import read_toml

FILE = "group.toml"
#: Rows of a sheet that is filled in by hand.
BLANK_ROWS = 3
EXAMPLE = 'group = "7", and for each member [[student]] with name = "..." and number = "..."'


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
        """From `group.toml` in a folder; blank without one.

        Raises:
            InputError: a file that does not say it as it should.
        """
        path = folder / FILE if folder is not None else None
        if path is None or not path.exists():
            return cls()
        content = read_toml(path, f"a cover sheet, {EXAMPLE},")
        students = content.get("student", [])
        unknown = sorted(set(content) - {"group", "student"})
        if unknown or not isinstance(students, list) or not all(_is_student(entry) for entry in students):
            raise InputError(
                path, f"found {', '.join(unknown) or 'a student without name or number'}", f"allowed: {EXAMPLE}"
            )
        return cls(str(content.get("group", "")), tuple((str(s["name"]), str(s["number"])) for s in students))

    @property
    def rows(self) -> tuple[tuple[str, str], ...]:
        """Name and number of each, blank ones to be filled in where none are given."""
        return self.students or (("", ""),) * BLANK_ROWS

    @property
    def group_line(self) -> str:
        """The group in one line."""
        return f"Group: {self.group or '_' * 12}"

    @property
    def lines(self) -> tuple[str, ...]:
        """A line for each member, with room for the signature."""
        return tuple(
            f"Name: {name or '_' * 26:<28}Student number: {number or '_' * 12:<14}Signature: {'_' * 24}"
            for name, number in self.rows
        )

    @property
    def declaration(self) -> str:
        """What the signatures stand for."""
        return "We recorded and evaluated this ourselves; the sources lie beside this report."


def _is_student(entry: object) -> bool:
    return isinstance(entry, dict) and {"name", "number"} == set(entry)
