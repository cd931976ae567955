"""A model as what a drive feeds forward: its inertia, friction over speed, and torque over position.

    M_ff = J*alpha + F(omega) + C(q)

F - mean over a turn of what resists steady motion at a speed - N*m; C - what it varies by over the position, mean over
both directions at a slow speed - N*m; alpha, omega, q - references. What is neither - ripple, which grows with the
current; a friction level that varies with position; what the drive itself does - is handled by the drive's feedback.

The resisting torque is that of all effects at once: native ones through MuJoCo, which computes their torques from
position and speed; the others through their own hooks, as in a simulation. Time is at its end: what warms up is warm,
what happens for a while is over. A simulation of the model shows how much better a drive tracks with it.

`DriveUnits` writes it as tables in the drive's own units: those that its recorder speaks, as the rig's columns have
them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from mujoco.batch import Batch

from bench.arrays import Array, rms
from bench.effects.mjcf import AXIS, BRISTLES
from bench.errors import InputError
from bench.export.simulations import Joints, Simulations
from bench.plant.axis_model import AxisModel
from bench.plant.drive import Cascade, References
from bench.plant.plant import Plant
from bench.plant.run import run
from bench.plant.stepped_effects import SteppedEffects
from bench.rig.rig import Rig
from bench.structured import csv_text
from bench.trace.channel import split_label
from bench.trace.signals import scale_in, unit_on

#: Points of the table over position, and of each side of the table over speed.
POSITIONS, SPEEDS = 720, 60
#: Slowest speed of the table over speed, as a share of the fastest: below it friction is taken from rest linearly.
SLOWEST = 1e-3
#: Speed at which torque over position is computed, as a share of the fastest.
SLOWLY = 0.05
#: Share of a table's largest torque below which an effect changes nothing in it.
NOTHING = 1e-6
#: Share of the torque over a turn by which its ends differ where it does not repeat itself.
OPEN = 1e-3
#: Timestep of a model that is evaluated and does not move - s.
TIMESTEP = 1e-4


@dataclass(frozen=True, eq=False)
class TorqueTable:
    """Torque - N*m (N) - (n,) over an increasing coordinate - rad/s or rad (m/s, m) -, linear between, held beyond.

    Attributes:
        period: after which it repeats itself - rad (m); None where it does not.
    """

    coordinate: Array
    torque: Array
    period: float | None = None

    def __call__(self, at: Array) -> Array:
        """Torque - N*m (N) - (m,)."""
        return np.interp(at, self.coordinate, self.torque, period=self.period)

    @property
    def largest(self) -> float:
        """Magnitude of torque - N*m (N) -, above zero."""
        return max(float(np.abs(self.torque).max()), 1e-300)


@dataclass(frozen=True, eq=False)
class Feedforward:
    """What a drive is given: J - kg*m**2 (kg), F over speed, C over position, and effects that are in neither."""

    inertia: float
    friction: TorqueTable
    cogging: TorqueTable
    left: tuple[str, ...]

    def along(self, references: References) -> References:
        """References with the torque of both tables; inertia is the drive's own feed-forward."""
        torque = self.friction(references.velocity) + self.cogging(references.position)
        return replace(references, torque=torque)


def feedforward(model: AxisModel, fastest: float, travelled: tuple[float, float]) -> Feedforward:
    """What a drive is to feed forward for a model.

    Args:
        model: with effects.
        fastest: speed that the tables reach - rad/s (m/s).
        travelled: positions they reach on an axis that does not turn, or whose torque does not repeat itself - rad (m).

    Raises:
        InputError: no speed to lay the tables out for.
    """
    if not fastest > 0.0:
        raise InputError("the motion", "found no speed in it", "allowed: one that moves")
    span = 0.0, 2.0 * math.pi
    tables = friction, cogging = _tables(model, fastest, span)
    ends = resisting_torque(model, np.array(span), np.full(2, SLOWLY * fastest))
    if model.parameters.kind.turns and abs(ends[1] - ends[0]) <= OPEN * friction.largest:
        cogging = replace(cogging, period=2.0 * math.pi)
    else:
        span = travelled
        tables = friction, cogging = _tables(model, fastest, span)
    left = []
    for present in model.effects:
        others = model.with_effects([other for other in model.effects if other is not present])
        without = _tables(others, fastest, span)
        changes = (np.abs(one.torque - table.torque).max() for one, table in zip(without, tables, strict=True))
        if max(changes) < NOTHING * friction.largest:
            left.append(present.name)
    return Feedforward(model.parameters.inertia, friction, cogging, tuple(left))


