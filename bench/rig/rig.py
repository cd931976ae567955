"""Rig: what is known about an axis and its load before anyone identifies it, from TOML, and what it suffices for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError, model_validator

from bench.arrays import Array
from bench.assets import asset
from bench.axis_kind import LINEAR, ROTARY, AxisKind, axis_kind
from bench.errors import InputError
from bench.names import nearest, with_known_arguments
from bench.rig import values
from bench.rig.motor import Motor, catalogue_motor
from bench.rig.values import RigTable, tolerance_of
from bench.structured import read_toml
from bench.trace.motion import MAP_ONE, measured_velocity
from bench.trace.signals import RELATIVE
from bench.trace.trace import Trace, less_known, require_plausible
from bench.validated import input_error

#: Standard acceleration of free fall - m/s**2. ISO 80000-3: g_n.
STANDARD_GRAVITY = 9.80665
#: Keys of `[motor]` by which an axis is linear.
LINEAR_MOTOR = ("moving_mass", "force_constant", "force_per_volt", "rated_force")


class Load(RigTable):
    """A flat disk or ring on the shaft, and the gear between it and the motor.

    Attributes:
        outer_diameter, inner_diameter, thickness: geometry of the disk - m.
        density: of its material - kg/m**3; or `mass`: of the whole disk - kg. One of the two.
        moment_of_inertia: of what turns, as known from elsewhere, in the place of a geometry - kg*m**2.
        gear_ratio: motor turns per turn of the load; 1 without a gear.
        gear_inertia: moment of inertia of the gear, on the motor's side - kg*m**2.
        stroke: of a linear axis, from one end to the other; planned motions stay within it - m.
        eccentric_mass: of a pendulum on the load's shaft, known to pull by gravity - kg; with it `eccentric_radius`,
            of its centre from the shaft - m, and `hanging_position`, the load's angle at which it hangs - rad.
        link_inertia: part of the inertia that a robot's own model has, on the load's side - kg*m**2.
        effort_limit: largest torque (force) of the drive that a robot's own model states, on the load's side - N*m (N).
        behind_rotor: whether the torque is measured on the load's side, so that the motor's inertia is not in it.
    """

    outer_diameter: values.Length | None = None
    inner_diameter: values.Length | None = None
    thickness: values.Length | None = None
    density: values.Density | None = None
    mass: values.Mass | None = None
    moment_of_inertia: values.Inertia | None = None
    gear_ratio: Annotated[float, Field(gt=0.0)] = 1.0
    gear_inertia: values.Inertia | None = None
    stroke: values.Length | None = None
    eccentric_mass: values.Mass | None = None
    eccentric_radius: values.Length | None = None
    hanging_position: values.Angle = 0.0
    link_inertia: values.Inertia | None = None
    effort_limit: Annotated[float | None, Field(exclude=True)] = None
    behind_rotor: Annotated[bool, Field(exclude=True)] = False

    @model_validator(mode="after")
    def _one_disk(self) -> Load:
        if self.moment_of_inertia is not None and self.outer_diameter is not None:
            raise ValueError("a load takes either moment_of_inertia or the geometry of a disk")
        if self.outer_diameter is not None:
            if (self.mass is None) == (self.density is None):
                raise ValueError("a disk takes either mass or density, and density takes thickness")
            if self.mass is None and self.thickness is None:
                raise ValueError("a disk given by its density needs its thickness")
            if self.inner_diameter is not None and self.inner_diameter >= self.outer_diameter:
                raise ValueError("inner_diameter must be smaller than outer_diameter")
        if (self.eccentric_mass is None) != (self.eccentric_radius is None):
            raise ValueError("eccentric_mass and eccentric_radius go together")
        return self

    @property
    def disk_mass(self) -> float | None:
        """m = rho*pi/4*(D**2 - d**2)*h - kg; None without geometry."""
        if self.mass is not None or self.outer_diameter is None:
            return self.mass
        assert self.density is not None and self.thickness is not None
        area = math.pi / 4.0 * (self.outer_diameter**2 - (self.inner_diameter or 0.0) ** 2)
        return self.density * area * self.thickness

    @property
    def disk_inertia(self) -> float | None:
        """J = m/8*(D**2 + d**2) about the shaft, or as it is given - kg*m**2; None without either."""
        if self.moment_of_inertia is not None:
            return self.moment_of_inertia
        mass = self.disk_mass
        if mass is None or self.outer_diameter is None:
            return None
        return mass / 8.0 * (self.outer_diameter**2 + (self.inner_diameter or 0.0) ** 2)

    def disk(self, kind: AxisKind) -> float:
        """What the disk adds to the inertia of an axis of a kind, on the load's side - kg*m**2 (kg); 0 without one."""
        return (self.disk_inertia if kind.turns else self.disk_mass) or 0.0

    def gravity_torque(self, position: Array) -> Array:
        """M_load = m*g*r*sin(q/i - q_0)/i - N*m - of an eccentric mass at the motor, at its angles q - rad - (n,)."""
        assert self.eccentric_mass is not None and self.eccentric_radius is not None
        moment = self.eccentric_mass * STANDARD_GRAVITY * self.eccentric_radius
        return moment * np.sin(position / self.gear_ratio - self.hanging_position) / self.gear_ratio

    def reflected(self, inertia: float) -> float:
        """Inertia on the load's side as the motor feels it, J/i**2 - kg*m**2."""
        return inertia / self.gear_ratio**2


