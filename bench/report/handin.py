"""Sources to hand in with a report: a readable script per task, and what they read, in SI."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from bench.arrays import Array
from bench.assets import asset
from bench.course.flights import find_flights, read_flights
from bench.course.recordings import FASTEST, WITH_FRICTION, WITHOUT_FRICTION, Recordings
from bench.course.result import Task
from bench.course.run import Run
from bench.course.t06_inertia import KG_CM2
from bench.errors import BenchError
from bench.files import write_text
from bench.report.lab import Results
from bench.rig.motor import DATASHEET

SCRIPTS = asset("data", "lab", "scripts")
#: Scripts that others import.
SHARED = ("course", "fast_samples")
#: Factors to SI of what task 11 takes from task 9, by the names there.
OF_TASK_9 = {"J": 1.0 / KG_CM2, "K_fric_w": 1.0, "K_fric_0": 1.0}


def write_sources(folder: Path, recordings: Recordings, results: Results) -> list[Path]:
    """Write the scripts of the tasks that were done, their recordings and values; `python taskNN.py` runs each.

    Args:
        folder: to write to.
        recordings: that the report is about.
        results: of the course.

    Returns:
        The folder, if anything was written.
    """
    done = {result.key: result for result in results if isinstance(result, Task)}
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
        _write_table(folder / "recordings" / f"{name}.csv", "time [s],velocity [rad/s],current [A]", _columns(run))
    if "1" in done:
        flights = read_flights(find_flights(recordings.folder)).points
        rows = np.concatenate([np.column_stack([np.full(len(f), k), f]) for k, f in enumerate(flights, 1)])
        _write_table(folder / "recordings" / "flights.csv", "flight,y [m],z [m]", rows)
    write_text(folder / "values.json", _values(recordings, done, periods))
    for path in (*scripts, *(SCRIPTS / f"{name}.py" for name in SHARED)):
        write_text(folder / path.name, path.read_text(encoding="utf-8"))
    return [folder]


def _columns(run: Run) -> Array:
    return np.column_stack([run.time, run.velocity, run.current])


def _write_table(path: Path, header: str, rows: Array) -> None:
    lines = "\n".join(",".join(map(repr, row)) for row in rows.tolist())
    write_text(path, f"{header}\n{lines}\n")


def _values(recordings: Recordings, done: dict[str, Task], periods: dict[str, float]) -> str:
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
