"""The whole course: every task that the recordings allow, and of the others what is missing."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

from bench.course import catapult, corner, examples, friction, inertia, peak_torque, torque_constants
from bench.course.recordings import LabRecordings
from bench.course.result import EXAMPLE, TaskResult
from bench.course.tracking import tracking
from bench.errors import BenchError


@dataclass(frozen=True)
class Task:
    """A task of the course.

    Attributes:
        key: its number, or a name for what stands around the tasks.
        title: of it.
        do: does it; raises BenchError where something is missing.
        recorded: whether it needs a recording.
        example: whether it is about the embedded example, whatever was recorded.
        equation: that it solves.
    """

    key: str
    title: str
    do: Callable[[LabRecordings], TaskResult]
    recorded: bool = True
    example: bool = False
    equation: str = ""

    def result(self, recordings: LabRecordings) -> TaskResult:
        """What it comes to, or why it cannot be done."""
        try:
            found = self.do(recordings)
        except BenchError as reason:
            found = TaskResult(reason=reason)
        if self.example:
            found = replace(found, numbers=tuple(replace(number, source=EXAMPLE) for number in found.numbers))
        return replace(
            found, key=self.key, title=found.title or self.title, example=self.example, equation=self.equation
        )


#: Tasks in their order, and what stands around them.
TASKS = (
    Task("1", "Catapult", catapult.path, equation="z = a·y² + b·y + c"),
    Task(
        "2",
        "Backward difference",
        inertia.backward_difference_of_a_sine,
        recorded=False,
        equation="u'[k] = (u[k] - u[k-1])/T",
    ),
    Task(
        "3", "Torque constant from the datasheet", torque_constants.at_both_points, recorded=False, equation="kT = M/I"
    ),
    Task(
        "4",
        "Torque constant over current",
        torque_constants.over_current,
        recorded=False,
        equation="kT(Iq) = a·Iq² + b·Iq + c",
    ),
    Task("5", "Recording without friction", inertia.signals_without_friction, equation="M = kT(Iq)·Iq"),
    Task(
        "6",
        "Moment of inertia without friction",
        inertia.inertia_without_friction,
        equation="M = J·α, J = J_motor + J_load",
    ),
    Task("7", "Recording with friction", inertia.signals_with_friction),
    Task(
        "8",
        "Filtered acceleration, slow samples removed",
        friction.samples_that_remain,
        equation="α_filt[k - 2] = (ω[k] - ω[k - 4])/(4·T)",
    ),
    Task(
        "9",
        "Moment of inertia and friction by least squares",
        friction.inertia_and_friction,
        equation="M = J·α + K_fric_w·ω + K_fric_0·sgn(ω)",
    ),
    Task("10", "Peak torque over speed", peak_torque.over_speed),
    Task(
        "11",
        "Why the measured corner lies higher",
        corner.why_the_corner_lies_higher,
        recorded=False,
        equation="U = R(T)·Iq + L·dIq/dt + Ke·ω",
    ),
    Task("estimators", "The course's estimators and the bench's", examples.estimators, recorded=False, example=True),
    Task("range", "Operating range", peak_torque.operating_range),
    Task("tracking", "Tracking with three load inertias in the feed-forward", tracking),
    Task(
        "equation",
        "Load torque and gearbox",
        examples.equation_of_motion,
        recorded=False,
        example=True,
        equation="M = (J_motor + J_load/i²)·α + K_fric_w·ω + K_fric_0·sgn(ω) + M_load/i",
    ),
    Task(
        "emulation",
        "Friction in the drive's software and in the mechanics",
        examples.emulated_friction,
        recorded=False,
        example=True,
    ),
)


def course(
    recordings: LabRecordings,
    progress: Callable[[float], None] = lambda share: None,
    keys: Collection[str] | None = None,
) -> list[TaskResult]:
    """Do every task in order.

    Args:
        recordings: a student's, or the synthetic ones.
        progress: called with the share done.
        keys: of the tasks to do; all without.
    """
    asked = [task for task in TASKS if keys is None or task.key in keys]
    results = []
    for number, task in enumerate(asked, 1):
        results.append(task.result(recordings))
        progress(number / len(asked))
    return results