class TraceNotes(RigTable):
    """`[trace]`: how foreign recordings of this axis are to be read.

    Attributes:
        columns: signal name -> column name with unit, e.g. `velocity = "Axis1.ActVel [mm/s]"`; a leading `-` turns
            the sign.
        sample_period: of recordings without time, or with a sample index - s.
        position_period: by which the recorded position wraps - rad (m).
        axis: to be read where a recording has several.
    """

    columns: dict[str, str] = Field(default_factory=dict)
    sample_period: values.Time | None = None
    position_period: values.Wrap | None = None
    axis: str | None = None


class JointNotes(RigTable):
    """`[joints.NAME]`: the columns of one of a robot's joints, and how it counts.

    Attributes:
        axis: what the log calls the joint, where that is not its name.
        columns: as of `[trace]`, of any column of the log.
        sign: -1 where the log counts angle, speed and torque of the joint the other way than the robot's model.
        torque_constant: of the joint's motor - N*m/A.
        gear_ratio: turns of the motor, whose angle and torque the log then has, per turn of the joint.
        torque: where it is measured; on the joint's side of the gear the rotor is not in it, and it is the joint's.
    """

    axis: str | None = None
    columns: dict[str, str] = Field(default_factory=dict)
    sign: Literal[1, -1] = 1
    torque_constant: values.TorquePerAmpere | None = None
    gear_ratio: Annotated[float, Field(gt=0.0)] | None = None
    torque: Literal["motor side", "joint side"] = "motor side"


class CheckTable(RigTable):
    """What `bench check` allows, by quantity: a change that does not matter, and the standard deviation of one axis
    from recording to recording; each a share such as `"2 %"` or a number with its unit.
    """

    margin: dict[str, str] = Field(default_factory=dict)
    between: dict[str, str] = Field(default_factory=dict)


