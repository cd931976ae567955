"""Task 11: why the measured corner lies at higher speed than the datasheet's, by simulating the motor's winding.

One cause after the other in the course's circuit; then where its power goes, and what circuits say that balance.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.course.axis import MAINS, RPM, circuit, joined, motor_value, torque_constant
from bench.course.peak_torque import datasheet_curve, fall
from bench.course.power import BALANCED, CircuitValues, PowerOfRun, balanced_winding, circuits, speed_of_current
from bench.course.recordings import LabRecordings
from bench.course.result import SIMULATED, Number, TaskResult, chart, curve, panel
from bench.course.winding import WindingModel, WindingRun, full_speed, identified_axis, run_winding
from bench.errors import BenchError
from bench.plant.axis_model import AxisParameters
from bench.report.document import Chart, Panel, Table, table
from bench.rig.limits import COLD, HOT, Circuit, peak_curve
from bench.rig.motor import PeakCurve
from bench.rig.rig import Rig

#: Electrical time constants that the split is shown for - s.
TIME_CONSTANTS = (1e-3, 2e-3, 3e-3, 5e-3, 8e-3)
#: Shares of the peak torque at which speeds with and without inductance are compared.
SHARES = (0.98, 0.9, 0.7, 0.5)
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
        own, (_, demand) = circuit(rig), full_speed(rig, axis)

        def simulated(temperature: float, inductive: bool, winding: Circuit = own) -> WindingRun:
            return run_winding(WindingModel.of(rig, temperature, inductive, winding), axis, demand)

        runs = simulated(HOT, False), simulated(COLD, False), simulated(COLD, True)
        others = {tau: simulated(COLD, True, replace(own, time_constant=tau)) for tau in TIME_CONSTANTS}
        return cls(*runs, others)

    @property
    def by_temperature(self) -> float:
        """Shift of the corner - rad/s."""
        return self.cold.corner - self.hot.corner

    @property
    def by_inductance(self) -> float:
        """Shift of the corner - rad/s."""
        return self.inductive.corner - self.cold.corner

    @property
    def faster(self) -> dict[float, float]:
        """By how much inductance raises the speed of the same share of the peak torque - rad/s, by the share."""
        return {share: self.inductive.speed_at(share) - self.cold.speed_at(share) for share in SHARES}


def why_the_corner_lies_higher(recordings: LabRecordings) -> TaskResult:
    """State how many rpm of the corner's shift each of the two causes is, and what inductance does instead."""
    rig = recordings.rig
    axis = identified_axis(recordings)
    found = Split.of(rig, axis)
    assumed = recordings.sources("motor", "electrical_time_constant")
    faster = ", ".join(f"{speed * RPM:.0f} rpm at {share:.0%}" for share, speed in found.faster.items())
    sheet = peak_curve(rig.motor, MAINS, rig.source).corner_speed
    power = _of_circuits(rig, axis, found)
    findings = (
        "The corner is the speed at which the torque starts to decline, as full voltage no longer drives peak current: "
        "U = R·Imax + Ke·ω. The current is still constant there, dIq/dt = 0, so no inductance can move it.",
        f"Simulated, it lies at {found.hot.corner * RPM:.0f} rpm hot, at {found.cold.corner * RPM:.0f} rpm cold and at "
        f"{found.inductive.corner * RPM:.0f} rpm cold with inductance (L/R, {assumed}): the cold winding moves it by "
        f"{found.by_temperature * RPM:+.0f} rpm, as it takes less voltage and leaves more to the back-EMF, the "
        f"inductance by {found.by_inductance * RPM:+.1f} rpm, and for L/R from 1 to 8 ms alike.",
        "What inductance does is to flatten the fall: beyond the corner it keeps the current up for about L/R, in "
        f"which speed rises by α·L/R. The same torque is there at a higher speed, by {faster} of the "
        "peak. Whoever reads the corner from the line through the fall, or at a few percent below the peak, counts "
        "this as a shift.",
        *_measured_findings(recordings, found),
        f"The winding warms by {found.hot.warming[-1]:.1f} K (hot) and {found.cold.warming[-1]:.1f} K (cold) during "
        f"the run-up, which keeps the hot corner {(found.hot.corner - sheet) * RPM:+.0f} rpm from the datasheet's "
        f"{sheet * RPM:.0f} rpm.",
        *power.findings,
    )
    numbers = (*_numbers(found, joined(SIMULATED, f"L/R: {assumed}")), *power.numbers)
    charts = (_torque_chart(rig, found), _dependence_chart(rig, axis, found), *power.charts)
    return TaskResult(findings, numbers, charts, tables=power.tables)


