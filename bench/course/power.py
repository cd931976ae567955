"""Where the power of a run-up goes, and circuits that meet the datasheet's peak curves at both mains voltages.

U**2 = (R*I + Ke*w)**2 + (w*p*L*I)**2  at both corners gives R and p*L, for Ke constant or Ke = kT(Iq).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bench.arrays import Array
from bench.course.axis import MAINS, circuit, motor_value, torque_constant
from bench.course.peak_torque import POINTS
from bench.course.winding import STEP, WindingModel, WindingRun
from bench.errors import InputError
from bench.plant.axis_model import AxisParameters
from bench.rig.limits import peak_curve
from bench.rig.motor import PeakCurve, TorqueConstant
from bench.rig.rig import Rig

COURSES, BALANCED = "Ke constant, as the course's", "Ke = kT(Iq)"


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

    The last again, with the voltage that the datasheet's no-load speed asks of it, 4.6 % more in the lab's motor. Each
    meets the curve of the rig's motor at MAINS, those with the voltage across the `other` one, too.

    Raises InputError where the rig lacks something, or no such circuit meets both curves.
    """
    motor, low, peak = circuit(rig), peak_curve(rig.motor, MAINS, rig.source), motor_value(rig, "peak_current")
    idle, saturated = (float(torque_constant(rig)(np.asarray(current))) for current in (0.0, peak))
    course, balanced = (COURSES, motor.back_emf_constant, motor.back_emf_constant), (BALANCED, saturated, idle)
    usual, values = motor.voltage, []
    cases = [(one, usual, crossed) for one in (course, balanced) for crossed in (False, True)]
    for (name, ke, of_none), given, crossed in (*cases, (balanced, idle * low.no_load_speed, True)):
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


def _positive_root(a: Any, b: Any, c: Any) -> Any:  # noqa: ANN401, numbers or arrays
    """Of a*x**2 + b*x + c with a > 0 > c."""
    return (-b + np.sqrt(b**2 - 4.0 * a * c)) / (2.0 * a)


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


def speed_of_current(one: CircuitValues, peak: float, constant: TorqueConstant, voltages: float) -> tuple[Array, Array]:
    """Highest speed - rad/s - at which a hot circuit drives a current - A -, (POINTS,), from peak current to none.

    Args:
        one: circuit; where its power balances, Ke is kT of the current.
        peak: current that its drop and voltage across are of - A.
        constant: kT(Iq).
        voltages: so many times the voltage at MAINS.
    """
    current = np.linspace(peak, 0.0, POINTS)
    ke = constant(current) if one.name.startswith(BALANCED) else one.ke
    drop, across = one.drop * current / peak, one.across * current / peak
    return _positive_root(ke**2 + across**2, 2.0 * ke * drop, drop**2 - (voltages * one.voltage) ** 2), current