class Drive(RigTable):
    """Cascade of a position P controller and a velocity PI controller with inertia feed-forward.

    torque = velocity_gain*e_v + integral_gain*integral(e_v dt) + inertia_feedforward*acceleration_reference,
    e_v = velocity_reference + position_gain*(position_reference - position) - velocity; current limited to the motor's
    peak current, the integrator held while limited.

    Attributes:
        position_gain: velocity demand per position error - 1/s.
        velocity_gain: torque per velocity error - N*m*s/rad (N*s/m on a linear axis).
        integral_gain: torque per integrated velocity error - N*m/rad (N/m).
        inertia_feedforward: torque per acceleration reference - kg*m**2 (kg).
        control_period: of the loop - s.
    """

    position_gain: values.Rate
    velocity_gain: values.Viscous
    integral_gain: values.IntegralGain = 0.0
    inertia_feedforward: values.Feedforward = 0.0
    control_period: values.Period = 250e-6

    @model_validator(mode="after")
    def _samples_fast_enough(self) -> Drive:
        """Half a period T of delay takes (K_v*K_p + K_i)*T/2 off the velocity gain K_v, and must leave some of it."""
        stiffness = self.velocity_gain * self.position_gain + self.integral_gain
        most = 2.0 * self.velocity_gain / stiffness if stiffness > 0.0 else math.inf
        if self.control_period > most:
            raise ValueError(
                f"control_period must be below {most:.3g} s with these gains, found {self.control_period:g} s"
            )
        return self


class Simulation(RigTable):
    """`[simulation]` of a rig file.

    Attributes:
        moment_of_inertia: of everything that moves, on the motor's side - kg*m**2; on a linear axis `moving_mass` - kg.
            Without it, rotor plus disk from its geometry, reflected through the gear.
        viscous_friction_coefficient: K_w - N*m*s/rad (N*s/m).
        coulomb_friction: K_0 - N*m (N).
        friction: `mechanics` puts it into the joint, `drive` lets the drive's software apply it as the lab does.
        load_torque: constant torque on the load (behind any gear) that resists positive motion - N*m (N).
        encoder_resolution: angle (length) of one count - rad (m); 0 is ideal.
        velocity_noise: standard deviation of the reported speed - rad/s (m/s).
        current_noise: standard deviation of the reported current - A.
        sample_period: of the recording - s.
        timestep: of the integration - s; the drive's control period if not given.
    """

    moment_of_inertia: values.Inertia | None = None
    moving_mass: values.Mass | None = None
    viscous_friction_coefficient: values.Viscous = 0.0
    coulomb_friction: values.Coulomb = 0.0
    friction: Literal["mechanics", "drive"] = "mechanics"
    load_torque: values.Effort = 0.0
    encoder_resolution: values.Resolution = 0.0
    velocity_noise: values.VelocityNoise = 0.0
    current_noise: values.CurrentNoise = 0.0
    sample_period: values.Period = 1e-3
    timestep: values.Period | None = None


