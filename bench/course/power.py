"""Task 11: where the power of a run-up goes, and circuits that meet the datasheet's peak curves at both mains voltages.

U**2 = (R*I + Ke*w)**2 + (w*p*L*I)**2  at both corners gives R and p*L, for Ke constant or Ke = kT(Iq).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import Array
from bench.course.axis import MAINS, RPM, circuit, motor_value, torque_constant
from bench.course.peak_torque import POINTS
from bench.course.result import SIMULATED, Number, TaskResult, chart, curve, panel
from bench.course.winding import STEP, Split, WindingModel, WindingRun, full_speed, run_winding
from bench.errors import InputError
from bench.plant.axis_model import AxisParameters
from bench.report.document import Chart, Panel, Table, table
from bench.rig.limits import COLD, HOT, peak_curve
from bench.rig.motor import PeakCurve, TorqueConstant
from bench.rig.rig import Rig

COURSES, BALANCED = "Ke constant, as the course's", "Ke = kT(Iq)"
#: One of so many steps of a run is drawn.
EVERY = 40


@dataclass(frozen=True)
class CircuitValues:
    """What one circuit says of the corner at MAINS, the winding being hot unless it is said to be cold.

    Attributes:
        name: of it.
        ke: voltage per speed at peak current - V*s/rad.
        drop: R*I_max hot - V.
        across: w*p*L*I_max per speed - V*s/rad.
        voltage: U_max - V.
        cold_share: R cold over R hot.
        into_shaft: share of the back-EMF's power that comes out at the shaft, at the corner.
        idle: voltage per speed without current - V*s/rad.
    """

    name: str
    ke: float
    drop: float
    across: float
    voltage: float
    cold_share: float
    into_shaft: float
    idle: float

    def corner(self, share: float = 1.0, voltages: float = 1.0) -> float:
        """Corner with a share of the hot resistance, at so many times the voltage - rad/s."""
        drop, voltage = share * self.drop, voltages * self.voltage
        return _positive_root(self.ke**2 + self.across**2, 2.0 * self.ke * drop, drop**2 - voltage**2)

    def resistance_share(self, corner: float) -> float:
        """Share of the hot resistance that puts the corner at a speed - rad/s."""
        left = max(self.voltage**2 - (self.across * corner) ** 2, 0.0)
        return (math.sqrt(left) - self.ke * corner) / self.drop

    @property
    def shift(self) -> float:
        """Of the corner from hot to cold - rad/s."""
        return self.corner(self.cold_share) - self.corner()

    @property
    def half_way(self) -> float:
        """From hot to the middle of both temperatures - rad/s."""
        return self.corner(0.5 * (1.0 + self.cold_share)) - self.corner()

    def no_load(self, voltages: float = 1.0) -> float:
        """Speed without current at so many times the voltage - rad/s."""
        return voltages * self.voltage / self.idle


def circuits(rig: Rig, other: PeakCurve) -> list[CircuitValues]:
    """The course's circuit, one whose power balances, Ke = kT(Iq), and both with the voltage across that w*p*L*Iq is.

    The last again, with the voltage that the datasheet's no-load speed asks of it, 4.6 % more in the lab's motor.

    Args:
        rig: whose motor's peak curve at MAINS each meets.
        other: the curve at another voltage, which those with the voltage across meet, too.

    Raises:
        InputError: the rig lacks something, or no such circuit meets both curves.
    """
    motor, low, peak = circuit(rig), peak_curve(rig.motor, MAINS, rig.source), motor_value(rig, "peak_current")
    idle, saturated = (float(torque_constant(rig)(np.asarray(current))) for current in (0.0, peak))
    course, balanced = (COURSES, motor.back_emf_constant, motor.back_emf_constant), (BALANCED, saturated, idle)
    usual, enough = motor.voltage, idle * low.no_load_speed
    cases = [(one, usual, crossed) for one in (course, balanced) for crossed in (False, True)]
    values = []
    for (name, ke, of_none), given, crossed in (*cases, (balanced, enough, True)):
        drop, across = _of_both(ke, given, low, other) if crossed else (given - ke * low.corner_speed, 0.0)
        words = f"{name}{', with ω·p·L·Iq' * crossed}{f', {given:.0f} V' * (given != usual)}"
        values.append(CircuitValues(words, ke, drop, across, given, motor.cold_share, saturated / ke, of_none))
    return values


def _of_both(ke: float, voltage: float, low: PeakCurve, high: PeakCurve) -> tuple[float, float]:
    """R*I_max hot - V - and the voltage across per speed - V*s/rad - of a circuit that meets two peak curves.

    Taking (w_2/w_1)**2 times the equation at corner 1 from that at corner 2 leaves a quadratic in R*I_max.
    """
    one, two = low.corner_speed, high.corner_speed
    q, ratio = (two / one) ** 2, high.mains_voltage / low.mains_voltage
    drop = _positive_root(q - 1.0, 2.0 * ke * (q * one - two), voltage**2 * (ratio**2 - q))
    across = (voltage**2 - (drop + ke * one) ** 2) / one**2
    if not across > 0.0:
        raise InputError("motor.peak_curves", "found two curves that no circuit meets", "give the datasheet's corners")
    return drop, math.sqrt(across)


def _positive_root(a: float, b: float, c: float) -> float:
    """Of a*x**2 + b*x + c with a > 0 > c."""
    return (-b + math.sqrt(b**2 - 4.0 * a * c)) / (2.0 * a)


def balanced_winding(rig: Rig, found: CircuitValues, temperature: float) -> WindingModel:
    """The winding of a circuit whose power balances, at a temperature - degC - as it starts."""
    motor, peak = circuit(rig), motor_value(rig, "peak_current")
    resistance = found.drop / peak
    heating = motor.thermal_resistance * motor.resistance / resistance
    own = replace(motor, resistance=resistance, thermal_resistance=heating)
    return replace(WindingModel.of(rig, temperature, True, own), across=found.across / peak)


@dataclass(frozen=True)
class PowerOfRun:
    """Where the power of a run-up goes at each step (n,) - W.

    Attributes:
        speed: rad/s.
        terminals: what the drive gives.
        heat: of the winding.
        field: into the magnetic field.
        axis: what accelerates the axis and what its friction takes.
    """

    speed: Array
    terminals: Array
    heat: Array
    field: Array
    axis: Array

    @classmethod
    def of(cls, run: WindingRun, winding: WindingModel, axis: AxisParameters) -> PowerOfRun:
        """From full current to the highest speed of a run; what the axis takes follows from its motion alone."""
        up = slice(int(np.argmax(run.current > 0.999 * run.current.max())), int(np.argmax(run.velocity)))
        speed, current, circuit = run.velocity[up], run.current[up], winding.circuit
        slope, acceleration = (np.gradient(signal, STEP)[up] for signal in (run.current, run.velocity))
        friction = axis.viscous_friction_coefficient * speed + axis.coulomb_friction * np.sign(speed)
        warmer = 1.0 + circuit.temperature_coefficient * run.warming[up] / winding.resistance * circuit.resistance
        return cls(
            speed=speed,
            terminals=run.voltage[up] * current,
            heat=winding.resistance * warmer * current**2,
            field=winding.inductance * warmer * current * slope,  # MuJoCo keeps L/R fixed
            axis=(axis.inertia * acceleration + friction) * speed,
        )

    @property
    def left(self) -> Array:
        """What none of them gets - W."""
        return self.terminals - self.heat - self.field - self.axis

    @property
    def lost(self) -> float:
        """The most of it at one time - W."""
        return float(np.max(np.abs(self.left)))


def of_circuits(rig: Rig, axis: AxisParameters, found: Split) -> TaskResult:
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


def speed_of_current(one: CircuitValues, peak: float, constant: TorqueConstant, voltages: float) -> tuple[Array, Array]:
    """Highest speed - rad/s - at which a hot circuit drives a current - A -, (POINTS,), from peak current to none.

    Args:
        one: circuit; where its power balances, Ke is kT of the current.
        peak: current that its drop and voltage across are of - A.
        constant: kT(Iq).
        voltages: so many times the voltage at MAINS.
    """
    current = np.linspace(peak, 0.0, POINTS)
    ke = constant(current) if one.name.startswith(BALANCED) else np.full(POINTS, one.ke)
    drop, across = one.drop * current / peak, one.across * current / peak
    a, b, c = ke**2 + across**2, 2.0 * ke * drop, drop**2 - (voltages * one.voltage) ** 2
    return (-b + np.sqrt(b**2 - 4.0 * a * c)) / (2.0 * a), current