def _numbers(found: Split, with_inductance: str) -> tuple[Number, ...]:
    speeds = {
        "corner, hot, quasi-static": (found.hot.corner, SIMULATED),
        "corner, cold, quasi-static": (found.cold.corner, SIMULATED),
        "corner, cold, with inductance": (found.inductive.corner, with_inductance),
        "shift by temperature": (found.by_temperature, SIMULATED),
        "shift by inductance": (found.by_inductance, with_inductance),
    }
    for share, faster in found.faster.items():
        speeds[f"with inductance faster at {share:.0%} of the torque by"] = faster, with_inductance
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


def _dependence_chart(rig: Rig, axis: AxisParameters, found: Split) -> Chart:
    acceleration = (full_speed(rig, axis)[0] - axis.coulomb_friction) / axis.inertia
    tau = np.array(TIME_CONSTANTS)
    from_zero = np.append(0.0, tau)
    corners = (np.array([one.corner for one in found.others.values()]) - found.cold.corner) * RPM
    lines = (np.array([one.line for one in found.others.values()]) - found.cold.line) * RPM
    axes = panel(
        "electrical time constant L/R / ms",
        "shift by inductance / rpm",
        curve(tau * 1e3, corners, "corner", "large dots"),
        curve(tau * 1e3, lines, "line through the fall", "large dots"),
        curve(from_zero * 1e3, from_zero * acceleration * RPM, "α·L/R at full torque", "dashes"),
    )
    return chart("Task 11: inductance moves the fall, not the corner", axes)


def _of_circuits(rig: Rig, axis: AxisParameters, found: Split) -> TaskResult:
    """What the course's circuit leaves out, by its power and by the curve at another voltage; how to measure it."""
    other = next((curve for curve in rig.motor.peak_curves if curve.mains_voltage != MAINS), None)
    if other is None:
        return TaskResult(("The datasheet has one mains voltage only, so what the circuit leaves out does not show.",))
    values = circuits(rig, other)
    course, both, fed = values[0], values[3], values[-1]
    _, demand = full_speed(rig, axis)
    windings = {start: balanced_winding(rig, both, start) for start in (HOT, COLD, 0.5 * (HOT + COLD))}
    hot, cold, half_way = (run_winding(winding, axis, demand) for winding in windings.values())
    before = PowerOfRun.of(found.inductive, WindingModel.of(rig, COLD, True), axis)
    after = PowerOfRun.of(cold, windings[COLD], axis)
    apart = (cold.corner - half_way.corner) * RPM
    findings = (
        f"The {found.by_temperature * RPM:.0f} rpm are those of the course's circuit, and no bound. Of the power that "
        f"its back-EMF takes at the corner {course.into_shaft:.0%} come out at the shaft, as torque saturates and Ke "
        f"does not: {before.lost:.0f} W from the terminals are in neither heat, field nor axis. With Ke = kT(Iq) it "
        f"balances, and the shift is {values[2].shift * RPM:.0f} rpm. Both put the corner at "
        f"{other.mains_voltage:g} V far above the datasheet's {other.corner_speed * RPM:.0f} rpm, as they leave out "
        "the voltage ω·p·L·Iq at a right angle to the back-EMF.",
        "A winding that balances and meets both curves has flux of two axes, p·ψ_d = kT(Iq), which saturates, and "
        "ψ_q = L·Iq: u_q = R·Iq + L·dIq/dt + kT(Iq)·ω, u_d = dψ_d/dt - ω·p·L·Iq. R and p·L follow from both corners. "
        f"Simulated with the axis it leaves {after.lost:.2g} W unaccounted for at most, and its corner lies "
        f"at {hot.corner * RPM:.0f} rpm hot and {cold.corner * RPM:.0f} rpm cold: the cold winding moves it by "
        f"{(cold.corner - hot.corner) * RPM:+.0f} rpm, about so much of what is measured, if the datasheet's curves "
        "are the motor's.",
        f"Without current that winding reaches {both.no_load() * RPM:.0f} rpm, "
        f"{both.no_load() / course.no_load() - 1.0:+.1%} from the datasheet's, as kT(0) is so much above U/ω_0. With "
        f"{fed.voltage:.0f} V in place of {both.voltage:.0f} V, as overmodulation gives, it meets that, too, and at "
        f"{other.mains_voltage:g} V {fed.no_load(other.mains_voltage / MAINS) * RPM:.0f} of "
        f"{other.no_load_speed * RPM:.0f} rpm; the shift is {fed.shift * RPM:+.0f} rpm all the same.",
        f"To tell temperature from ω·p·L, record the run-up twice, cold and with the winding at {0.5 * (HOT + COLD):g} "
        f"°C: R changes and ω·p·L does not, so the corners lie {apart:.0f} rpm apart if ω·p·L acts and "
        f"{(course.shift - course.half_way) * RPM:.0f} rpm if R alone does. Another mains voltage tells it, too.",
    )
    speeds = {"hot": hot.corner, f"at {0.5 * (HOT + COLD):g} °C": half_way.corner, "cold": cold.corner}
    speeds |= {"shift by temperature": cold.corner - hot.corner}
    numbers = [Number(f"power balances: {name}", v * RPM, "rpm", source=SIMULATED) for name, v in speeds.items()]
    lost = {"course's circuit": before.lost, "power balances": after.lost}
    numbers += [Number(f"power left over at most, {name}", v, "W", source=SIMULATED) for name, v in lost.items()]
    return TaskResult(
        findings,
        tuple(numbers),
        (_power_chart(before, after), _curves_chart(rig, other, course, both)),
        tables=(_circuits_table(values, other),),
    )