class Rig(RigTable):
    """One axis as its rig file describes it, in SI; `offset`: one that is known to have a constant torque (force)."""

    name: str
    kind: Literal["rotary", "linear"]
    offset: bool = False
    motor: Motor = Motor()
    load: Load | None = None
    drive: Drive | None = None
    trace: TraceNotes = TraceNotes()
    simulation: Simulation | None = None
    check: CheckTable | None = None
    joints: dict[str, JointNotes] = Field(default_factory=dict)
    source: Annotated[str, Field(exclude=True)] = "rig"
    assumed: Annotated[tuple[str, ...], Field(exclude=True)] = ()

    def __init__(self, /, **table: Any) -> None:  # noqa: ANN401 - any content of a rig file
        """Checked from the keys of a rig file, values with units, or numbers in SI; InputError where they are none."""
        source, motor = str(table.get("source", "rig")), table.get("motor")
        linear = isinstance(motor, Mapping) and any(key in motor for key in LINEAR_MOTOR)
        name = Path(source).stem if "source" in table else "axis"
        table = {"name": name, "kind": (LINEAR if linear else ROTARY).name, **table}
        if isinstance(motor, dict) and "model" in motor:
            table["motor"] = {**catalogue_motor(motor["model"], f"{source}: motor.model"), **motor}
        kind = LINEAR if table.get("kind") == LINEAR.name else ROTARY
        numbers: dict[str, str] | None = None if "source" in table else {}
        try:
            context = {"kind": kind, "numbers": numbers}
            self.__pydantic_validator__.validate_python(table, self_instance=self, context=context)
        except ValidationError as error:
            raise input_error(source, error, Rig, "rig") from error
        if numbers:
            said = ", ".join(f"{name} in {unit}" for name, unit in numbers.items())
            vars(self)["assumed"] = (f"numbers of the rig without a unit are taken in SI: {said}",)

    def to_dict(self) -> dict[str, Any]:
        """Its tables in SI, without what is not stated; `Rig(**tables)` makes the same rig."""
        return self.model_dump(exclude_none=True)

    @classmethod
    def of(cls, table: Mapping[str, Any], source: str = "rig") -> Rig:
        """Checked from the table of a rig file, values with units; InputError where it is none."""
        return cls(**{**table, "source": source})

    @model_validator(mode="after")
    def _values_fit_the_kind(self) -> Rig:
        wrong = LINEAR_MOTOR
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

    @property
    def simulated(self) -> Simulation:
        """Truth of the simulated axis; InputError where the rig has none."""
        if self.simulation is None:
            raise InputError(f"{self.source}: simulation", "missing", "a simulated axis needs a table [simulation]")
        return self.simulation

    def on_axis(self, name: str | None) -> Rig:
        """The same rig, reading the axis of this name from recordings with several; None: as in the rig."""
        trace = self.trace if name is None else self.trace.model_copy(update={"axis": name})
        return self.model_copy(update={"trace": trace})

    def of_joint(self, name: str) -> Rig:
        """The same rig with `[joints.NAME]` of a joint in place of the values for all."""
        own = self.joints.get(name)
        if own is None:
            return self
        motor, load, trace = self.motor, self.load or Load(), self.trace
        if own.torque_constant is not None:
            motor = motor.model_copy(update={"torque_constant": own.torque_constant})
        gear = {"gear_ratio": own.gear_ratio or load.gear_ratio, "behind_rotor": own.torque == "joint side"}
        columns = {**trace.columns, **own.columns}
        trace = trace.model_copy(update={"columns": columns, "axis": own.axis or trace.axis})
        return self.model_copy(update={"motor": motor, "load": load.model_copy(update=gear), "trace": trace})

    def effort(self, trace: Trace) -> tuple[Array, str]:
        """What drives the axis in a trace, and its unit: motor torque - N*m (force - N) wherever the rig states how.

        Taken from the first that is recorded: torque or force, current, voltage. Torque from current is kT(Iq)*Iq; from
        voltage it is either the amplifier's gain times voltage or, with a winding, kT*(U - Ke*w)/R (quasi-static
        circuit U = R*I + Ke*w). Where the rig has no constant, the effort stays in A, V or share of rated torque.

        Raises:
            InputError: the trace has none of the signals, one of a magnitude that no axis has, or motor and trace
                disagree on the kind of axis.
        """
        require_plausible(trace)
        if trace.axis_kind != self.axis_kind and ("velocity" in trace or "position" in trace):
            found = f"found a {trace.axis_kind.name} axis"
            other = f'`kind = "{trace.axis_kind.name}"` there if it is one'
            raise InputError(trace.origin, found, f"allowed: a {self.kind} one, as in {self.source}; {other}")
        direct = self.axis_kind.effort
        if direct in trace:
            rated = self.motor.rated_torque or self.motor.rated_force  # what 100 % of a relative torque means
            if trace.units[direct] == RELATIVE and rated is not None:
                return trace[direct] * rated, self.effort_unit
            return trace[direct], trace.units[direct]
        if "current" in trace:
            constant, current = self.motor.torque_per_ampere, trace["current"]
            return (current, "A") if constant is None else (constant.torque(current), self.effort_unit)
        if "voltage" in trace:
            return self._effort_of_voltage(trace)
        kinds = ("current", "torque", "force", "voltage")
        unread = [note for note in trace.notes if note.startswith(tuple(f"{kind} left out" for kind in kinds))]
        raise InputError(
            trace.origin,
            "; ".join(["contains no current, torque, force or voltage", *unread]),
            MAP_ONE,
        )

    def net_effort(self, trace: Trace) -> tuple[Array, str]:
        """Effort less all that is known to act, and its unit: what inertia, friction and effects are to explain."""
        effort, unit = self.own_effort(trace)
        return less_known(trace, effort), unit

    def own_effort(self, trace: Trace) -> tuple[Array, str]:
        """The effort less the load torque of the rig (an eccentric mass under gravity), and its unit.

        InputError as `effort`, or where the known load needs a position, or torque, that the recording does not give.
        """
        effort, unit = self.effort(trace)
        if self.load is None or self.load.eccentric_mass is None:
            return effort, unit
        if unit != "N*m":
            raise InputError(f"{self.source}: load.eccentric_mass", f"found an effort in {unit}", "allowed: N*m")
        return effort - self.load.gravity_torque(trace["position"]), unit

    def driven(self, trace: Trace) -> Array:
        """Effort by the recorded signal alone: with what a motion induces or weighs, it is `own_effort` (n,)."""
        if not self.needs_speed(trace):
            return self.effort(trace)[0]
        still = trace.with_signals({"velocity": np.zeros(len(trace))}, {"velocity": self.axis_kind.speed_unit})
        return self.effort(still)[0]

    def needs_speed(self, trace: Trace) -> bool:
        """Whether the effort in a trace is computed from a voltage less what the speed induces, kT*(U - Ke*w)/R."""
        if {self.axis_kind.effort, "current"} & set(trace.signals):
            return False
        return self.motor.force_per_volt is None and self.motor.torque_per_volt is None

    def _effort_of_voltage(self, trace: Trace) -> tuple[Array, str]:
        gain, voltage = self.motor.force_per_volt or self.motor.torque_per_volt, self.voltage(trace)
        if gain is not None:
            return voltage * gain, self.effort_unit
        constant, resistance = self.motor.torque_per_ampere, self.motor.resistance
        if constant is not None and resistance is not None:
            back_emf = self.motor.back_emf_constant or constant.constant
            current = (voltage - back_emf * measured_velocity(trace)) / resistance
            return constant.torque(current), self.effort_unit
        return voltage, "V"

    @property
    def gear_ratio(self) -> float:
        """Turns (m) of the motor per turn (m) of the load; 1 without a load."""
        return self.load.gear_ratio if self.load is not None else 1.0

    @property
    def stated_inertia(self) -> float | None:
        """Of all that moves, on the motor's side - kg*m**2 (kg), where the motor's and the load's are stated."""
        if not self.motor.inertia or self.load is None:
            return None
        return (
            self.motor.inertia + (self.load.gear_inertia or 0.0) + self.load.reflected(self.load.disk(self.axis_kind))
        )

    def voltage(self, trace: Trace) -> Array:
        """Of the motor (n,) - V; InputError for a duty cycle where the supply's voltage is unknown."""
        if trace.units["voltage"] == "V":
            return trace["voltage"]
        supply = trace.signals.get("supply_voltage", self.motor.supply_voltage)
        if supply is None:
            allowed = 'allowed: with a column of the supply\'s voltage, or motor.supply_voltage = "12 V" in the rig'
            raise InputError(trace.origin, "found the voltage as a duty cycle", allowed)
        return trace["voltage"] * supply

    def within_tolerance(self) -> Iterator[Rig]:
        """This rig with one value at the end of its tolerance, for each value of motor and load that has one.

        A torque constant that disagrees with the back-EMF constant may as well be the one that this asks for.
        """
        if self.motor.of_back_emf is not None:
            constant = "force_constant" if self.motor.force_constant is not None else "torque_constant"
            yield self.model_copy(update={"motor": self.motor.model_copy(update={constant: self.motor.of_back_emf})})
        for name, table in (("motor", self.motor), ("load", self.load or Load())):
            for field, value in table:
                if tolerance_of(value) > 0.0:
                    moved = table.model_copy(update={field: value + tolerance_of(value)})
                    yield self.model_copy(update={name: moved})

    @property
    def effort_unit(self) -> str:
        """Unit of the motor's effort: N*m, or N on a linear axis."""
        return self.axis_kind.effort_unit


