"""Task 7: the recording with friction: the same signals and plots as task 5."""

from __future__ import annotations

from bench.course import t05_run_without_friction as without_friction
from bench.course.result import Task
from bench.course.run import Run

KEY, TITLE = "7", "Recording with friction"


def task(run: Run) -> Task:
    """Draw the signals and say how far they reach."""
    return without_friction.task(run, KEY, TITLE)
