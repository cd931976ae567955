"""Task 11: why the measured corner lies at higher speed than the datasheet's, by simulating the motor's winding.

The corner is where the torque starts to decline. There dIq/dt = 0, so temperature moves it and inductance cannot; what
inductance does is to flatten the fall beyond it. The axis is driven through MuJoCo's dcmotor with resistance,
inductance and temperature:

    U = R(T)*Iq + L*dIq/dt + Ke*omega, |U| <= U_max;    J*alpha = kT(Iq)*Iq - K_w*omega - K_0*sgn(omega)

dcmotor's torque is Ke*Iq; what the iron's saturation takes of it, (Ke - kT(Iq))*Iq, is applied beside it in each step.
The drive asks for the current that its velocity loop wants, at most peak current, and its current loop sets the
voltage U = R(T)*I_set + Ke*omega + L/T_c*(I_set - Iq).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from bench.arrays import Array
from bench.course.axis import MAINS, RPM, circuit, joined, motor_value, torque_constant
from bench.course.friction import identify_friction
from bench.course.peak_torque import datasheet_curve, extrapolated_corner, fall
from bench.course.recordings import LabRecordings
from bench.course.result import SIMULATED, Number, TaskResult, chart, curve, panel
from bench.errors import BenchError, InputError, SimulationError
from bench.plant.axis_model import AxisParameters, build_spec
from bench.plant.closed_loop import DIVERGED
from bench.report.document import Chart, Table, table
from bench.rig.limits import COLD, HOT, Circuit, peak_curve
from bench.rig.motor import PeakCurve, TorqueConstant
from bench.rig.rig import Rig

#: Name of the motor's actuator in mjcf/rotary_axis.xml.
DRIVE = "drive"
#: Step of the integration - s. MuJoCo's current errs to first order: the corner by 0.3 rpm (tests/course).
STEP = 25e-6
#: Time constant of the current loop - s.
CURRENT_LOOP = 0.4e-3
#: Electrical time constants that the split is shown for - s.
TIME_CONSTANTS = (1e-3, 2e-3, 3e-3, 5e-3, 8e-3)
#: The run-up lasts as many times J*omega_0/M_max.
LENGTH = 5.0
#: Of the drive, torque asked for per missing speed - N*m*s/rad.
VELOCITY_GAIN = 0.9
#: Shares of the peak torque at which speeds with and without inductance are compared.
SHARES = (0.98, 0.9, 0.7, 0.5)


@dataclass(frozen=True)
class WindingModel:
    """What the current has to pass.

    Attributes:
        circuit: of the motor, at its mains voltage.
        torque_constant: kT(Iq).
        peak_current: limit of the drive - A.
        temperature: of the winding as the run starts, and of its surroundings - degC.
        inductive: whether the winding has its inductance, or current follows voltage at once.
    """

    circuit: Circuit
    torque_constant: TorqueConstant
    peak_current: float
    temperature: float
    inductive: bool

    @classmethod
    def of(cls, rig: Rig, temperature: float, inductive: bool, own: Circuit | None = None) -> WindingModel:
        """Of a rig's motor at MAINS, whose circuit may be given; raises InputError where the rig lacks something."""
        return cls(own or circuit(rig), torque_constant(rig), motor_value(rig, "peak_current"), temperature, inductive)

    @property
    def resistance(self) -> float:
        """As the run starts - ohm."""
        return self.circuit.resistance_at(self.temperature)

    @property
    def inductance(self) -> float:
        """L - H; zero without."""
        return self.circuit.inductance if self.inductive else 0.0


@dataclass(frozen=True)
class WindingRun:
    """One run, signals (steps,).

    Attributes:
        time: s.
        velocity: rad/s.
        current: Iq - A.
        voltage: U - V.
        torque: kT(Iq)*Iq - N*m.
        warming: of the winding from start to end - K.
        limit: U_max - V.
    """

    time: Array
    velocity: Array
    current: Array
    voltage: Array
    torque: Array
    warming: float
    limit: float

    @property
    def corner(self) -> float:
        """Speed from which on full voltage no longer drives peak current, between two steps - rad/s."""
        started = int(np.argmax(self.current > 0.999 * self.current.max()))
        at = started + int(np.argmax(self.voltage[started:] >= self.limit * (1.0 - 1e-9)))
        (before, last), (slower, speed) = self.voltage[at - 2 : at].tolist(), self.velocity[at - 2 : at].tolist()
        return speed + (self.limit - last) * (speed - slower) / (last - before)

    @property
    def line(self) -> float:
        """Corner of the line through the fall - rad/s."""
        return extrapolated_corner(self.velocity, self.current)

    def speed_at(self, share: float) -> float:
        """Speed at which the falling torque passes a share of its top - rad/s."""
        last = int(np.flatnonzero(self.torque > 0.999 * self.torque.max())[-1])
        return float(self.velocity[last + int(np.argmax(self.torque[last:] < share * self.torque.max()))])


