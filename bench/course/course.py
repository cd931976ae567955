"""The whole course: every task that the recordings allow, and of the others what is missing."""

from __future__ import annotations

from collections.abc import Callable, Collection

from bench.course import (
    emulated_friction,
    equation_of_motion,
    estimators,
    operating_range,
    t01_catapult,
    t02_difference,
    t03_torque_constants,
    t04_torque_constant_curve,
    t05_run_without_friction,
    t06_inertia,
    t07_run_with_friction,
    t08_fast_samples,
    t09_least_squares,
    t10_peak_torque,
    t11_corner,
    tracking,
)
from bench.course.recordings import LabRecordings
from bench.course.result import DoneTask, NotDone
from bench.errors import BenchError

#: Tasks in their order, and what stands around them.
TASKS = (
    t01_catapult,
    t02_difference,
    t03_torque_constants,
    t04_torque_constant_curve,
    t05_run_without_friction,
    t06_inertia,
    t07_run_with_friction,
    t08_fast_samples,
    t09_least_squares,
    t10_peak_torque,
    t11_corner,
    estimators,
    operating_range,
    tracking,
    equation_of_motion,
    emulated_friction,
)
#: Those that are done on the rig file or the embedded example alone.
WITHOUT_RECORDING = (
    t02_difference,
    t03_torque_constants,
    t04_torque_constant_curve,
    t11_corner,
    estimators,
    equation_of_motion,
    emulated_friction,
)
#: Keys of tasks that are done on recordings.
RECORDED = {task.KEY for task in TASKS if task not in WITHOUT_RECORDING}

Results = list[DoneTask | NotDone]


def course(
    recordings: LabRecordings,
    progress: Callable[[float], None] = lambda share: None,
    keys: Collection[str] | None = None,
) -> Results:
    """Do every task in order.

    Args:
        recordings: a student's, or the synthetic ones.
        progress: called with the share done.
        keys: of the tasks to do; all without.
    """
    asked = [task for task in TASKS if keys is None or task.KEY in keys]
    done: Results = []
    for number, task in enumerate(asked, 1):
        try:
            done.append(task.task(recordings))
        except BenchError as reason:
            done.append(NotDone(task.KEY, task.TITLE, reason))
        progress(number / len(asked))
    return done