def shipped() -> dict[str, Path]:
    """Files of the rigs that travel with the bench, by name."""
    return {path.stem: path for path in sorted(asset("data", "rigs").glob("*.toml"))}


def rig_file(given: str | Path) -> Path:
    """The file of a rig: as given, or of a shipped one by its name; InputError where it is neither."""
    path, known = Path(given), shipped()
    try:
        shadow = str(given) in known and path.is_dir()  # such as the one that an earlier --out wrote
        if path.suffix or path.name != str(given) or (path.exists() and not shadow):
            return path
    except OSError:  # such as a name that is too long: its reader reports it
        return path
    if str(given) not in known:
        found = f"no such file and no shipped rig{nearest(str(given), list(known))}"
        raise InputError(given, found, f"allowed: a rig file, or one of {', '.join(known)}")
    return known[str(given)]


@with_known_arguments
def load_rig(path: str | Path, defaults: Mapping[str, Any] | None = None) -> Rig:
    """Read and check a rig file, or a shipped one by its name.

    `defaults` are keys and whole tables for those that it leaves out, as TOML gives them. InputError: no such file, no
    TOML, an unknown or missing key, a value of the wrong dimension or out of bounds.
    """
    path = rig_file(path)
    return Rig.of({**(defaults or {}), **read_toml(path, "a rig file")}, str(path))


