"""Motor of the axis: what turns the recorded current, voltage or relative torque into torque; and the motor catalogue.

Its torque constant kT(Iq) falls as the iron saturates: `M = kT(Iq)*Iq`. Its peak curves are peak torque over speed as a
datasheet draws them. The catalogue is one TOML file a motor in `data/motors/`, every value with its source.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from bench.arrays import Array
from bench.assets import asset
from bench.errors import InputError
from bench.names import nearest
from bench.rig import values
from bench.rig.values import RigTable, times, tolerance_of
from bench.structured import read_toml

#: Of constants whose tolerance is not stated, as datasheets have it.
USUAL_TOLERANCE = 0.1
#: kT over Ke in one unit: with the values of an equivalent DC machine, of one phase, between lines.
CONVENTIONS = (1.0, 1.5, math.sqrt(3.0))
#: Values for peak currents over those for effective ones, by which a datasheet may state them.
PEAK_FACTORS: dict[str, float] = {
    **dict.fromkeys(("torque_constant", "force_constant"), 1.0 / math.sqrt(2.0)),
    **dict.fromkeys(("continuous_stall_current", "peak_current"), math.sqrt(2.0)),
}
DATASHEET = ("continuous_stall_torque", "continuous_stall_current", "peak_torque", "peak_current")


@dataclass(frozen=True)
class TorqueConstant:
    """kT(I) = a*I**2 + c, an even function of current because a motor is as strong one way as the other.

    The course writes kT(Iq) = a*Iq**2 + b*Iq + c; zero slope at zero current makes b = 0.

    Attributes:
        constant: c, torque per ampere at zero current - N*m/A (N/A on a linear axis).
        curvature: a, zero or negative - N*m/A**3 (N/A**3).
    """

    constant: float
    curvature: float = 0.0

    @classmethod
    def from_datasheet(cls, stall_torque: float, stall_current: float, peak_torque: float, peak_current: float) -> Self:
        """kT from the stall point (M0 - N*m, I0 - A) and the peak point (Mmax, Imax): c + a*I**2 = M/I at both."""
        stall, peak = stall_torque / stall_current, peak_torque / peak_current
        curvature = (peak - stall) / (peak_current**2 - stall_current**2)
        return cls(stall - curvature * stall_current**2, curvature)

    def __call__(self, current: Array) -> Array:
        """Torque per ampere at a current - A, any shape."""
        return self.constant + self.curvature * current**2

    def torque(self, current: Array) -> Array:
        """Motor torque at a current - A, any shape."""
        return self(current) * current

    def current(self, torque: Array) -> Array:
        """Current that gives a torque - N*m, any shape; the inverse of `torque` below its maximum.

        Solves a*I**3 + c*I = M on the branch through zero (trigonometric solution of the depressed cubic,
        Abramowitz & Stegun 3.8.2). Torque beyond the maximum gives the current of the maximum.
        """
        if self.curvature == 0.0:
            return np.asarray(torque) / self.constant
        p = -self.constant / self.curvature
        q = np.asarray(torque) / self.curvature
        peak = 2.0 * np.sqrt(p / 3.0)
        return peak * np.sin(np.arcsin(np.clip(-3.0 * q / (p * peak), -1.0, 1.0)) / 3.0)


class PeakCurve(RigTable):
    """Peak torque is limited by the magnets up to the corner, and by voltage beyond it, where it falls to zero.

    Attributes:
        mains_voltage: line to line, RMS - V.
        corner_speed: up to which peak torque is available - rad/s (m/s).
        no_load_speed: at which the back-EMF takes all the voltage and torque is zero - rad/s (m/s).
    """

    mains_voltage: values.Voltage
    corner_speed: values.Speed
    no_load_speed: values.Speed

    @model_validator(mode="after")
    def _falls(self) -> PeakCurve:
        if self.corner_speed >= self.no_load_speed:
            raise ValueError("corner_speed must be below no_load_speed")
        return self

    def share(self, speed: Array) -> Array:
        """Share of peak torque available at speeds - rad/s (m/s), any shape: 1 to the corner, then linearly to 0."""
        falling = (self.no_load_speed - np.abs(speed)) / (self.no_load_speed - self.corner_speed)
        return np.clip(falling, 0.0, 1.0)


class Motor(RigTable):
    """Rotary or linear motor; all values optional, as a recording of torque needs none of them.

    Attributes:
        model: name it carries in the motor catalogue.
        current: which current the motor's values are stated for, `peak` or `effective`; kept are those for the peak.
        rotor_inertia: of the rotor alone - kg*m**2; on a linear axis `moving_mass` - kg.
        torque_constant: constant torque per ampere - N*m/A; or the four datasheet values, from which kT(Iq) follows;
            on a linear axis `force_constant` - N/A.
        torque_per_volt, force_per_volt: gain of a torque-controlled amplifier from its set-point voltage - N*m/V, N/V.
        rated_torque: what 100 % of a relative torque means - N*m; on a linear axis `rated_force` - N.
        resistance, inductance, back_emf_constant: winding - ohm, H, V*s/rad (V*s/m).
        temperature: of the winding of `resistance` - K.
        peak_curves: peak torque over speed, one for each mains voltage.
        continuous_torque_loss: share of continuous torque that speed-dependent losses take up to the lowest curve's
            no-load speed.
        cold_resistance_share: winding resistance at 20 degC over that at 120 degC.
        electrical_time_constant: L/R of the winding at 20 degC - s; thermal_time_constant: of its temperature - s.
    """

    model: str | None = None
    current: Literal["peak", "effective"] = "peak"
    rotor_inertia: values.Inertia | None = None
    moving_mass: values.Mass | None = None
    torque_constant: values.TorquePerAmpere | None = None
    force_constant: values.ForcePerAmpere | None = None
    continuous_stall_torque: values.Torque | None = None
    continuous_stall_current: values.Current | None = None
    peak_torque: values.Torque | None = None
    peak_current: values.Current | None = None
    torque_per_volt: values.TorquePerVolt | None = None
    force_per_volt: values.ForcePerVolt | None = None
    rated_torque: values.Torque | None = None
    rated_force: values.Force | None = None
    rated_speed: values.Speed | None = None
    maximum_speed: values.Speed | None = None
    resistance: values.Resistance | None = None
    inductance: values.Inductance | None = None
    back_emf_constant: values.BackEmf | None = None
    supply_voltage: values.Voltage | None = None
    temperature: values.Temperature | None = None
    peak_curves: tuple[PeakCurve, ...] = ()
    continuous_torque_loss: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    cold_resistance_share: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    electrical_time_constant: values.Time | None = None
    thermal_time_constant: values.Time | None = None

    @model_validator(mode="after")
    def _datasheet_is_consistent(self) -> Motor:
        if self.continuous_stall_torque is not None:
            missing = [name for name in DATASHEET if getattr(self, name) is None]
            if missing:
                raise ValueError(f"kT(Iq) takes the four datasheet values; missing {', '.join(missing)}")
            stall, i0, peak, imax = (getattr(self, name) for name in DATASHEET)
            if imax <= i0:
                raise ValueError("peak_current must exceed continuous_stall_current")
            if peak / imax > stall / i0:
                raise ValueError("torque per ampere must not rise from stall to peak")
            if 3.0 * (peak / imax - stall / i0) / (imax**2 - i0**2) * imax**2 + stall / i0 <= 0.0:
                raise ValueError("torque must still rise with current at peak_current")
        return self

    @model_validator(mode="after")
    def _as_peak_values(self) -> Motor:
        if self.current == "peak":
            return self
        stated = {name: getattr(self, name) for name in PEAK_FACTORS}
        converted = {name: times(value, PEAK_FACTORS[name]) for name, value in stated.items() if value is not None}
        return self.model_copy(update={**converted, "current": "peak"})

    @property
    def inertia(self) -> float:
        """Of what moves in the motor - kg*m**2 (kg); 0 when the rig has none."""
        return self.rotor_inertia or self.moving_mass or 0.0

    @property
    def of_back_emf(self) -> float | None:
        """The torque constant that the back-EMF constant asks for - N*m/A (N/A) -, where the two disagree; else None.

        A motor gives as power what it takes as electricity, kT*w*I = Ke*w*I; 3/2 and sqrt(3) times that where Ke is of
        one phase or between lines, in effective values. Of these the nearest counts.
        """
        constant, back_emf = self.torque_per_ampere, self.back_emf_constant
        if constant is None or back_emf is None:
            return None
        stated = tolerance_of(self.torque_constant or self.force_constant) / constant.constant
        stated = math.hypot(stated, tolerance_of(back_emf) / back_emf) or USUAL_TOLERANCE
        asked = min((share * back_emf for share in CONVENTIONS), key=lambda one: abs(constant.constant / one - 1.0))
        return None if abs(constant.constant / asked - 1.0) <= stated else asked

    @property
    def disagreement(self) -> str | None:
        """That torque constant and back-EMF constant are not those of one motor; None where they may be."""
        if self.of_back_emf is None or self.torque_per_ampere is None:
            return None
        return (
            f"torque constant ({self.torque_per_ampere.constant:.4g}) and back-EMF constant "
            f"({self.back_emf_constant:.4g}) disagree: by the second the first would be {self.of_back_emf:.4g}; "
            "intervals reach as far"
        )

    @property
    def torque_per_ampere(self) -> TorqueConstant | None:
        """kT(Iq) - N*m/A (N/A on a linear axis); None when the rig has none."""
        constant = self.torque_constant or self.force_constant
        if constant is not None:
            return TorqueConstant(constant)
        if self.continuous_stall_torque is None:
            return None
        return TorqueConstant.from_datasheet(*(getattr(self, name) for name in DATASHEET))


def motor_names() -> list[str]:
    """Names of the motors in the catalogue."""
    return sorted(path.stem for path in asset("data", "motors").glob("*.toml"))


def motor_sources(name: str) -> dict[str, tuple[Any, str]]:
    """Value (with unit) and source of every quantity known about a motor; name must be in the catalogue."""
    entry = read_toml(asset("data", "motors", f"{name}.toml"), "a motor")
    return {key: (item["value"], item["source"]) for key, item in entry.items()}


def catalogue_motor(name: object, where: str) -> dict[str, Any]:
    """Motor table of a catalogue entry, as it would stand in a rig file; InputError if there is none of this name."""
    names = motor_names()
    if not isinstance(name, str) or name not in names:
        found = f"no motor {name!r} in the catalogue{nearest(str(name), names)}"
        raise InputError(where, found, f"allowed: {', '.join(names)}")
    return {key: value for key, (value, _) in motor_sources(name).items()}
