"""Equivalent circuit of a synchronous motor, from nothing but its peak curve.

    U = R(T)*Iq + L*dIq/dt + Ke*omega,    |U| <= U_max

The curve tells two of its constants: at the no-load speed the back-EMF takes all the voltage, Ke = U_max/omega_0, and
at the corner the full voltage still drives peak current through the hot winding, R = (U_max - Ke*omega_c)/I_max.

U_max = sqrt(3)*mains is the voltage of all three phases, each with mains/sqrt(3) at most, in series with the drive's
RMS current: power 3*U_phase*I = U*I and torque Ke*I then balance, so Ke is the torque constant of the unsaturated motor
as well. The voltage that current across the phases induces (omega*L_phase*p*Iq at a right angle) is left out, as the
course does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from bench.errors import InputError
from bench.rig.motor import Motor, PeakCurve

#: Winding temperatures of the datasheet's curve and of a cold motor - degC.
HOT, COLD = 120.0, 20.0


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
        """Circuit of a motor at the mains voltage of one of its curves.

        Raises:
            InputError: a value missing; names `where`.
        """
        peak, stall = motor.peak_current, motor.continuous_stall_current
        share, electrical, thermal = (
            motor.cold_resistance_share,
            motor.electrical_time_constant,
            motor.thermal_time_constant,
        )
        if peak is None or stall is None or share is None or electrical is None or thermal is None:
            names = ("peak_current", "continuous_stall_current", "cold_resistance_share")
            names += ("electrical_time_constant", "thermal_time_constant")
            missing = [name for name in names if getattr(motor, name) is None]
            raise InputError(f"{where}: motor", f"missing {', '.join(missing)}", "the winding's circuit needs them")
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