def run_winding(winding: WindingModel, axis: AxisParameters, demand: Array) -> WindingRun:
    """Let an axis follow a speed - rad/s, (steps,) at every STEP - through its motor's winding.

    Raises SimulationError where it diverges.
    """
    model = _model(winding, axis)
    data = mujoco.MjData(model)
    circuit, constant, limit = winding.circuit, winding.torque_constant, winding.peak_current
    ke, loop_gain = circuit.back_emf_constant, winding.inductance / CURRENT_LOOP
    current_gain = VELOCITY_GAIN / constant.constant
    record = np.zeros((demand.size, 3))
    for k, wanted in enumerate(demand.tolist()):
        omega = data.qvel[0]
        target = min(max(current_gain * (wanted - omega), -limit), limit)
        resistance = circuit.resistance_at(winding.temperature + data.act[0])
        voltage = resistance * target + ke * omega + loop_gain * (target - data.act[-1])
        data.ctrl[0] = min(max(voltage, -circuit.voltage), circuit.voltage)
        mujoco.mj_forward(model, data)
        current = data.actuator_force[0] / ke
        record[k] = omega, current, data.ctrl[0]
        data.qfrc_applied[0] = constant.curvature * current**3 + (constant.constant - ke) * current
        mujoco.mj_step(model, data)
    if not np.isfinite(record).all():
        raise SimulationError(DIVERGED)
    velocity, current, voltage = record.T
    time = STEP * np.arange(demand.size, dtype=np.float64)
    return WindingRun(time, velocity, current, voltage, constant.torque(current), float(data.act[0]), circuit.voltage)


def _model(winding: WindingModel, axis: AxisParameters) -> mujoco.MjModel:
    """The axis with a dcmotor for its drive. Activations: warming - K, and with inductance the current - A."""
    circuit = winding.circuit
    spec = build_spec(axis, STEP)
    capacity = circuit.thermal_time_constant / circuit.thermal_resistance
    spec.actuator(DRIVE).set_to_dcmotor(
        motorconst=[circuit.back_emf_constant, circuit.back_emf_constant],
        resistance=circuit.resistance,
        # MuJoCo keeps L/R fixed whatever the temperature: it is that of the winding as it is
        inductance=[0.0, winding.inductance / winding.resistance],
        thermal=[circuit.thermal_resistance, capacity, 0.0, circuit.temperature_coefficient, HOT, winding.temperature],
        ctrlspec=int(mujoco.mjtCtrlInput.mjINPUT_VOLTAGE),
    )
    return spec.compile()


@dataclass(frozen=True)
class Split:
    """The run-up by one cause after the other.

    Attributes:
        hot: winding at 120 degC, quasi-static.
        cold: at 20 degC, quasi-static.
        inductive: at 20 degC with the assumed inductance.
        others: at 20 degC with an inductance of each of TIME_CONSTANTS.
        acceleration: at full torque - rad/s**2.
    """

    hot: WindingRun
    cold: WindingRun
    inductive: WindingRun
    others: tuple[WindingRun, ...]
    acceleration: float

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


def split(rig: Rig, axis: AxisParameters) -> Split:
    """Let a rig's motor run up an axis hot, then cold, then cold with L, and with other values of L/R."""
    own = circuit(rig)
    full = float(torque_constant(rig).torque(np.asarray(motor_value(rig, "peak_current"))))
    top = own.voltage / own.back_emf_constant
    demand = np.full(round(LENGTH * axis.inertia * top / full / STEP), top)

    def simulated(temperature: float, inductive: bool, winding: Circuit = own) -> WindingRun:
        return run_winding(WindingModel.of(rig, temperature, inductive, winding), axis, demand)

    return Split(
        hot=simulated(HOT, False),
        cold=simulated(COLD, False),
        inductive=simulated(COLD, True),
        others=tuple(simulated(COLD, True, replace(own, time_constant=tau)) for tau in TIME_CONSTANTS),
        acceleration=(full - axis.coulomb_friction) / axis.inertia,
    )


def identified_axis(recordings: LabRecordings) -> AxisParameters:
    """The axis as task 9 finds it; the embedded example's where there is no such recording."""
    try:
        found = identify_friction(recordings.with_friction)
    except BenchError:
        return AxisParameters.from_rig(recordings.example)
    return AxisParameters(found.inertia, max(found.viscous, 0.0), max(found.coulomb, 0.0))


