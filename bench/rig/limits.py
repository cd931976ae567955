"""Operating range of a motor: its torque at a speed, peak and continuous, and the reserve of a motion.

Its circuit follows from nothing but its peak curve:

    U = R(T)*Iq + L*dIq/dt + Ke*omega,    |U| <= U_max

The curve determines two of its constants: at the no-load speed the back-EMF takes all the voltage, Ke = U_max/omega_0,
and at the corner the full voltage still drives peak current through the hot winding, R = (U_max - Ke*omega_c)/I_max.

U_max = sqrt(3)*mains is the voltage of all three phases, each with mains/sqrt(3) at most, in series with the drive's
RMS current: power 3*U_phase*I = U*I and torque Ke*I then balance, so Ke is the torque constant of the unsaturated motor
as well. The voltage that current across the phases induces (omega*L_phase*p*Iq at a right angle) is left out, as the
course does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import Array, rms
from bench.errors import InputError
from bench.rig.motor import Motor, PeakCurve, TorqueConstant

#: Torque this share of the peak torque beyond a limit is still at it: noise of current and speed.
AT_LIMIT = 0.01
#: Winding temperatures of the datasheet's curve and of a cold motor - degC.
HOT, COLD = 120.0, 20.0
#: Of a motor, what its circuit follows from in addition to the peak curve.
OF_CIRCUIT = ("peak_current", "continuous_stall_current", "cold_resistance_share")
OF_CIRCUIT += ("electrical_time_constant", "thermal_time_constant")


@dataclass(frozen=True)
class Circuit:
    """Constants of the circuit.

    Attributes:
        voltage: U_max - V.
        back_emf_constant: Ke - V*s/rad.
        resistance: R at HOT - ohm.
        cold_share: R at COLD over R at HOT.
        time_constant: L/R at COLD - s.
        thermal_resistance: winding to surroundings - K/W; continuous stall current heats from COLD to HOT through it.
        thermal_time_constant: of the winding - s.
    """

    voltage: float
    back_emf_constant: float
    resistance: float
    cold_share: float
    time_constant: float
    thermal_resistance: float
    thermal_time_constant: float

    @classmethod
    def from_motor(cls, motor: Motor, curve: PeakCurve, where: str) -> Circuit:
        """Circuit of a motor at the mains voltage of one of its curves; InputError where a value is missing."""
        missing = [name for name in OF_CIRCUIT if getattr(motor, name) is None]
        if missing:
            raise InputError(f"{where}: motor", f"missing {', '.join(missing)}", "the winding's circuit needs them")
        peak, stall, share, electrical, thermal = (getattr(motor, name) for name in OF_CIRCUIT)
        voltage = math.sqrt(3.0) * curve.mains_voltage
        back_emf = voltage / curve.no_load_speed
        resistance = (voltage - back_emf * curve.corner_speed) / peak
        heating = (HOT - COLD) / (resistance * stall**2)
        return cls(voltage, back_emf, resistance, share, electrical, heating, thermal)

    @property
    def temperature_coefficient(self) -> float:
        """Of the resistance, about HOT - 1/K."""
        return (1.0 - self.cold_share) / (HOT - COLD)

    @property
    def inductance(self) -> float:
        """L - H."""
        return self.time_constant * self.cold_share * self.resistance

    def resistance_at(self, temperature: float) -> float:
        """R at a winding temperature - degC - in ohm."""
        return self.resistance * (1.0 + self.temperature_coefficient * (temperature - HOT))


@dataclass(frozen=True)
class OperatingRange:
    """Limits of a motor at one mains voltage.

    Attributes:
        peak_torque: limited by the magnets, Mmax - N*m.
        continuous_torque: limited by heat, at standstill, M0 - N*m.
        curve: share of peak torque that voltage allows at a speed.
        loss: share of continuous torque that speed-dependent losses take up to the no-load speed.
        torque_constant: kT(Iq), which turns torque into the current that heats.
    """

    peak_torque: float
    continuous_torque: float
    curve: PeakCurve
    loss: float
    torque_constant: TorqueConstant

    @classmethod
    def of(cls, motor: Motor, mains: float, where: str) -> OperatingRange:
        """Range of a motor at a mains voltage - V; InputError where its torques or a curve for it are missing."""
        if motor.peak_torque is None or motor.continuous_stall_torque is None:
            missing = "peak_torque" if motor.peak_torque is None else "continuous_stall_torque"
            raise InputError(f"{where}: motor.{missing}", "missing", "the operating range needs it")
        constant = motor.torque_per_ampere
        assert constant is not None, "a motor with a continuous stall torque has all four values of its datasheet"
        return cls(
            motor.peak_torque,
            motor.continuous_stall_torque,
            peak_curve(motor, mains, where),
            motor.continuous_torque_loss,
            constant,
        )

    def cold(self, motor: Motor, where: str) -> OperatingRange:
        """The same motor with its winding at COLD: less voltage goes into its resistance, so the corner lies higher."""
        circuit = Circuit.from_motor(motor, self.curve, where)
        drop = circuit.resistance_at(COLD) * (motor.peak_current or 0.0)
        corner = (circuit.voltage - drop) / circuit.back_emf_constant
        return replace(self, curve=self.curve.model_copy(update={"corner_speed": corner}))

    def peak(self, speed: Array) -> Array:
        """Peak torque at speeds - rad/s, any shape - while the motor drives - N*m."""
        return self.peak_torque * self.curve.share(speed)

    def available(self, speed: Array, torque: Array) -> Array:
        """Peak torque in the direction of a torque - N*m: voltage limits driving only; braking, the back-EMF helps."""
        return np.where(speed * torque >= 0.0, self.peak(speed), self.peak_torque)

    def continuous(self, speed: Array) -> Array:
        """Continuous torque at speeds - N*m: M0 less losses that grow in proportion to speed, never above the peak."""
        heated = self.continuous_torque * (1.0 - self.loss * np.abs(speed) / self.curve.no_load_speed)
        return np.minimum(np.maximum(heated, 0.0), self.peak(speed))


@dataclass(frozen=True)
class Reserve:
    """The reserve of a motion in the range.

    Attributes:
        peak: least distance of the torque to its limit over the motion - N*m; negative beyond it.
        peak_share: the same as a share of the peak torque.
        at: index of the sample where it is least.
        beyond: share of the samples beyond the limit by more than AT_LIMIT.
        rms_torque: sqrt(mean(M**2)) - N*m.
        rms_current: sqrt(mean(Iq**2)), which heats the winding - A; more than by the RMS torque where iron saturates.
        mean_speed: mean(|omega|), at which it is compared - rad/s.
        continuous_current: that gives the continuous torque there - A.
        thermal: continuous less RMS current - A; negative where the motor would overheat.
        thermal_share: the same as a share of the continuous current there.
    """

    peak: float
    peak_share: float
    at: int
    beyond: float
    rms_torque: float
    rms_current: float
    mean_speed: float
    continuous_current: float
    thermal: float
    thermal_share: float


def reserve(limits: OperatingRange, speed: Array, torque: Array) -> Reserve:
    """Reserve of a motion that repeats itself, speed - rad/s, torque - N*m, (n,) each."""
    left = limits.available(speed, torque) - np.abs(torque)
    at = int(np.argmin(left))
    effective, mean = rms(limits.torque_constant.current(torque)), float(np.mean(np.abs(speed)))
    allowed = float(limits.torque_constant.current(limits.continuous(np.asarray(mean))))
    return Reserve(
        peak=float(left[at]),
        peak_share=float(left[at]) / limits.peak_torque,
        at=at,
        beyond=float(np.mean(left < -AT_LIMIT * limits.peak_torque)),
        rms_torque=rms(torque),
        rms_current=effective,
        mean_speed=mean,
        continuous_current=allowed,
        thermal=allowed - effective,
        thermal_share=(allowed - effective) / allowed if allowed > 0.0 else -1.0,
    )


def peak_curve(motor: Motor, mains: float, where: str) -> PeakCurve:
    """The motor's peak curve at a mains voltage - V; InputError naming `where` if it has none for it."""
    for curve in motor.peak_curves:
        if abs(curve.mains_voltage / mains - 1.0) < 1e-6:
            return curve
    known = ", ".join(f"{curve.mains_voltage:g} V" for curve in motor.peak_curves) or "none"
    raise InputError(f"{where}: motor.peak_curves", f"found none for {mains:g} V", f"given are: {known}")
