"""Task 11: why the measured corner lies at higher speed than the datasheet's, by simulating the motor's winding.

One cause after the other, in the course's circuit.
"""

from __future__ import annotations

from dataclasses import dataclass

from bench.course.axis import MAINS, RPM, circuit, joined
from bench.course.peak_torque import datasheet_curve, fall
from bench.course.recordings import LabRecordings
from bench.course.result import SIMULATED, Number, TaskResult, chart, curve, panel
from bench.course.winding import WindingModel, WindingRun, full_speed, identified_axis, run_winding
from bench.errors import BenchError
from bench.plant.axis_model import AxisParameters
from bench.report.document import Chart
from bench.rig.limits import COLD, HOT
from bench.rig.rig import Rig

#: One of so many steps of a run is drawn.
EVERY = 40


@dataclass(frozen=True)
class Split:
    """The run-up by one cause after the other.

    Attributes:
        hot, cold: winding at 120 degC and at 20 degC, quasi-static.
        inductive: at 20 degC with the assumed inductance.
    """

    hot: WindingRun
    cold: WindingRun
    inductive: WindingRun

    @classmethod
    def of(cls, rig: Rig, axis: AxisParameters) -> Split:
        """Of a rig's motor that runs up an axis."""
        own, demand = circuit(rig), full_speed(rig, axis)
        ways = (HOT, False), (COLD, False), (COLD, True)
        return cls(*(run_winding(WindingModel.of(rig, *way, own), axis, demand) for way in ways))


def why_the_corner_lies_higher(recordings: LabRecordings) -> TaskResult:
    """State how many rpm of the corner's shift are due to each of the two causes."""
    rig = recordings.rig
    found = Split.of(rig, identified_axis(recordings))
    assumed = recordings.sources("motor", "electrical_time_constant")
    corners = {
        "corner, hot, quasi-static": (found.hot.corner, SIMULATED),
        "corner, cold, quasi-static": (found.cold.corner, SIMULATED),
        "corner, cold, with inductance": (found.inductive.corner, joined(SIMULATED, f"L/R: {assumed}")),
    }
    numbers = tuple(Number(name, speed * RPM, "rpm", source=source) for name, (speed, source) in corners.items())
    hot, cold, inductive = (number.value for number in numbers)
    findings = (
        f"The winding is cold: with its lower resistance the voltage drives peak current up to {cold:.0f} rpm at "
        f"{COLD:g} °C instead of {hot:.0f} rpm at {HOT:g} °C, {cold - hot:+.0f} rpm. The inductance shifts the corner "
        f"by {inductive - cold:+.1f} rpm, as the current is still constant there; it only delays the fall beyond it."
        f"{_measured(recordings, inductive)}",
    )
    return TaskResult(findings, numbers, (_torque_chart(rig, found),))


def _measured(recordings: LabRecordings, simulated: float) -> str:
    """The corner of task 10 next to a simulated one - rpm; nothing where that could not be done."""
    try:
        corner = fall(recordings.fastest, recordings.rig).corner * RPM
    except BenchError:
        return ""
    made = " (this recording was made by the same equations)" if recordings.fastest.truth else ""
    return f" Measured in task 10: {corner:.0f} rpm, {corner - simulated:+.0f} rpm from the simulation{made}."


def _torque_chart(rig: Rig, found: Split) -> Chart:
    speed, torque = datasheet_curve(rig)
    every = slice(None, None, EVERY)
    simulated = {
        f"{HOT:g} °C, quasi-static": found.hot,
        f"{COLD:g} °C, quasi-static": found.cold,
        f"{COLD:g} °C, with inductance": found.inductive,
    }
    curves = (curve(run.velocity[every] * RPM, run.torque[every], name) for name, run in simulated.items())
    datasheet = curve(speed * RPM, torque, f"datasheet, {MAINS:g} V", "dashes")
    return chart("Task 11: simulated peak torque", panel("speed n / rpm", "torque M / (N·m)", datasheet, *curves))