def _circuits_table(values: list[CircuitValues], other: PeakCurve) -> Table:
    voltages = other.mains_voltage / MAINS
    rows = []
    for one in values:
        speeds = (f"{speed * RPM:.0f}" for speed in (one.corner(voltages=voltages), one.no_load()))
        rows.append((one.name, f"{one.shift * RPM:+.0f}", *speeds, f"{one.into_shaft:.0%}"))
    at_other = f"corner at {other.mains_voltage:g} V / rpm>"
    head = ("circuit", "shift, hot to cold / rpm>", at_other, "no-load speed / rpm>", "EMF's power at shaft>")
    return table(f"Circuits that meet the peak curve at {MAINS:g} V", head, rows)


def _power_chart(before: PowerOfRun, after: PowerOfRun) -> Chart:
    """What the terminals give, and where it goes."""

    def shown(power: PowerOfRun, name: str) -> Panel:
        parts = {"heat, R·Iq²": power.heat, "field": power.field, "axis": power.axis, "left over": power.left}
        speed = power.speed[::EVERY] * RPM
        given = curve(speed, power.terminals[::EVERY], "from the terminals", "wide")
        parts = (curve(speed, part[::EVERY], part_of) for part_of, part in parts.items())
        return panel("speed n / rpm", f"{name}: power / W", given, *parts)

    panels = shown(before, "course's circuit"), shown(after, BALANCED)
    return chart("Task 11: power of the run-up, cold", *panels)


def _curves_chart(rig: Rig, other: PeakCurve, *values: CircuitValues) -> Chart:
    """Peak torque over speed at both mains voltages: the datasheet's, and what circuits make of it."""
    peak, constant = motor_value(rig, "peak_current"), torque_constant(rig)
    full = float(constant.torque(np.asarray(peak)))
    panels = []
    for sheet in (peak_curve(rig.motor, MAINS, rig.source), other):
        limit = np.array([0.0, sheet.corner_speed, sheet.no_load_speed])
        curves = [curve(limit * RPM, full * sheet.share(limit), "datasheet", "dashes")]
        for one in values:
            speed, current = speed_of_current(one, peak, constant, sheet.mains_voltage / MAINS)
            curves.append(curve(np.append(0.0, speed) * RPM, np.append(full, constant.torque(current)), one.name))
        panels.append(panel("speed n / rpm", f"M_max at {sheet.mains_voltage:g} V / (N·m)", *curves))
    return chart("Task 11: peak curves of both mains voltages, hot", *panels)
