"""The whole course: every task that the recordings allow, and of the others what is missing."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import cached_property
from types import ModuleType

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
from bench.course.flights import find_flights, read_flights
from bench.course.recordings import FASTEST, WITH_FRICTION, WITHOUT_FRICTION, Recordings, read_truth
from bench.course.result import NotDone, Number, Task
from bench.course.rig import rotor_inertia
from bench.course.run import Run
from bench.course.t06_inertia import KG_CM2
from bench.errors import BenchError
from bench.plant.model import AxisParameters

#: Tasks that are done on recordings, and not on the rig file or the embedded example alone.
RECORDED = {
    task.KEY
    for task in (
        t01_catapult,
        t05_run_without_friction,
        t06_inertia,
        t07_run_with_friction,
        t08_fast_samples,
        t09_least_squares,
        t10_peak_torque,
        operating_range,
        tracking,
    )
}

Progress = Callable[[float], None]


def course(
    recordings: Recordings, progress: Progress = lambda share: None, keys: Collection[str] | None = None
) -> list[Task | NotDone]:
    """Do every task in order.

    Args:
        recordings: a student's, or the synthetic ones.
        progress: called with the share done.
        keys: of the tasks to do; all without.
    """
    done: list[Task | NotDone] = []
    steps = [step for step in _Course(recordings).steps() if keys is None or step[0] in keys]
    for k, (key, title, step) in enumerate(steps):
        try:
            done.append(step())
        except BenchError as reason:
            done.append(NotDone(key, title, reason))
        progress((k + 1) / len(steps))
    return done


class _Course:
    """Recordings read once, and what later tasks take from earlier ones."""

    def __init__(self, recordings: Recordings) -> None:
        self.recordings, self.rig, self.sources = recordings, recordings.rig, recordings.sources

    def steps(self) -> list[tuple[str, str, Callable[[], Task]]]:
        """Number, title and work of every task."""
        rig, sources, example = self.rig, self.sources, self.recordings.example
        work: list[tuple[ModuleType, Callable[[], Task]]] = [
            (t01_catapult, self._catapult),
            (t02_difference, t02_difference.task),
            (t03_torque_constants, lambda: t03_torque_constants.task(rig, sources)),
            (t04_torque_constant_curve, lambda: t04_torque_constant_curve.task(rig, sources)),
            (t05_run_without_friction, lambda: t05_run_without_friction.task(self.without_friction)),
            (t06_inertia, lambda: self.inertia),
            (t07_run_with_friction, lambda: t07_run_with_friction.task(self.with_friction)),
            (t08_fast_samples, lambda: t08_fast_samples.task(self.with_friction)),
            (t09_least_squares, lambda: self.least_squares),
            (t10_peak_torque, lambda: self.peak_torque),
            (t11_corner, self._corner),
            (estimators, lambda: estimators.task(example)),
            (operating_range, self._operating_range),
            (tracking, self._tracking),
            (equation_of_motion, lambda: equation_of_motion.task(example)),
            (emulated_friction, lambda: emulated_friction.task(example)),
        ]
        return [(module.KEY, module.TITLE, step) for module, step in work]

    @cached_property
    def without_friction(self) -> Run:
        return self.recordings.run(WITHOUT_FRICTION)

    @cached_property
    def with_friction(self) -> Run:
        return self.recordings.run(WITH_FRICTION)

    @cached_property
    def inertia(self) -> Task:
        return t06_inertia.task(self.without_friction, self.rig, self.sources)

    @cached_property
    def fastest(self) -> Run:
        return self.recordings.run(FASTEST)

    @cached_property
    def peak_torque(self) -> Task:
        return t10_peak_torque.task(self.fastest, self.rig, self.sources)

    def _catapult(self) -> Task:
        path = find_flights(self.recordings.folder)
        return t01_catapult.task(read_flights(path), read_truth(path / "truth.json"))

    @cached_property
    def least_squares(self) -> Task:
        before = _number(lambda: self.inertia, "J_load")
        return t09_least_squares.task(self.with_friction, self.rig, self.sources, before)

    def _corner(self) -> Task:
        try:
            measured = t10_peak_torque.fall(self.fastest, self.rig)
        except BenchError:  # task 10 says why
            measured = None
        synthetic = measured is not None and bool(self.fastest.truth)
        return t11_corner.task(self.rig, self.sources, self._axis(), measured=measured, synthetic=synthetic)

    def _axis(self) -> AxisParameters:
        """The axis as task 9 finds it; the embedded example's where there is no such recording."""
        try:
            found = t09_least_squares.identify_friction(self.with_friction)
        except BenchError:
            return AxisParameters.from_rig(self.recordings.example)
        return AxisParameters(found.inertia, max(found.viscous, 0.0), max(found.coulomb, 0.0))

    def _operating_range(self) -> Task:
        run = self.with_friction
        return operating_range.task(self.rig, run.velocity, run.torque, "recording with friction")

    def _tracking(self) -> Task:
        identified = self.least_squares["J"].value / KG_CM2 - rotor_inertia(self.rig)
        truth = self.with_friction.truth
        axis = AxisParameters.from_rig(self.recordings.example) if truth else self._axis()
        return tracking.task(self.rig, self.sources, axis, identified, known=bool(truth))


def _number(task: Callable[[], Task], name: str) -> Number | None:
    """A number of an earlier task; None where that could not be done, which its own place in the course says."""
    try:
        return next((number for number in task().numbers if number.name == name), None)
    except BenchError:
        return None
