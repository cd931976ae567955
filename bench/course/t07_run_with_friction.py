"""Task 7: the recording with friction: the same signals and plots as task 5."""

from __future__ import annotations

from bench.course.recordings import LabRecordings
from bench.course.result import DoneTask
from bench.course.t05_run_without_friction import signals_of

KEY, TITLE = "7", "Recording with friction"


def task(recordings: LabRecordings) -> DoneTask:
    """Draw the signals and say how far they reach."""
    return signals_of(recordings.with_friction, KEY, TITLE)
