"""Rig: what is known about an axis before anyone identifies it, read from a TOML file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, ValidationError, model_validator

from bench.arrays import Array
from bench.axis_kind import LINEAR, ROTARY, AxisKind, axis_kind
from bench.errors import InputError
from bench.names import nearest, short
from bench.rig.catalogue import catalogue_motor
from bench.rig.drive import Drive
from bench.rig.load import Load
from bench.rig.motor import Motor
from bench.rig.simulation import Simulation
from bench.rig.values import RigTable, Time, Wrap, tolerance_of
from bench.structured import read_toml
from bench.trace.known_torque import less_known
from bench.trace.plausible import require_plausible
from bench.trace.trace import Trace


class TraceNotes(RigTable):
    """`[trace]`: how foreign recordings of this axis are to be read.

    Attributes:
        columns: signal name -> column name with unit, e.g. `velocity = "Axis1.ActVel [mm/s]"`; a leading `-` turns
            the sign.
        sample_period: of recordings without time, or with a sample index - s.
        position_period: by which the recorded position wraps - rad (m).
        axis: to be read where a recording holds several.
    """

    columns: dict[str, str] = Field(default_factory=dict)
    sample_period: Time | None = None
    position_period: Wrap | None = None
    axis: str | None = None


class CheckTable(RigTable):
    """What `bench check` allows; quantities by name, each a share such as `"2 %"` or a number with its unit.

    Attributes:
        margin: changes below it do not matter.
        between: standard deviation of one axis from recording to recording.
    """

    margin: dict[str, str] = Field(default_factory=dict)
    between: dict[str, str] = Field(default_factory=dict)


class Rig(RigTable):
    """One axis as its rig file describes it, in SI units.

    Attributes:
        name: of the axis.
        kind: `rotary` or `linear`.
        offset: whether identification fits a constant torque (force) too, for axes known to have one.
    """

    name: str
    kind: Literal["rotary", "linear"]
    offset: bool = False
    motor: Motor = Motor()
    load: Load | None = None
    drive: Drive | None = None
    trace: TraceNotes = TraceNotes()
    simulation: Simulation | None = None
    check: CheckTable | None = None
    source: Annotated[str, Field(exclude=True)] = "rig"

    @classmethod
    def of(cls, table: Mapping[str, Any], source: str = "rig") -> Rig:
        """Checked from the table of a rig file, values with their units; pydantic's ValidationError where it is none.

        Args:
            table: as TOML gives it.
            source: that it comes from, for messages.
        """
        kind = LINEAR if table.get("kind") == LINEAR.name else ROTARY
        return cls.model_validate({**table, "source": source}, context={"kind": kind})

    @model_validator(mode="after")
    def _values_fit_the_kind(self) -> Rig:
        wrong = ("moving_mass", "force_constant", "force_per_volt", "rated_force")
        if not self.axis_kind.turns:
            wrong = ("rotor_inertia", "torque_constant", "torque_per_volt", "rated_torque", "continuous_stall_torque")
        for name in wrong:
            if getattr(self.motor, name) is not None:
                raise ValueError(f"motor.{name} does not belong to a {self.kind} axis")
        return self

    @property
    def axis_kind(self) -> AxisKind:
        """What its quantities are called, and their units."""
        return axis_kind(self.kind, self.source)

    def on_axis(self, name: str | None) -> Rig:
        """The same rig, reading the axis of this name from recordings that hold several; None: as the rig says."""
        trace = self.trace if name is None else self.trace.model_copy(update={"axis": name})
        return self.model_copy(update={"trace": trace})

    def effort(self, trace: Trace) -> tuple[Array, str]:
        """What drives the axis in a trace, and its unit: motor torque - N*m (force - N) wherever the rig tells how.

        Taken from the first that is recorded: torque or force, current, voltage. Torque from current is kT(Iq)*Iq; from
        voltage it is either the amplifier's gain times voltage or, with a winding, kT*(U - Ke*w)/R (quasi-static
        circuit U = R*I + Ke*w). Where the rig knows no constant, the effort stays in A, V or share of rated torque.

        Raises:
            InputError: the trace holds none of the signals, one of a magnitude that no axis has, or motor and trace
                disagree on the kind of axis.
        """
        require_plausible(trace)
        if trace.axis_kind != self.axis_kind and ("velocity" in trace or "position" in trace):
            found = f"found a {trace.axis_kind.name} axis"
            raise InputError(trace.origin, found, f"allowed: a {self.kind} one, as {self.source} says")
        direct = self.axis_kind.effort
        if direct in trace:
            rated = self.motor.rated_effort
            if trace.units[direct] == "dimensionless" and rated is not None:
                return trace[direct] * rated, self.effort_unit
            return trace[direct], trace.units[direct]
        if "current" in trace:
            constant = self.motor.torque_per_ampere
            return (
                (trace["current"], "A") if constant is None else (constant.torque(trace["current"]), self.effort_unit)
            )
        if "voltage" in trace:
            return self._effort_of_voltage(trace)
        raise InputError(trace.origin, "holds no current, torque, force or voltage", "identification needs one of them")

    def net_effort(self, trace: Trace) -> tuple[Array, str]:
        """The effort less all that is known to act, and its unit: what inertia, friction and effects are to explain.

        Raises:
            InputError: as `own_effort`.
        """
        effort, unit = self.own_effort(trace)
        return less_known(trace, effort), unit

    def own_effort(self, trace: Trace) -> tuple[Array, str]:
        """The effort less the load torque that the rig knows (an eccentric mass under gravity), and its unit.

        Raises:
            InputError: as `effort`; or the known load needs a position, or torque, that the recording does not give.
        """
        effort, unit = self.effort(trace)
        if self.load is None or self.load.eccentric_mass is None:
            return effort, unit
        if unit != "N*m":
            raise InputError(f"{self.source}: load.eccentric_mass", f"found an effort in {unit}", "allowed: N*m")
        gravity = self.load.gravity_torque(trace["position"])
        return (effort, unit) if gravity is None else (effort - gravity, unit)

    def needs_speed(self, trace: Trace) -> bool:
        """Whether the effort in a trace is made of a voltage less what the speed induces, kT*(U - Ke*w)/R."""
        if {self.axis_kind.effort, "current"} & set(trace.signals):
            return False
        return self.motor.force_per_volt is None and self.motor.torque_per_volt is None

    def _effort_of_voltage(self, trace: Trace) -> tuple[Array, str]:
        gain = self.motor.force_per_volt or self.motor.torque_per_volt
        if gain is not None:
            return trace["voltage"] * gain, self.effort_unit
        constant, resistance = self.motor.torque_per_ampere, self.motor.resistance
        if constant is not None and resistance is not None:
            back_emf = self.motor.back_emf_constant or constant.constant
            current = (trace["voltage"] - back_emf * trace["velocity"]) / resistance
            return constant.torque(current), self.effort_unit
        return trace["voltage"], "V"

    def within_tolerance(self) -> Iterator[Rig]:
        """This rig with one value at the end of its tolerance, for each value of motor and load that has one.

        A torque constant that disagrees with the back-EMF constant may as well be the one that this asks for.
        """
        if self.motor.of_back_emf is not None:
            constant = "force_constant" if self.motor.force_constant is not None else "torque_constant"
            yield self.model_copy(update={"motor": self.motor.model_copy(update={constant: self.motor.of_back_emf})})
        tables = {"motor": self.motor} | ({} if self.load is None else {"load": self.load})
        for name, table in tables.items():
            for field in type(table).model_fields:
                value = getattr(table, field)
                if tolerance_of(value) > 0.0:
                    moved = table.model_copy(update={field: value + tolerance_of(value)})
                    yield self.model_copy(update={name: moved})

    @property
    def effort_unit(self) -> str:
        """Unit of the motor's effort: N*m, or N on a linear axis."""
        return self.axis_kind.effort_unit