def why_the_corner_lies_higher(recordings: LabRecordings) -> TaskResult:
    """State how many rpm of the corner's shift each of the two causes is, and what inductance does instead."""
    rig = recordings.rig
    found = split(rig, identified_axis(recordings))
    assumed = recordings.sources("motor", "electrical_time_constant")
    faster = ", ".join(f"{speed * RPM:.0f} rpm at {share:.0%}" for share, speed in found.faster.items())
    sheet = peak_curve(rig.motor, MAINS, rig.source).corner_speed
    left_out, tables, shown = _of_circuits(rig)
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
        f"The winding warms by {found.hot.warming:.1f} K (hot) and {found.cold.warming:.1f} K (cold) during "
        f"the run-up, which keeps the hot corner {(found.hot.corner - sheet) * RPM:+.0f} rpm from the datasheet's "
        f"{sheet * RPM:.0f} rpm.",
        left_out,
    )
    charts = (_torque_chart(rig, found), _dependence_chart(found), *shown)
    return TaskResult(findings, _numbers(found, joined(SIMULATED, f"L/R: {assumed}")), charts, tables=tables)


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
    others = {f"L/R = {tau * 1e3:g} ms": other for tau, other in zip(TIME_CONSTANTS, found.others, strict=True)}
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
    same = (
        " This recording was made by the same equations: that they agree shows that corner and lag can be read from "
        "noisy samples at 1 ms, and nothing about a motor."
    )
    return (text + same if recordings.fastest.truth else text,)


@dataclass(frozen=True)
class CircuitTold:
    """What one circuit says of the corner at MAINS.

    Attributes:
        name: of it.
        shift: of the corner from hot to cold - rad/s.
        half_way: from hot to the middle of both temperatures - rad/s.
        at_other: corner at the datasheet's other mains voltage - rad/s.
        into_shaft: share of the back-EMF's power that comes out at the shaft, at the corner.
    """

    name: str
    shift: float
    half_way: float
    at_other: float
    into_shaft: float


def circuits(rig: Rig, other: PeakCurve) -> list[CircuitTold]:
    """The course's circuit, one whose power balances, Ke = kT(Iq), and both with the voltage across that w*p*L*Iq is.

    Args:
        rig: whose motor's peak curve at MAINS each meets.
        other: the curve at another voltage, which those with the voltage across meet, too.

    Raises:
        InputError: the rig lacks something.
    """
    motor, low, peak = circuit(rig), peak_curve(rig.motor, MAINS, rig.source), motor_value(rig, "peak_current")
    saturated = float(torque_constant(rig).torque(np.asarray(peak))) / peak
    told = []
    for name, ke in (("Ke constant, as the course's", motor.back_emf_constant), ("Ke = kT(Iq)", saturated)):
        drop = motor.voltage - ke * low.corner_speed
        own = replace(motor, back_emf_constant=ke, resistance=drop / peak)
        alone = (1.0 - motor.cold_share) * drop / ke
        beyond = (motor.voltage * other.mains_voltage / low.mains_voltage - drop) / ke
        told.append(CircuitTold(name, alone, 0.5 * alone, beyond, saturated / ke))
        halfway = replace(own, cold_share=0.5 * (1.0 + own.cold_share))
        shift, half_way = (cross_voltage(one, low, other)[0] for one in (own, halfway))
        told.append(CircuitTold(f"{name}, with ω·p·L·Iq", shift, half_way, other.corner_speed, saturated / ke))
    return told


def _of_circuits(rig: Rig) -> tuple[str, tuple[Table, ...], tuple[Chart, ...]]:
    """What the circuit leaves out, told by power and by the curve at another voltage, and how to measure it."""
    other = next((curve for curve in rig.motor.peak_curves if curve.mains_voltage != MAINS), None)
    if other is None:
        return "The datasheet has one mains voltage only, so what the circuit leaves out does not show.", (), ()
    told = circuits(rig, other)
    course, balanced, both = told[0], told[2], told[3]
    shifts = f"{told[1].shift * RPM:.0f} and {both.shift * RPM:.0f} rpm"
    text = (
        f"These {course.shift * RPM:.0f} rpm are those of the course's circuit, and no bound. Of the power that its "
        f"back-EMF takes at the corner {course.into_shaft:.0%} come out at the shaft, as torque saturates and Ke does "
        f"not; with Ke = kT(Iq), which balances, it is {balanced.shift * RPM:.0f} rpm. Both put the corner at "
        f"{other.mains_voltage:g} V far above the datasheet's {other.corner_speed * RPM:.0f} rpm: they leave out the "
        "voltage ω·p·L·Iq at a right angle to the back-EMF, which grows with speed. Circuits that have it and meet "
        f"both curves, U² = (R·Iq + Ke·ω)² + (ω·p·L·Iq)², say {shifts}, so the cold winding explains about that much "
        "of what is measured, if the datasheet's curves are the motor's. To tell, record the run-up twice, cold and "
        f"with the winding at {0.5 * (HOT + COLD):g} °C: ω·p·L does not change with temperature, so the corners lie "
        f"{(both.shift - both.half_way) * RPM:.0f} rpm apart by the last circuit and "
        f"{(course.shift - course.half_way) * RPM:.0f} rpm by the course's."
    )
    rows = [(one.name, f"{one.shift * RPM:+.0f}", f"{one.at_other * RPM:.0f}", f"{one.into_shaft:.0%}") for one in told]
    at_other = f"corner at {other.mains_voltage:g} V / rpm>"
    head = ("circuit", "shift, hot to cold / rpm>", at_other, "EMF's power at shaft>")
    caption = f"Circuits that meet the peak curve at {MAINS:g} V"
    return text, (table(caption, head, rows),), (_power_chart(rig),)