def lacking(rig: Rig) -> dict[str, tuple[str, ...]]:
    """Command -> keys that it needs and the rig does not give; none where the rig suffices."""
    motor, kind = rig.motor, rig.axis_kind
    constant, limit = motor.torque_per_ampere is not None, motor.peak_torque is not None
    inertia = rig.simulation is not None and getattr(rig.simulation, kind.inertia) is not None
    inertia = inertia or bool(motor.inertia) or (rig.load is not None and rig.load.disk(kind) > 0.0)
    simulate = {
        "drive (position_gain, velocity_gain)": rig.drive is not None,
        "simulation (a table; friction, noise and sensors of the simulated axis)": rig.simulation is not None,
        f"motor.{'torque' if kind.turns else 'force'}_constant (or the four datasheet values)": constant,
        "motor.peak_current (or peak_torque)": limit or (constant and motor.peak_current is not None),
        f"simulation.{kind.inertia} (or motor and load that give it)": inertia,
    }
    limits = {
        "motor.peak_torque": limit,
        "motor.continuous_stall_torque": motor.continuous_stall_torque is not None,
        "motor.peak_curves": bool(motor.peak_curves),
    }
    simulated = dict.fromkeys(("simulate", "validate", "plan"), simulate)
    needs: dict[str, dict[str, bool]] = {"identify": {}, "diagnose": {}, **simulated, "limits": limits}
    return {command: tuple(key for key, given in keys.items() if not given) for command, keys in needs.items()}


def without_constant(rig: Rig) -> str | None:
    """What a rig without a torque constant means for results; None where it has one, or maps a torque or force."""
    effort = rig.axis_kind.effort
    if rig.motor.torque_per_ampere is not None or {"torque", "force"} & rig.trace.columns.keys():
        return None
    return f"no {effort} constant is given, so {effort}s are in A; set motor.{effort}_constant in the rig"


def without_rated(rig: Rig, trace: Trace) -> str | None:
    """What a rig without a rated torque means where the recorded torque is a share of it; None where it is not."""
    effort, motor = rig.axis_kind.effort, rig.motor
    if trace.units.get(effort) != RELATIVE or motor.rated_torque is not None or motor.rated_force is not None:
        return None
    return f"the {effort} is a share of the rated one; set motor.rated_{effort} in the rig for one in {rig.effort_unit}"


def require(rig: Rig, command: str) -> None:
    """InputError naming all keys that a command misses in a rig."""
    keys = lacking(rig)[command]
    if keys:
        needs = "this key" if len(keys) == 1 else "all of these keys"
        raise InputError(f"{rig.source}: {', '.join(keys)}", "missing", f"bench {command} needs {needs}")