def load_rig(path: str | Path, defaults: Mapping[str, Any] | None = None) -> Rig:
    """Read and check a rig file.

    Args:
        path: of the file.
        defaults: keys and whole tables for those that the file leaves out, as TOML gives them.

    Raises:
        InputError: no such file, no TOML, an unknown or missing key, a value of the wrong dimension or out of bounds.
    """
    path = Path(path)
    table = {**(defaults or {}), **read_toml(path, "a rig file")}
    motor = table.get("motor")
    if isinstance(motor, dict) and "model" in motor:
        table["motor"] = {**catalogue_motor(motor["model"], f"{path}: motor.model"), **motor}
    try:
        return Rig.of(table, str(path))
    except ValidationError as error:
        raise _input_error(path, error) from error


def _input_error(path: Path, error: ValidationError) -> InputError:
    """The first complaint of pydantic as one line naming file, key, found and allowed."""
    detail = error.errors()[0]
    keys = [str(key) for key in detail["loc"]]
    where = f"{path}: {'.'.join(keys) or 'rig'}"
    context: dict[str, Any] = detail.get("ctx", {})
    if detail["type"] == "unit":
        return InputError(where, context["found"], context["allowed"])
    if detail["type"] == "extra_forbidden":
        known = _known_keys(keys[:-1])
        return InputError(where, f"unknown key{nearest(keys[-1], known)}", f"allowed: {', '.join(known)}")
    if detail["type"] == "missing":
        return InputError(where, "missing", "this key is required")
    message = detail["msg"].removeprefix("Value error, ")
    tables = isinstance(detail["input"], dict) or not keys
    found = "inconsistent" if tables else f"found {short(repr(detail['input']))}"
    return InputError(where, found, f"allowed: {message[0].lower()}{message[1:]}")


def _known_keys(keys: list[str]) -> list[str]:
    """Keys of the table that a path of keys leads to."""
    table: type[RigTable] = Rig
    for key in keys:
        if key in table.model_fields:
            kind = table.model_fields[key].annotation
            tables = [one for one in (kind, *get_args(kind)) if isinstance(one, type) and issubclass(one, RigTable)]
            table = tables[0] if tables else table
    return [name for name in table.model_fields if name != "source"]