def _power_chart(rig: Rig) -> Chart:
    """Power of the back-EMF and of the shaft in the course's circuit, cold, at full voltage or peak current."""
    motor, constant, peak = circuit(rig), torque_constant(rig), motor_value(rig, "peak_current")
    speed = np.linspace(0.0, motor.voltage / motor.back_emf_constant, 200)
    left = (motor.voltage - motor.back_emf_constant * speed) / (motor.cold_share * motor.resistance)
    current = np.minimum(peak, left)
    shown = panel(
        "speed n / rpm",
        "power / W",
        curve(speed * RPM, motor.back_emf_constant * current * speed, "into a constant back-EMF, Ke·Iq·ω"),
        curve(speed * RPM, constant.torque(current) * speed, "out at the shaft, kT(Iq)·Iq·ω", "dashes"),
    )
    return chart("Task 11: power that the course's circuit loses", shown)


def cross_voltage(motor: Circuit, low: PeakCurve, high: PeakCurve) -> tuple[float, float]:
    """What two peak curves say of a circuit with the voltage at a right angle, U**2 = (R*I + Ke*w)**2 + (w*p*L*I)**2.

    Taking (w_2/w_1)**2 times the equation at corner 1 from that at corner 2 leaves a quadratic in R*I.

    Args:
        motor: circuit at the mains voltage of `low`.
        low, high: curves at two mains voltages.

    Returns:
        Shift of the corner of `low` from hot to cold - rad/s, and p*L/R cold - s; the current cancels out.

    Raises:
        InputError: no such circuit meets both curves.
    """
    ke, voltage, one, two = motor.back_emf_constant, motor.voltage, low.corner_speed, high.corner_speed
    q, ratio = (two / one) ** 2, high.mains_voltage / low.mains_voltage
    drop = _positive_root(q - 1.0, 2.0 * ke * (q * one - two), voltage**2 * (ratio**2 - q))
    across = (voltage**2 - (drop + ke * one) ** 2) / one**2
    if not across > 0.0:
        raise InputError("motor.peak_curves", "found two curves that no circuit meets", "give the datasheet's corners")
    cold = drop * motor.cold_share
    corner = _positive_root(ke**2 + across, 2.0 * ke * cold, cold**2 - voltage**2)
    return corner - one, float(np.sqrt(across)) / cold


def _positive_root(a: float, b: float, c: float) -> float:
    """Of a*x**2 + b*x + c with a > 0 > c."""
    return float((-b + np.sqrt(b**2 - 4.0 * a * c)) / (2.0 * a))


def _torque_chart(rig: Rig, found: Split) -> Chart:
    speed, torque = datasheet_curve(rig)
    every = slice(None, None, 40)
    simulated = {
        f"{HOT:g} °C, quasi-static": found.hot,
        f"{COLD:g} °C, quasi-static": found.cold,
        f"{COLD:g} °C, with inductance": found.inductive,
    }
    curves = (curve(run.velocity[every] * RPM, run.torque[every], name) for name, run in simulated.items())
    datasheet = curve(speed * RPM, torque, f"datasheet, {MAINS:g} V", "dashes")
    return chart("Task 11: simulated peak torque", panel("speed n / rpm", "torque M / (N·m)", datasheet, *curves))


def _dependence_chart(found: Split) -> Chart:
    tau = np.array(TIME_CONSTANTS)
    from_zero = np.append(0.0, tau)
    corners = (np.array([one.corner for one in found.others]) - found.cold.corner) * RPM
    lines = (np.array([one.line for one in found.others]) - found.cold.line) * RPM
    axes = panel(
        "electrical time constant L/R / ms",
        "shift by inductance / rpm",
        curve(tau * 1e3, corners, "corner", "large dots"),
        curve(tau * 1e3, lines, "line through the fall", "large dots"),
        curve(from_zero * 1e3, from_zero * found.acceleration * RPM, "α·L/R at full torque", "dashes"),
    )
    return chart("Task 11: inductance moves the fall, not the corner", axes)