def _tables(model: AxisModel, fastest: float, span: tuple[float, float]) -> tuple[TorqueTable, TorqueTable]:
    """F up to a fastest speed - rad/s (m/s) -, and C within a span - rad (m) -, less its mean."""
    positions = np.linspace(*span, POSITIONS, endpoint=False)
    side = np.geomspace(SLOWEST, 1.0, SPEEDS) * fastest
    speeds = np.concatenate([-side[::-1], [0.0], side])
    some = positions[:: POSITIONS // 60]
    q, w = (grid.ravel() for grid in np.meshgrid(some, speeds, indexing="ij"))
    over_speed = resisting_torque(model, q, w).reshape(some.size, -1).mean(axis=0)
    slowly = np.full(POSITIONS, SLOWLY * fastest)
    both = 0.5 * (resisting_torque(model, positions, slowly) + resisting_torque(model, positions, -slowly))
    return TorqueTable(speeds, over_speed), TorqueTable(positions, both - both.mean())


def tracking(model: AxisModel, rig: Rig, references: References, feedforward: Feedforward | None = None) -> Tracking:
    """Errors of a rig's drive on an axis along references at its ticks.

    It feeds forward what it is given, else what is in its rig file. InputError where the rig has no drive,
    SimulationError where the simulation diverged.
    """
    cascade = Cascade.from_rig(rig)
    motion = references
    if feedforward is not None:
        cascade, motion = replace(cascade, inertia_feedforward=feedforward.inertia), feedforward.along(references)
    states = run(Plant(model, cascade, cascade.control_period), motion)
    return Tracking(rms(references.position - states.position), rms(references.velocity - states.velocity))


@dataclass(frozen=True)
class Tracking:
    """RMS of reference less motion along a motion: of position - rad (m) - and velocity - rad/s (m/s)."""

    position: float
    velocity: float


def resisting_torque(model: AxisModel, position: Array, velocity: Array) -> Array:
    """Motor torque that a steady motion takes - N*m (N) - (n,), dry friction against its direction and none at rest.

    Position and velocity are the motor's - rad (m), rad/s (m/s) - (n,).
    """
    spec = model.spec(TIMESTEP)
    bristles = spec.actuator(BRISTLES)
    if bristles is not None:  # steady, they have bent as far as dry friction, their level, bends them
        spec.joint(AXIS).frictionloss = float(bristles.biasprm[3])
        spec.delete(bristles)
    batch = Batch(spec.compile(), position.size)
    joint = batch.model.joint(AXIS)
    dof = joint.dofadr[0]
    batch.bind("qpos")[:, joint.qposadr[0]], batch.bind("qvel")[:, dof] = position, velocity
    applied, passive, made = (batch.bind(f"qfrc_{part}")[:, dof] for part in ("applied", "passive", "actuator"))
    effects = SteppedEffects([model], TIMESTEP)
    none = np.zeros_like(velocity)
    Joints(Simulations.of(batch)).take(effects.act(effects.start(velocity), np.inf, position, velocity, none))
    batch.forward()
    return batch.expand("dof_frictionloss")[:, dof] * np.sign(velocity) - applied - passive - made


@dataclass(frozen=True)
class Unit:
    """How a drive counts a signal: its unit, as written, and SI per one of it, negative where it counts backwards."""

    text: str
    factor: float

    @classmethod
    def of(cls, rig: Rig, signal: str) -> Unit:
        """As the rig's `[trace.columns]` has a signal, else SI; InputError where that is no unit of it."""
        label = rig.trace.columns.get(signal, "")
        unit = split_label(label)[1] or unit_on(rig.axis_kind, signal)
        factor = scale_in(signal, unit, f"{rig.source}: trace.columns.{signal}").factor
        return cls(unit, -factor if label.startswith("-") else factor)


@dataclass(frozen=True)
class DriveUnits:
    """How a drive counts position, velocity and current, of which the rig's torque constant makes torques."""

    rig: Rig
    position: Unit
    velocity: Unit
    current: Unit

    @classmethod
    def of(cls, rig: Rig) -> DriveUnits:
        """As in a rig; InputError where a unit is none of its signal's."""
        return cls(rig, Unit.of(rig, "position"), Unit.of(rig, "velocity"), Unit.of(rig, "current"))

    def table(self, name: str, unit: Unit, table: TorqueTable) -> str:
        """A table as CSV, in the order of the drive's own count; with currents where the rig states what gives them."""
        coordinate, constant = table.coordinate / unit.factor, self.rig.motor.torque_per_ampere
        columns = [coordinate, table.torque]
        head = [f"{name} [{unit.text}]", f"{self.rig.axis_kind.effort} [{self.rig.effort_unit}]"]
        if constant is not None:
            columns.append(constant.current(table.torque) / self.current.factor)
            head.append(f"current [{self.current.text}]")
        return csv_text(head, np.column_stack(columns)[np.argsort(coordinate, kind="stable")].tolist())

    def inertia(self, feedforward: Feedforward) -> Iterator[tuple[str, float, str]]:
        """The inertia's feed-forward: name, value and unit."""
        yield "inertia_feedforward", feedforward.inertia, self.rig.axis_kind.inertia_unit
        constant = self.rig.motor.torque_per_ampere
        if constant is not None:
            per = feedforward.inertia / constant.constant / self.current.factor * self.velocity.factor
            yield "current_per_acceleration", per, f"{self.current.text}/({self.velocity.text}/s)"

    def files(self, feedforward: Feedforward) -> dict[str, str]:
        """Names and texts of the files that hold all of it."""
        rows = [f"{name},{value:.9g},{unit}" for name, value, unit in self.inertia(feedforward)]
        return {
            "inertia.csv": "\n".join(["name,value,unit", *rows]) + "\n",
            "friction.csv": self.table("velocity", self.velocity, feedforward.friction),
            "cogging.csv": self.table("position", self.position, feedforward.cogging),
        }
