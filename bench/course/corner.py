"""Task 11: why the measured corner lies at higher speed than the datasheet's, by simulating the motor's winding.

One cause after the other, in the course's circuit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from bench.course.axis import MAINS, RPM, circuit, joined
from bench.course.peak_torque import datasheet_curve, fall
from bench.course.recordings import LabRecordings
from bench.course.result import SIMULATED, Number, TaskResult, chart, curve, panel
from bench.course.winding import WindingModel, WindingRun, full_speed, identified_axis, run_winding
from bench.errors import BenchError
from bench.plant.axis_model import AxisParameters
from bench.report.document import Chart
from bench.rig.limits import COLD, HOT, Circuit, peak_curve
from bench.rig.rig import Rig

#: Electrical time constants that the split is shown for - s.
TIME_CONSTANTS = (1e-3, 2e-3, 3e-3, 5e-3, 8e-3)
#: Shares of the peak torque at which speeds with and without inductance are compared.
SHARES = (0.98, 0.9, 0.7, 0.5)
FASTER = "with inductance faster at {:.0%} of the torque by"
#: One of so many steps of a run is drawn.
EVERY = 40


@dataclass(frozen=True)
class Split:
    """The run-up by one cause after the other.

    Attributes:
        hot, cold: winding at 120 degC and at 20 degC, quasi-static.
        inductive: at 20 degC with the assumed inductance.
        others: at 20 degC with an inductance of each of TIME_CONSTANTS.
    """

    hot: WindingRun
    cold: WindingRun
    inductive: WindingRun
    others: Mapping[float, WindingRun]

    @classmethod
    def of(cls, rig: Rig, axis: AxisParameters) -> Split:
        """Of a rig's motor that runs up an axis."""
        own, demand = circuit(rig), full_speed(rig, axis)

        def simulated(temperature: float, inductive: bool, winding: Circuit = own) -> WindingRun:
            return run_winding(WindingModel.of(rig, temperature, inductive, winding), axis, demand)

        runs = simulated(HOT, False), simulated(COLD, False), simulated(COLD, True)
        others = {tau: simulated(COLD, True, replace(own, time_constant=tau)) for tau in TIME_CONSTANTS}
        return cls(*runs, others)


def why_the_corner_lies_higher(recordings: LabRecordings) -> TaskResult:
    """State how many rpm of the corner's shift each of the two causes is, and what inductance does instead."""
    rig = recordings.rig
    found = Split.of(rig, identified_axis(recordings))
    assumed = recordings.sources("motor", "electrical_time_constant")
    numbers = _numbers(found, joined(SIMULATED, f"L/R: {assumed}"))
    rpm = {number.name: number.value for number in numbers}
    faster = ", ".join(f"{rpm[FASTER.format(share)]:.0f} rpm at {share:.0%}" for share in SHARES)
    hot, sheet = rpm["corner, hot, quasi-static"], peak_curve(rig.motor, MAINS, rig.source).corner_speed * RPM
    findings = (
        "The corner is the speed at which the torque starts to decline, as full voltage no longer drives peak current: "
        "U = R·Imax + Ke·ω. The current is still constant there, dIq/dt = 0, so no inductance can move it.",
        f"Simulated, it lies at {hot:.0f} rpm hot, at {rpm['corner, cold, quasi-static']:.0f} rpm cold and at "
        f"{rpm['corner, cold, with inductance']:.0f} rpm cold with inductance (L/R, {assumed}): the cold winding moves "
        f"it by {rpm['shift by temperature']:+.0f} rpm, as it takes less voltage and leaves more to the back-EMF, the "
        f"inductance by {rpm['shift by inductance']:+.1f} rpm, and for L/R from 1 to 8 ms alike.",
        "What inductance does is to flatten the fall: beyond the corner it keeps the current up for about L/R, in "
        f"which speed rises by α·L/R. The same torque is there at a higher speed, by {faster} of the "
        "peak. Whoever reads the corner from the line through the fall, or at a few percent below the peak, counts "
        "this as a shift.",
        *_measured_findings(recordings, found),
        f"The winding warms by {found.hot.warming[-1]:.1f} K (hot) and {found.cold.warming[-1]:.1f} K (cold) during "
        f"the run-up, which keeps the hot corner {hot - sheet:+.0f} rpm from the datasheet's {sheet:.0f} rpm.",
    )
    return TaskResult(findings, numbers, (_torque_chart(rig, found),))


def _numbers(found: Split, with_inductance: str) -> tuple[Number, ...]:
    speeds = {
        "corner, hot, quasi-static": (found.hot.corner, SIMULATED),
        "corner, cold, quasi-static": (found.cold.corner, SIMULATED),
        "corner, cold, with inductance": (found.inductive.corner, with_inductance),
        "shift by temperature": (found.cold.corner - found.hot.corner, SIMULATED),
        "shift by inductance": (found.inductive.corner - found.cold.corner, with_inductance),
    }
    for share in SHARES:
        faster = found.inductive.speed_at(share) - found.cold.speed_at(share)
        speeds[FASTER.format(share)] = faster, with_inductance
    others = {f"L/R = {tau * 1e3:g} ms": other for tau, other in found.others.items()}
    speeds |= {f"corner, {words}": (other.corner, SIMULATED) for words, other in others.items()}
    speeds |= {f"fall later by, {words}": (other.line - found.cold.line, SIMULATED) for words, other in others.items()}
    return tuple(Number(name, speed * RPM, "rpm", source=source) for name, (speed, source) in speeds.items())


def _measured_findings(recordings: LabRecordings, found: Split) -> tuple[str, ...]:
    """What task 10 measured beside the simulation; nothing where that could not be done, which it says itself."""
    try:
        measured = fall(recordings.fastest, recordings.rig)
    except BenchError:
        return ()
    text = (
        f"Measured in task 10: {measured.corner * RPM:.0f} rpm, "
        f"{(measured.corner - found.inductive.corner) * RPM:+.1f} rpm from the simulation, and a fall that comes "
        f"{measured.lag * 1e3:.1f} ms late (L/R as it acts)."
    )
    if recordings.fastest.truth:
        text += (
            " This recording was made by the same equations: that they agree shows that corner and lag can be read "
            "from noisy samples at 1 ms, and nothing about a motor."
        )
    return (text,)


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
