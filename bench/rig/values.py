"""Physical values in rig files: strings with a unit, checked and turned into SI while the file is read."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo
from pydantic_core import PydanticCustomError

from bench.errors import InputError
from bench.units import parse


class Table(BaseModel):
    """A table of a rig file: frozen, and an unknown key in it is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def si(rotary: str, linear: str | None = None) -> BeforeValidator:
    """Validator that turns `"22.4 kg*cm**2"` into a number in the SI unit, which a linear axis may have of its own.

    The kind of axis comes as `linear` in the validation context.
    """

    def read(text: object, info: ValidationInfo) -> float:
        on_linear_axis = info.context is not None and info.context["linear"]
        try:
            return parse(text, linear if linear and on_linear_axis else rotary, "")
        except InputError as error:
            raise PydanticCustomError("unit", "{found}; {allowed}", vars(error)) from error

    return BeforeValidator(read)


_positive, _not_negative = Field(gt=0.0), Field(ge=0.0)

Inertia = Annotated[float, si("kg*m**2"), _positive]
Mass = Annotated[float, si("kg"), _positive]
Length = Annotated[float, si("m"), _positive]
Density = Annotated[float, si("kg/m**3"), _positive]
Time = Annotated[float, si("s"), _positive]
Angle = Annotated[float, si("rad")]
Rate = Annotated[float, si("1/s"), _not_negative]
Current = Annotated[float, si("A"), _positive]
Voltage = Annotated[float, si("V"), _positive]
Resistance = Annotated[float, si("ohm"), _positive]
Inductance = Annotated[float, si("H"), _positive]
BackEmf = Annotated[float, si("V*s/rad", "V*s/m"), _positive]
Torque = Annotated[float, si("N*m"), _positive]
Force = Annotated[float, si("N"), _positive]
TorquePerAmpere = Annotated[float, si("N*m/A"), _positive]
ForcePerAmpere = Annotated[float, si("N/A"), _positive]
TorquePerVolt = Annotated[float, si("N*m/V"), _positive]
ForcePerVolt = Annotated[float, si("N/V"), _positive]
Speed = Annotated[float, si("rad/s", "m/s"), _positive]
VelocityNoise = Annotated[float, si("rad/s", "m/s"), _not_negative]
CurrentNoise = Annotated[float, si("A"), _not_negative]
Resolution = Annotated[float, si("rad", "m"), _not_negative]
Viscous = Annotated[float, si("N*m*s/rad", "N*s/m"), _not_negative]
Coulomb = Annotated[float, si("N*m", "N"), _not_negative]
Effort = Annotated[float, si("N*m", "N")]
IntegralGain = Annotated[float, si("N*m/rad", "N/m"), _not_negative]
Feedforward = Annotated[float, si("kg*m**2", "kg"), _not_negative]
Temperature = Annotated[float, si("K")]
