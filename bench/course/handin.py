"""What is handed in: a report's cover sheet, and beside it a readable script per task and what they read, in SI."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.arrays import Array
from bench.assets import asset
from bench.course.axis import KG_CM2
from bench.course.course import Results
from bench.course.recordings import FASTEST, WITH_FRICTION, WITHOUT_FRICTION, LabRecordings
from bench.course.result import DoneTask
from bench.errors import BenchError, InputError
from bench.files import write_text
from bench.rig.motor import DATASHEET
from bench.structured import read_toml

FILE = "group.toml"
#: Rows of a sheet that is filled in by hand.
BLANK_ROWS = 3
EXAMPLE = 'group = "7", and for each member [[student]] with name = "..." and number = "..."'
SCRIPTS = asset("data", "lab", "scripts")
#: Scripts that others import.
SHARED = ("course", "fast_samples")
#: Factors to SI of what task 11 takes from task 9, by the names there.
OF_TASK_9 = {"J": 1.0 / KG_CM2, "K_fric_w": 1.0, "K_fric_0": 1.0}


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
    def declaration(self) -> str:
        """What the signatures stand for."""
        return "We recorded and evaluated this ourselves; the sources lie beside this report."


def _is_student(entry: object) -> bool:
    return isinstance(entry, dict) and {"name", "number"} == set(entry)


def write_sources(folder: Path, recordings: LabRecordings, results: Results) -> list[Path]:
    """Write the scripts of the tasks that were done, their recordings and values; `python taskNN.py` runs each.

    Args:
        folder: to write to.
        recordings: that the report is about.
        results: of the course.

    Returns:
        The folder, if anything was written.
    """
    done = {result.key: result for result in results if isinstance(result, DoneTask)}
    scripts = [path for path in sorted(SCRIPTS.glob("task*.py")) if path.stem[4:].lstrip("0") in done]
    if not scripts:
        return []
    periods = {}
    for name in (WITHOUT_FRICTION, WITH_FRICTION, FASTEST):
        try:
            run = recordings.run(name)
        except BenchError:  # its tasks are not done, and say why
            continue
        periods[name] = run.sample_period
        signals = np.column_stack([run.time, run.velocity, run.current])
        _write_table(folder / "recordings" / f"{name}.csv", "time [s],velocity [rad/s],current [A]", signals)
    if "1" in done:
        flights = enumerate(recordings.flights.points, 1)
        rows = np.concatenate([np.column_stack([np.full(len(flight), k), flight]) for k, flight in flights])
        _write_table(folder / "recordings" / "flights.csv", "flight,y [m],z [m]", rows)
    write_text(folder / "values.json", _values(recordings, done, periods))
    for path in (*scripts, *(SCRIPTS / f"{name}.py" for name in SHARED)):
        write_text(folder / path.name, path.read_text(encoding="utf-8"))
    return [folder]


def _write_table(path: Path, header: str, rows: Array) -> None:
    lines = "\n".join(",".join(map(repr, row)) for row in rows.tolist())
    write_text(path, f"{header}\n{lines}\n")


def _values(recordings: LabRecordings, done: dict[str, DoneTask], periods: dict[str, float]) -> str:
    """Values that the scripts take, in SI, each with its source."""
    motor, sources = recordings.rig.motor, recordings.sources
    found: dict[str, tuple[float | None, str]] = {
        name: (getattr(motor, name), sources("motor", name))
        for name in (*DATASHEET, "rotor_inertia", "cold_resistance_share", "electrical_time_constant")
    }
    for curve in motor.peak_curves[:1]:
        for name in ("corner_speed", "no_load_speed"):
            found[name] = getattr(curve, name), sources("motor", "peak_curves")
    disk = recordings.rig.load.disk_inertia if recordings.rig.load else None
    found["disk_inertia"] = disk, f"geometry of the disk: {sources('load', 'outer_diameter')}"
    if "9" in done:
        found |= {name: (done["9"][name].value * factor, "task 9") for name, factor in OF_TASK_9.items()}
    found |= {f"T_{name}": (period, "recording") for name, period in periods.items()}
    known = {name: {"value": value, "source": source} for name, (value, source) in found.items() if value is not None}
    return json.dumps(known, indent=2) + "\n"
