"""The operating range: the recording with friction in the speed-torque diagram, and the reserve that it leaves."""

from __future__ import annotations

from bench.course.recordings import LabRecordings
from bench.course.result import DoneTask, Number
from bench.report.drive import in_range

KEY, TITLE = "range", "Operating range"


def task(recordings: LabRecordings) -> DoneTask:
    """The recording with friction."""
    run = recordings.with_friction
    found = in_range(recordings.rig, run.velocity, run.torque, "recording with friction")
    numbers = tuple(Number(name, value, unit) for name, (value, unit) in found.numbers.items())
    return DoneTask(KEY, found.chart.title, found.findings, numbers, (found.chart,))
