"""The whole course: every task that the recordings allow, and of the others what is missing."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

from bench.course import catapult, corner, friction, inertia, peak_torque, torque_constants
from bench.course.plausible import WITH_FRICTION, WITHOUT_FRICTION
from bench.course.recordings import LabRecordings
from bench.course.result import Equation, TaskResult
from bench.course.tracking import tracking
from bench.errors import BenchError


@dataclass(frozen=True)
class Task:
    """A task of the course.

    Attributes:
        key: its number, or a name for what surrounds the tasks.
        title: of it.
        do: does it; raises BenchError where something is missing.
        needs: recordings, or nothing but the rig.
    """

    key: str
    title: str
    do: Callable[[LabRecordings], TaskResult]
    needs: Literal["recordings", "rig"] = "recordings"

    def result(self, recordings: LabRecordings) -> TaskResult:
        """What it comes to, or why it cannot be done."""
        try:
            found = self.do(recordings)
        except BenchError as reason:
            found = TaskResult(reason=reason)
        return replace(found, key=self.key, title=found.title or self.title, equation=EQUATIONS.get(self.key))


#: Tasks in their order, and what surrounds them.
TASKS = (
    Task("1", "Catapult", catapult.path),
    Task("2", "Backward difference", inertia.backward_difference_of_a_sine, "rig"),
    Task("3", "Torque constant from the datasheet", torque_constants.at_both_points, "rig"),
    Task("4", "Torque constant over current", torque_constants.over_current, "rig"),
    Task(
        "5",
        "Recording without friction",
        partial(inertia.signals, WITHOUT_FRICTION, "Task 5: recording without friction"),
    ),
    Task("6", "Moment of inertia without friction", inertia.inertia_without_friction),
    Task("7", "Recording with friction", partial(inertia.signals, WITH_FRICTION, "Task 7: recording with friction")),
    Task("8", "Filtered acceleration, slow samples removed", friction.samples_that_remain),
    Task("9", "Moment of inertia and friction by least squares", friction.inertia_and_friction),
    Task("10", "Peak torque over speed", peak_torque.over_speed),
    Task("11", "Why the measured corner lies higher", corner.why_the_corner_lies_higher, "rig"),
    Task("range", "Operating range", peak_torque.operating_range),
    Task("tracking", "Tracking with three load inertias in the feed-forward", tracking),
)
#: Equations that they solve; those that the course's text numbers have its number.
EQUATIONS = {
    "1": Equation("z = a·y² + b·y + c", "z = a y^2 + b y + c"),
    "2": Equation("u'[k] = (u[k] - u[k-1])/T", "dot(u)_k = (u_k - u_(k-1)) / T", "(16)"),
    "3": Equation("kT = M/I", "k_T = M / I"),
    "4": Equation("kT(Iq) = a·Iq² + b·Iq + c", "k_T (I_q) = a I_q^2 + b I_q + c"),
    "5": Equation("M = kT(Iq)·Iq", "M = k_T (I_q) I_q"),
    "6": Equation("M = J·α, J = J_motor + J_load", 'M = J alpha, quad J = J_"motor" + J_"load"'),
    "8": Equation(
        "α_filt[k - 2] = (ω[k] - ω[k - 4])/(4·T)",
        'alpha_("filt", k-2) = 1/4 sum_(i=0)^3 alpha_(k-i) = (omega_k - omega_(k-4)) / (4 T)',
    ),
    "9": Equation(
        "M = J·α + K_fric_w·ω + K_fric_0·sgn(ω)",
        'M = J alpha + K_("fric,"omega) omega + K_("fric,"0) op("sgn") omega',
        "(28)",
    ),
    "11": Equation("U = R(T)·Iq + L·dIq/dt + Ke·ω", "U = R(T) I_q + L (dif I_q) / (dif t) + K_e omega"),
}


def course(
    recordings: LabRecordings,
    progress: Callable[[float], None] = lambda share: None,
    keys: Collection[str] | None = None,
) -> list[TaskResult]:
    """Do every task in order, or those of `keys` alone; `progress` is called with the share done."""
    asked = [task for task in TASKS if keys is None or task.key in keys]
    results = []
    for number, task in enumerate(asked, 1):
        results.append(task.result(recordings))
        progress(number / len(asked))
    return results
