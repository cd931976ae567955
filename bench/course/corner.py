"""Task 11: why the measured corner lies at higher speed than the datasheet's, by simulating the motor's winding.

One cause after the other, in the course's circuit.
"""

from __future__ import annotations

from collections.abc import Mapping

from bench.course.axis import MAINS, joined
from bench.course.methods import RPM
from bench.course.peak_torque import datasheet_curve, run_up
from bench.course.recordings import LabRecordings
from bench.course.result import SIMULATED, Number, TaskResult, chart, curve, panel
from bench.course.winding import WindingRun, full_speed, identified_axis, run_winding
from bench.errors import BenchError
from bench.report.document import Chart
from bench.rig.limits import COLD, HOT
from bench.rig.rig import Rig

#: One of so many steps of a run is drawn.
EVERY = 40


#: Temperature of the winding as a run starts - degC - and whether it has its inductance, by the names of the corners.
WAYS = {
    "corner, hot, quasi-static": (HOT, False),
    "corner, cold, quasi-static": (COLD, False),
    "corner, cold, with inductance": (COLD, True),
}


def why_the_corner_lies_higher(recordings: LabRecordings) -> TaskResult:
    """State how many rpm of the corner's shift are due to each of the two causes."""
    rig, axis = recordings.rig, identified_axis(recordings)
    demand = full_speed(rig, axis)
    runs = {name: run_winding(rig, axis, demand, *way) for name, way in WAYS.items()}
    inductance = f"L/R: {recordings.sources('motor', 'electrical_time_constant')}"
    numbers = tuple(
        Number(name, run.corner * RPM, "rpm", source=joined(SIMULATED, *([inductance] if WAYS[name][1] else [])))
        for name, run in runs.items()
    )
    hot, cold, inductive = (number.value for number in numbers)
    findings = (
        f"The winding is cold: with its lower resistance the voltage drives peak current up to {cold:.0f} rpm at "
        f"{COLD:g} °C instead of {hot:.0f} rpm at {HOT:g} °C, {cold - hot:+.0f} rpm. The inductance shifts the corner "
        f"by {inductive - cold:+.1f} rpm, as the current is still constant there; it only delays the fall beyond it."
        f"{_measured(recordings, inductive)}",
    )
    return TaskResult(findings, numbers, (_torque_chart(rig, runs),))


def _measured(recordings: LabRecordings, simulated: float) -> str:
    """The corner of task 10 next to a simulated one - rpm; nothing where that could not be done."""
    try:
        corner = run_up(recordings.fastest, recordings.rig)[1].corner * RPM
    except BenchError:
        return ""
    made = " (this recording was made by the same equations)" if recordings.fastest.truth else ""
    return f" Measured in task 10: {corner:.0f} rpm, {corner - simulated:+.0f} rpm from the simulation{made}."


def _torque_chart(rig: Rig, runs: Mapping[str, WindingRun]) -> Chart:
    speed, torque = datasheet_curve(rig)
    curves = [curve(speed * RPM, torque, f"datasheet, {MAINS:g} V", "dashes")]
    for name, run in runs.items():
        temperature, inductive = WAYS[name]
        named = f"{temperature:g} °C, {'with inductance' if inductive else 'quasi-static'}"
        curves.append(curve(run.velocity[::EVERY] * RPM, run.torque[::EVERY], named))
    return chart("Task 11: simulated peak torque", panel("speed n / rpm", "torque M / (N·m)", *curves))
