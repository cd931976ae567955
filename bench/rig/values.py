"""Physical values in rig files: strings with a unit, checked and turned into SI while the file is read."""

from __future__ import annotations

from numbers import Real
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)
from pydantic_core import PydanticCustomError

from bench.axis_kind import ROTARY
from bench.errors import InputError
from bench.names import meant
from bench.presented import ByName, Constructed
from bench.units import parse_with_tolerance
from bench.validated import refused


class ConstructedTable(Constructed, type(BaseModel)):
    """The kind of a table of a rig, which is both."""


class RigTable(ByName, BaseModel, metaclass=ConstructedTable):
    """A table of a rig file: frozen, and an unknown key in it is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    def __getitem__(self, name: str) -> Any:  # noqa: ANN401 - a table or a value
        return meant(name, vars(self))


class Toleranced(float):
    """A value of a rig with its tolerance: half width of the range that contains the true one at 95 % - its unit."""

    tolerance: float

    def __new__(cls, value: float, tolerance: float) -> Self:
        """Of a value and its tolerance."""
        made = super().__new__(cls, value)
        made.tolerance = tolerance
        return made

    def __getnewargs__(self) -> tuple[float, float]:  # type: ignore[override]
        """What copies and other processes make it from."""
        return float(self), self.tolerance


def tolerance_of(value: float | None) -> float:
    """Tolerance of a value of a rig - its unit; 0 where none is stated."""
    return value.tolerance if isinstance(value, Toleranced) else 0.0


def times(value: float, factor: float) -> float:
    """A value of a rig by a factor, its tolerance with it."""
    tolerance = tolerance_of(value)
    return Toleranced(value * factor, tolerance * factor) if tolerance else value * factor


def si(unit: str, translated: bool = False) -> WrapValidator:
    """Validator that turns `"22.4 kg*cm**2"`, or `"22.4 +/- 0.5 kg*cm**2"`, into a number in an SI unit.

    That is the unit on a rotary axis; `translated`, a linear one has the value in metres and newtons. The kind of axis
    comes as `kind` in the validation context. A number without a unit is SI if the context has `numbers`, a dictionary
    of the fields that had one and their units.
    """

    def read(text: object, check: ValidatorFunctionWrapHandler, info: ValidationInfo) -> float:
        context = info.context or {}
        own = (context["kind"] if translated and context else ROTARY).translated(unit)
        if (numbers := context.get("numbers")) is not None and isinstance(text, Real) and not isinstance(text, bool):
            numbers[str(info.field_name)] = own
            within = f" +/- {text.tolerance!r}" if isinstance(text, Toleranced) else ""
            text = f"{float(text)!r}{within} {own}"
        try:
            value, tolerance = parse_with_tolerance(text, own, "")
        except InputError as error:
            raise refused(error.found, error.allowed) from error
        try:
            checked = check(value)
        except ValidationError as error:  # of the bounds, which are reported of the text in the file
            raise PydanticCustomError("bounds", "{found}", {"found": error.errors()[0]["msg"]}) from error
        return Toleranced(checked, tolerance) if tolerance else checked

    return WrapValidator(read)


#: Periods that a servo axis can have - s; one in the wrong unit is beyond them, and would take hours to simulate.
SHORTEST, LONGEST = 5e-6, 10.0


def _possible(period: float) -> float:
    if not 0.999 * SHORTEST <= period <= LONGEST:
        raise ValueError(f"{SHORTEST * 1e6:g} us to {LONGEST:g} s")
    return period


#: More inertia, or viscous friction, than any axis has, telescopes and wind turbines among them - SI.
LARGEST_INERTIA, LARGEST_VISCOUS = 1e9, 1e9
_positive, _not_negative = Field(gt=0.0), Field(ge=0.0)

Inertia = Annotated[float, Field(gt=0.0, le=LARGEST_INERTIA), si("kg*m**2")]
Mass = Annotated[float, Field(gt=0.0, le=LARGEST_INERTIA), si("kg")]
Length = Annotated[float, _positive, si("m")]
Density = Annotated[float, _positive, si("kg/m**3")]
Time = Annotated[float, _positive, si("s")]
#: Of a loop, a recording or a simulation: drives' loops take 16 us to some ms, recorders up to seconds.
Period = Annotated[float, AfterValidator(_possible), si("s")]
Angle = Annotated[float, si("rad")]
Wrap = Annotated[float, _positive, si("rad", translated=True)]
Rate = Annotated[float, _not_negative, si("1/s")]
Current = Annotated[float, _positive, si("A")]
Voltage = Annotated[float, _positive, si("V")]
Resistance = Annotated[float, _positive, si("ohm")]
Inductance = Annotated[float, _positive, si("H")]
BackEmf = Annotated[float, _positive, si("V*s/rad", translated=True)]
Torque = Annotated[float, _positive, si("N*m")]
Force = Annotated[float, _positive, si("N")]
TorquePerAmpere = Annotated[float, _positive, si("N*m/A")]
ForcePerAmpere = Annotated[float, _positive, si("N/A")]
TorquePerVolt = Annotated[float, _positive, si("N*m/V")]
ForcePerVolt = Annotated[float, _positive, si("N/V")]
Speed = Annotated[float, _positive, si("rad/s", translated=True)]
VelocityNoise = Annotated[float, _not_negative, si("rad/s", translated=True)]
CurrentNoise = Annotated[float, _not_negative, si("A")]
Resolution = Annotated[float, _not_negative, si("rad", translated=True)]
Viscous = Annotated[float, Field(ge=0.0, le=LARGEST_VISCOUS), si("N*m*s/rad", translated=True)]
Coulomb = Annotated[float, _not_negative, si("N*m", translated=True)]
Effort = Annotated[float, si("N*m", translated=True)]
IntegralGain = Annotated[float, _not_negative, si("N*m/rad", translated=True)]
Feedforward = Annotated[float, Field(ge=0.0, le=LARGEST_INERTIA), si("kg*m**2", translated=True)]
Temperature = Annotated[float, si("K")]
