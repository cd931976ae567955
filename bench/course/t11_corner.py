"""Task 11: why the measured corner lies at higher speed than the datasheet's, by simulating the motor's winding.

The corner is where the torque starts to decline. There dIq/dt = 0, so temperature moves it and inductance cannot; what
inductance does is to flatten the fall beyond it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bench.course.corner import Decline, extrapolated_corner
from bench.course.result import SIMULATED, Chart, Curve, Number, Panel, Task
from bench.course.rig import torque_constant
from bench.course.sources import Sources, joined
from bench.course.t10_peak_torque import RPM, datasheet_curve
from bench.course.winding import STEP, Winding, WindingRun, run_winding
from bench.errors import InputError
from bench.plant.model import AxisParameters
from bench.rig.circuit import COLD, HOT, Circuit
from bench.rig.limits import peak_curve
from bench.rig.motor import PeakCurve
from bench.rig.rig import Rig

KEY, TITLE = "11", "Why the measured corner lies higher"

#: Electrical time constants that the split is shown for - s.
TIME_CONSTANTS = (1e-3, 2e-3, 3e-3, 5e-3, 8e-3)
#: The run-up lasts as many times J*omega_0/M_max.
LENGTH = 5.0
#: Of the drive, torque asked for per missing speed - N*m*s/rad.
VELOCITY_GAIN = 0.9
#: Shares of the peak torque at which speeds with and without inductance are compared.
SHARES = (0.98, 0.9, 0.7, 0.5)


@dataclass(frozen=True)
class Split:
    """What each simulation has for a corner - rad/s - and for a fall.

    Attributes:
        hot: winding at 120 degC, quasi-static.
        cold: at 20 degC, quasi-static.
        inductive: at 20 degC with the assumed inductance.
        by_time_constant: L/R - s, corner - rad/s, and corner of the line through the fall - rad/s - at 20 degC.
        cold_line: the last of these without inductance - rad/s.
        runs: hot, cold and inductive.
        acceleration: at full torque - rad/s**2.
    """

    hot: float
    cold: float
    inductive: float
    by_time_constant: tuple[tuple[float, float, float], ...]
    cold_line: float
    runs: tuple[WindingRun, WindingRun, WindingRun]
    acceleration: float


def saturation(run: WindingRun, limit: float) -> float:
    """Speed from which on full voltage no longer drives peak current - rad/s.

    Args:
        run: of a simulated winding, without noise.
        limit: U_max - V.
    """
    started = int(np.argmax(run.current > 0.999 * run.current.max()))
    return float(run.velocity[started + int(np.argmax(run.voltage[started:] >= limit * (1.0 - 1e-9)))])


def split(
    rig: Rig, mains: float, axis: AxisParameters, progress: Callable[[float], None] = lambda share: None
) -> Split:
    """Simulate the run-up hot, then cold, then cold with L, and with other values of L/R.

    Args:
        rig: its motor.
        mains: voltage - V.
        axis: inertia and friction that the motor runs up.
        progress: called with the share done.
    """
    circuit = Circuit.from_motor(rig.motor, peak_curve(rig.motor, mains, rig.source), rig.source)
    limit, constant = peak_current(rig), torque_constant(rig)
    full = float(constant.torque(np.asarray(limit)))
    top = circuit.voltage / circuit.back_emf_constant
    demand = np.full(round(LENGTH * axis.inertia * top / full / STEP), top)
    others = [replace(circuit, time_constant=tau) for tau in TIME_CONSTANTS]
    windings = [Winding(circuit, constant, limit, HOT, False), Winding(circuit, constant, limit, COLD, False)]
    windings += [Winding(other, constant, limit, COLD, True) for other in (circuit, *others)]
    runs = []
    for k, winding in enumerate(windings):
        runs.append(run_winding(winding, axis, demand, VELOCITY_GAIN))
        progress((k + 1) / len(windings))
    corners = [saturation(run, circuit.voltage) for run in runs]
    lines = [extrapolated_corner(run.velocity, run.current) for run in runs]
    acceleration = (full - axis.coulomb_friction) / axis.inertia
    dependence = tuple(zip(TIME_CONSTANTS, corners[3:], lines[3:], strict=True))
    return Split(corners[0], corners[1], corners[2], dependence, lines[1], (runs[0], runs[1], runs[2]), acceleration)


def speed_at(run: WindingRun, share: float) -> float:
    """Speed at which the falling torque passes a share of its top - rad/s."""
    top = float(run.torque.max())
    last = int(np.flatnonzero(run.torque > 0.999 * top)[-1])
    torque = run.torque[last:]
    passed = int(np.argmax(torque < share * top))
    return float(run.velocity[last + passed])


def peak_current(rig: Rig) -> float:
    """Imax - A.

    Raises:
        InputError: the rig does not give it.
    """
    if rig.motor.peak_current is None:
        raise InputError(f"{rig.source}: motor.peak_current", "missing", "the run-up is limited by it")
    return rig.motor.peak_current


def task(
    rig: Rig,
    sources: Sources,
    axis: AxisParameters,
    mains: float = 230.0,
    measured: Decline | None = None,
    synthetic: bool = False,
    progress: Callable[[float], None] = lambda share: None,
) -> Task:
    """State how many rpm of the corner's shift each of the two causes is, and what inductance does instead.

    Args:
        rig: its motor.
        sources: of its values.
        axis: inertia and friction that the motor runs up.
        mains: voltage - V.
        measured: of task 10, if that could be done.
        synthetic: whether that recording was made by the same equations.
        progress: called with the share done.
    """
    found = split(rig, mains, axis, progress)
    sheet = peak_curve(rig.motor, mains, rig.source).corner_speed
    by_temperature, by_inductance = (found.cold - found.hot) * RPM, (found.inductive - found.cold) * RPM
    assumed = sources("motor", "electrical_time_constant")
    findings = [
        "The corner is the speed at which the torque starts to decline, as full voltage no longer drives peak current: "
        "U = R·Imax + Ke·ω. The current is still constant there, dIq/dt = 0, so no inductance can move it.",
        f"Simulated, it lies at {found.hot * RPM:.0f} rpm hot, at {found.cold * RPM:.0f} rpm cold and at "
        f"{found.inductive * RPM:.0f} rpm cold with inductance (L/R, {assumed}): the cold winding moves it by "
        f"{by_temperature:+.0f} rpm, as it takes less voltage and leaves more to the back-EMF, the inductance by "
        f"{by_inductance:+.1f} rpm, and for L/R from 1 to 8 ms alike.",
        _fall_finding(found),
        f"The winding warms by {found.runs[0].warming:.1f} K (hot) and {found.runs[1].warming:.1f} K (cold) during "
        f"the run-up, which keeps the hot corner {(found.hot - sheet) * RPM:+.0f} rpm from the datasheet's "
        f"{sheet * RPM:.0f} rpm.",
        _voltage_finding(rig, mains),
    ]
    if measured is not None:
        findings.insert(3, _measured_finding(measured, found, synthetic))
    charts = (_torque_chart(rig, mains, found), _dependence_chart(found))
    return Task(KEY, TITLE, tuple(findings), _numbers(found, joined(SIMULATED, f"L/R: {assumed}")), charts)


def _numbers(found: Split, with_inductance: str) -> tuple[Number, ...]:
    _, cold, inductive = found.runs
    return (
        Number("corner, hot, quasi-static", found.hot * RPM, "rpm", source=SIMULATED),
        Number("corner, cold, quasi-static", found.cold * RPM, "rpm", source=SIMULATED),
        Number("corner, cold, with inductance", found.inductive * RPM, "rpm", source=with_inductance),
        Number("shift by temperature", (found.cold - found.hot) * RPM, "rpm", source=SIMULATED),
        Number("shift by inductance", (found.inductive - found.cold) * RPM, "rpm", source=with_inductance),
        *(
            Number(
                f"with inductance faster at {share:.0%} of the torque by",
                (speed_at(inductive, share) - speed_at(cold, share)) * RPM,
                "rpm",
                source=with_inductance,
            )
            for share in SHARES
        ),
        *(
            Number(f"corner, L/R = {tau * 1e3:g} ms", corner * RPM, "rpm", source=SIMULATED)
            for tau, corner, _ in found.by_time_constant
        ),
        *(
            Number(f"fall later by, L/R = {tau * 1e3:g} ms", (line - found.cold_line) * RPM, "rpm", source=SIMULATED)
            for tau, _, line in found.by_time_constant
        ),
    )


def _fall_finding(found: Split) -> str:
    _, cold, inductive = found.runs
    faster = [f"{(speed_at(inductive, s) - speed_at(cold, s)) * RPM:.0f} rpm at {s:.0%}" for s in SHARES]
    return (
        "What inductance does is to flatten the fall: beyond the corner it keeps the current up for about L/R, "
        "in which "
        f"speed rises by α·L/R. The same torque is there at a higher speed, by {', '.join(faster)} of the "
        "peak. Whoever "
        "reads the corner from the line through the fall, or at a few percent below the peak, counts this as a shift."
    )


def _measured_finding(measured: Decline, found: Split, synthetic: bool) -> str:
    text = (
        f"Measured in task 10: {measured.corner * RPM:.0f} rpm, "
        f"{(measured.corner - found.inductive) * RPM:+.1f} rpm from "
        f"the simulation, and a fall that comes {measured.lag * 1e3:.1f} ms late (L/R as it acts)."
    )
    if synthetic:
        text += (
            " This recording was made by the same equations: that they agree shows that corner and lag can be "
            "read from "
            "noisy samples at 1 ms, and nothing about a motor."
        )
    return text


def _voltage_finding(rig: Rig, mains: float) -> str:
    """What the circuit leaves out, told by the curve at another voltage."""
    others = [curve for curve in rig.motor.peak_curves if curve.mains_voltage != mains]
    if not others:
        return "The datasheet has one mains voltage only, so what the circuit leaves out does not show."
    other = others[0]
    circuit = Circuit.from_motor(rig.motor, peak_curve(rig.motor, mains, rig.source), rig.source)
    drop = circuit.resistance * peak_current(rig)
    shift, time_constant = cross_voltage(circuit, peak_curve(rig.motor, mains, rig.source), other)
    predicted = (circuit.voltage * other.mains_voltage / mains - drop) / circuit.back_emf_constant
    return (
        f"At {other.mains_voltage:g} V the same circuit has its corner at {predicted * RPM:.0f} rpm, the datasheet at "
        f"{other.corner_speed * RPM:.0f} rpm: the course's equation leaves out the voltage ω·p·L·Iq at a right angle "
        "to the back-EMF, which grows with speed. So part of what it counts as resistance is inductance. With both "
        "curves of the datasheet met by U² = (R·Iq + Ke·ω)² + (ω·p·L·Iq)², the cold winding shifts the corner by "
        f"{shift * RPM:.0f} rpm only, and L/R at {COLD:g} °C is {time_constant * 1e3:.3g} ms over the number of pole "
        f"pairs: the assumed {circuit.time_constant * 1e3:g} ms are of the right size."
    )


def cross_voltage(circuit: Circuit, low: PeakCurve, high: PeakCurve) -> tuple[float, float]:
    """What two peak curves say of a circuit with the voltage at a right angle, U**2 = (R*I + Ke*w)**2 + (w*p*L*I)**2.

    Taking (w_2/w_1)**2 times the equation at corner 1 from that at corner 2 leaves a quadratic in R*I.

    Args:
        circuit: at the mains voltage of `low`.
        low, high: curves at two mains voltages.

    Returns:
        Shift of the corner of `low` from hot to cold - rad/s, and p*L/R cold - s; the current cancels out.

    Raises:
        InputError: no such circuit meets both curves.
    """
    ke, voltage, one, two = circuit.back_emf_constant, circuit.voltage, low.corner_speed, high.corner_speed
    q, ratio = (two / one) ** 2, high.mains_voltage / low.mains_voltage
    drop = _positive_root(q - 1.0, 2.0 * ke * (q * one - two), voltage**2 * (ratio**2 - q))
    across = (voltage**2 - (drop + ke * one) ** 2) / one**2
    if not across > 0.0:
        raise InputError("motor.peak_curves", "found two curves that no circuit meets", "give the datasheet's corners")
    cold = drop * circuit.cold_share
    corner = _positive_root(ke**2 + across, 2.0 * ke * cold, cold**2 - voltage**2)
    return corner - one, float(np.sqrt(across)) / cold


def _positive_root(a: float, b: float, c: float) -> float:
    """Of a*x**2 + b*x + c with a > 0 > c."""
    return float((-b + np.sqrt(b**2 - 4.0 * a * c)) / (2.0 * a))


def _torque_chart(rig: Rig, mains: float, found: Split) -> Chart:
    speed, torque = datasheet_curve(rig, mains)
    names = (f"{HOT:g} °C, quasi-static", f"{COLD:g} °C, quasi-static", f"{COLD:g} °C, with inductance")
    every = slice(None, None, 40)
    curves = [Curve(speed * RPM, torque, f"datasheet, {mains:g} V", "dashes")]
    curves += [
        Curve(run.velocity[every] * RPM, run.torque[every], name) for run, name in zip(found.runs, names, strict=True)
    ]
    return Chart("Task 11: simulated peak torque", (Panel("speed n / rpm", "torque M / (N·m)", tuple(curves)),))


def _dependence_chart(found: Split) -> Chart:
    tau = np.array([tau for tau, _, _ in found.by_time_constant])
    corner = np.array([corner - found.cold for _, corner, _ in found.by_time_constant])
    line = np.array([line - found.cold_line for _, _, line in found.by_time_constant])
    full = np.append(0.0, tau) * found.acceleration
    curves = (
        Curve(tau * 1e3, corner * RPM, "corner", "bold dots"),
        Curve(tau * 1e3, line * RPM, "line through the fall", "bold dots"),
        Curve(np.append(0.0, tau) * 1e3, full * RPM, "α·L/R at full torque", "dashes"),
    )
    panel = Panel("electrical time constant L/R / ms", "shift by inductance / rpm", curves)
    return Chart("Task 11: inductance moves the fall, not the corner", (panel,))
