"""Physical values in rig files: strings with a unit, checked and turned into SI while the file is read."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo
from pydantic_core import PydanticCustomError

from bench.axis_kind import ROTARY, AxisKind
from bench.errors import InputError
from bench.units import parse


class Table(BaseModel):
    """A table of a rig file: frozen, and an unknown key in it is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def si(unit: str, translated: bool = False) -> BeforeValidator:
    """Validator that turns `"22.4 kg*cm**2"` into a number in an SI unit.

    Args:
        unit: of the value on a rotary axis.
        translated: whether a linear axis has the value in metres and newtons; the kind of axis comes as `kind` in the
            validation context.
    """

    def read(text: object, info: ValidationInfo) -> float:
        kind: AxisKind = ROTARY if info.context is None or not translated else info.context["kind"]
        try:
            return parse(text, kind.translated(unit), "")
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
Period = Annotated[float, si("rad", translated=True), _positive]
Rate = Annotated[float, si("1/s"), _not_negative]
Current = Annotated[float, si("A"), _positive]
Voltage = Annotated[float, si("V"), _positive]
Resistance = Annotated[float, si("ohm"), _positive]
Inductance = Annotated[float, si("H"), _positive]
BackEmf = Annotated[float, si("V*s/rad", translated=True), _positive]
Torque = Annotated[float, si("N*m"), _positive]
Force = Annotated[float, si("N"), _positive]
TorquePerAmpere = Annotated[float, si("N*m/A"), _positive]
ForcePerAmpere = Annotated[float, si("N/A"), _positive]
TorquePerVolt = Annotated[float, si("N*m/V"), _positive]
ForcePerVolt = Annotated[float, si("N/V"), _positive]
Speed = Annotated[float, si("rad/s", translated=True), _positive]
VelocityNoise = Annotated[float, si("rad/s", translated=True), _not_negative]
CurrentNoise = Annotated[float, si("A"), _not_negative]
Resolution = Annotated[float, si("rad", translated=True), _not_negative]
Viscous = Annotated[float, si("N*m*s/rad", translated=True), _not_negative]
Coulomb = Annotated[float, si("N*m", translated=True), _not_negative]
Effort = Annotated[float, si("N*m", translated=True)]
IntegralGain = Annotated[float, si("N*m/rad", translated=True), _not_negative]
Feedforward = Annotated[float, si("kg*m**2", translated=True), _not_negative]
Temperature = Annotated[float, si("K")]
