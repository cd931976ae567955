"""Effects that MuJoCo does not make by itself: in every step they set friction, inertia and torque.

They act as at the middle of the step, which keeps the integration second order: MuJoCo's position is there already (see
`bench.plant.axis_model`), velocity is extrapolated from the last two steps. Friction levels combine as

    forward, backward = (K_0 + sum of excesses +- sum of differences/2)*product of factors, neither below zero,

of which MuJoCo's dry friction takes the mean, so that sticking stays exact, and a torque half of the difference.

Values are arrays of axes side by side; of a lone axis they are numbers, of which all that is computed costs a fraction.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Generic, TypeVar

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.acting import (
    DirectedFriction,
    DriveLimit,
    FollowsLoad,
    LoadTorque,
    MisreadEffort,
    RaisesFriction,
    ResistingTorque,
    ScalesFriction,
    ScalesTorque,
    TorqueLag,
    TorqueLoss,
    VaryingInertia,
)
from bench.effects.effect import Effect
from bench.effects.mjcf import AXIS, BRISTLES
from bench.effects.present import Present
from bench.effects.signals import Axis, Moment, Number, Winding
from bench.plant.axis_model import AxisModel

Kind = TypeVar("Kind", bound=Effect)

#: Places of the two friction levels among the parameters of a passive motor with bristles.
BRISTLE_LEVELS = slice(3, 5)


class SteppedEffects:
    """Ticked effects of axes side by side, a model for each; they start with a velocity - rad/s (m/s)."""

    def __init__(self, joints: Joints, models: Sequence[AxisModel], velocity: Number) -> None:
        self._joints, self._step = joints, joints.step
        self._none = per_axis([0.0] * len(models))
        self._flowing = on_axes(models, DriveLimit)
        self._acting = on_axes(models, TorqueLag)
        self._delivered = on_axes(models, TorqueLoss)
        self._acted = on_axes(models, MisreadEffort)
        self._drives = self._flowing or self._acting or self._delivered or self._acted
        self._friction = _FrictionLevels(joints, models)
        self._inertia = on_axes(models, VaryingInertia, ticked=True)
        self._resisting = on_axes(models, ResistingTorque, ticked=True)
        self._factors = on_axes(models, ScalesTorque, ticked=True)
        self._before = velocity

    def act(
        self, time: Number, position: Number, velocity: Number, demand: Number, began: Number = 0.0
    ) -> tuple[Number, Number]:
        """Set up the next step; returns the effort that is reported and the motor's torque, (axes,) each.

        Of a lone axis everything may be numbers. The velocity is kept, and must not change afterwards.

        Args:
            time: at the start of the step, since the recording's start - s - one for all axes, or (axes,).
            position: MuJoCo's, half a step on - rad (m) - (axes,).
            velocity: at the start of the step - rad/s (m/s) - (axes,).
            demand: effort that the drive asks for - N*m (N) - (axes,).
            began: the recording, as `Moment` has it - s - one for all axes, or (axes,).
        """
        middle = 1.5 * velocity - 0.5 * self._before
        self._before, time = velocity, time + 0.5 * self._step
        reported, torque = self._driven(time, middle, demand) if self._drives else (demand, demand)
        at = Moment(time, position, middle, torque, began)
        if self._factors:
            for some in self._factors:
                factor = some.effect.torque_factor(some.values, some.axis, some.moment(at))
                torque = some.with_these(torque, some.of(torque) * factor)
            at = Moment(time, position, middle, torque, began)
        applied = self._none - self._friction.offset(at)
        for some in self._resisting:
            resisting = some.effect.resisting_torque(some.values, some.axis, some.moment(at))
            applied = some.with_these(applied, some.of(applied) - resisting)
        self._joints.set_torque(applied)
        if self._inertia:
            added = self._none
            for some in self._inertia:
                more = some.effect.added_inertia(some.values, some.axis, some.moment(at))
                added = some.with_these(added, some.of(added) + more)
            self._joints.set_added_inertia(added)
        return reported, torque

    def _driven(self, time: Number, velocity: Number, demand: Number) -> tuple[Number, Number]:
        """In the order of the signal: what flows of a demand, what that truly is, what acts, what torque it makes."""
        reported = demand
        for some in self._flowing:
            wanted, speed = some.of(demand), some.of(velocity)
            flows, some.memory = some.effect.flowing(some.values, some.axis, speed, wanted, some.memory, self._step)
            reported = some.with_these(reported, flows)
        torque = reported
        for some in self._acted:
            torque = some.with_these(torque, some.effect.acted(some.values, some.axis, some.of(torque), some.of(time)))
        for some in self._acting:
            acts, some.memory = some.effect.acting(some.values, some.of(torque), some.memory, self._step)
            torque = some.with_these(torque, acts)
        for some in self._delivered:
            torque = some.with_these(torque, some.effect.delivered(some.values, some.axis, some.of(torque)))
        return reported, torque


class _FrictionLevels:
    """The level of dry friction, where effects change it in every step."""

    def __init__(self, joints: Joints, models: Sequence[AxisModel]) -> None:
        self._coulomb = per_axis([model.parameters.coulomb_friction for model in models])
        self._none = per_axis([0.0] * len(models))
        self._excesses = on_axes(models, RaisesFriction, ticked=True)
        self._factors = on_axes(models, ScalesFriction, ticked=True)
        self._differences = on_axes(models, DirectedFriction, ticked=True)
        self._loads = on_axes(models, LoadTorque) if on_axes(models, FollowsLoad) else []
        self._joints = joints
        self._changes = self._excesses or self._factors or self._differences
        self._varies = self._excesses or self._factors or joints.bristled
        self._levels: tuple[Number, Number] | None = None

    def offset(self, at: Moment) -> Number:
        """Set the level; returns half the difference of the two directions' levels - N*m (N) - (axes,)."""
        if not self._changes:
            return 0.0
        if self._levels is None or self._varies:
            self._levels = self._mean_and_offset(at)
        self._joints.set_friction(self._levels[0])
        return self._levels[1]

    def _mean_and_offset(self, at: Moment) -> tuple[Number, Number]:
        level = self._coulomb
        if self._loads:
            load = self._none  # that the transmission carries
            for some in self._loads:
                load = some.with_these(load, some.of(load) + some.effect.load_torque(some.values, some.moment(at)))
            at = replace(at, load=load)
        for some in self._excesses:
            excess = some.effect.friction_excess(some.values, some.axis, some.moment(at))
            level = some.with_these(level, some.of(level) + excess)
        half = self._none
        for some in self._differences:
            difference = some.effect.friction_difference(some.values, some.axis)
            half = some.with_these(half, some.of(half) + 0.5 * difference)
        for some in self._factors:
            factor = some.effect.friction_factor(some.values, some.axis, some.moment(at))
            level, half = (some.with_these(each, some.of(each) * factor) for each in (level, half))
        if not self._differences:
            return np.maximum(level, 0.0), 0.0
        forward, backward = np.maximum(level + half, 0.0), np.maximum(level - half, 0.0)
        if self._joints.bristled:  # which bend to the level of their direction, and hold no torque beside
            return np.where(at.velocity > 0.0, forward, backward), 0.0
        return 0.5 * (forward + backward), 0.5 * (forward - backward)


@dataclass
class EffectOnAxes(Generic[Kind]):
    """One effect on some axes of a batch.

    Attributes:
        effect: what it is.
        index: of the axes that have it, None where all do.
        values: of its quantities, (k,) each, or numbers of a lone axis.
        axis, memory: constants of these axes, and what the effect remembers, alike.
    """

    effect: Kind
    index: NDArray[np.intp] | None
    values: dict[str, Number]
    axis: Axis
    memory: Number = 0.0

    def moment(self, at: Moment) -> Moment:
        """What these axes see of a moment."""
        if self.index is None:
            return at
        return Moment(*(self.of(each) for each in (at.time, at.position, at.velocity, at.effort, at.began, at.load)))

    def of(self, values: Number) -> Number:
        """Of values of all axes, or one for all, those of these axes."""
        return values if self.index is None or not isinstance(values, np.ndarray) else values[self.index]

    def with_these(self, values: Number, these: Number) -> Number:
        """Values of all axes with those of these axes in their places; what came in stays as it is."""
        if self.index is None or not isinstance(values, np.ndarray):
            return these
        changed = values.copy()
        changed[self.index] = these
        return changed


def on_axes(models: Sequence[AxisModel], kind: type[Kind], ticked: bool = False) -> list[EffectOnAxes[Kind]]:
    """Effects of a kind, in the order of their names; an effect that an axis has twice makes two of them.

    With `ticked` only those that MuJoCo does not make by itself.
    """
    found: dict[tuple[str, int], dict[int, Present]] = {}
    for row, model in enumerate(models):
        count: Counter[str] = Counter()
        for present in model.of_kind(kind):
            if not ticked or present in model.ticked:
                found.setdefault((present.name, count[present.name]), {})[row] = present
                count[present.name] += 1
    return [_gathered(models, found[key], kind) for key in sorted(found)]


def _gathered(models: Sequence[AxisModel], having: Mapping[int, Present], kind: type[Kind]) -> EffectOnAxes[Kind]:
    """An effect on the axes that have it."""
    index, values = list(having), [dict(present.values) for present in having.values()]
    effect = having[index[0]].effect
    assert isinstance(effect, kind)
    axes = [models[row].axis for row in index]
    windings = [axis.winding for axis in axes if axis.winding is not None]
    winding = Winding(**abreast(windings)) if len(windings) == len(axes) else None
    return EffectOnAxes(
        effect,
        None if len(index) == len(models) else np.array(index),
        {key: per_axis([value[key] for value in values]) for key in values[0]},
        Axis(**abreast(axes, without="winding"), winding=winding),
        per_axis([0.0] * len(index)),
    )


def abreast(ones: Sequence[Any], without: str = "") -> dict[str, Any]:
    """Fields of dataclasses of numbers, but for one, as `per_axis` has them of all."""
    names = [field.name for field in fields(ones[0]) if field.name != without]
    return {name: per_axis([float(getattr(one, name)) for one in ones]) for name in names}


def per_axis(values: Sequence[float] | Array) -> Number:
    """Values of axes side by side, (axes,), as they are now; that of a lone axis as a number.

    NumPy's, which overflows to infinity as arrays do, where one of Python's raises an error.
    """
    return np.float64(values[0]) if len(values) == 1 else np.array(values, dtype=np.float64)


class Joints:
    """A joint of simulations side by side, all values on the motor's side, (axes,) each, or numbers of a lone axis.

    Attributes:
        step: of the integration - s.
        bristled: whether bristles carry the dry friction, which bend to the level of their direction.

    Args:
        model: of all simulations.
        field: gives a field of the model that each simulation may have for itself, to be written - (axes, ...).
        applied: torques that are applied to the joints beside the drive's, to be written - (axes, nv).
        joint: of the axis.
        ratio: of the gear before it, motor turns per turn of the joint.
        bristles: actuator whose bristles are the friction, if the model has one of this name.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        field: Callable[[str], Array],
        applied: Array,
        joint: str = AXIS,
        ratio: float = 1.0,
        bristles: str = BRISTLES,
    ) -> None:
        self._dof = int(model.joint(joint).dofadr[0])
        self._field, self._applied, self._ratio = field, applied[:, self._dof], ratio
        self._bristles = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, bristles)
        self.step, self.bristled = float(model.opt.timestep), self._bristles >= 0

    @classmethod
    def of(cls, batch: Batch, joint: str = AXIS, ratio: float = 1.0, bristles: str = BRISTLES) -> Joints:
        """Those of a batch."""
        return cls(batch.model, batch.expand, batch.bind("qfrc_applied"), joint, ratio, bristles)

    def set_torque(self, torque: Number) -> None:
        """Torque that is applied beside the drive's - N*m (N)."""
        self._applied[:] = self._ratio * torque

    def add_torque(self, torque: Number) -> None:
        """More of it in the same step - N*m (N)."""
        self._applied += self._ratio * torque

    def set_added_inertia(self, inertia: Number) -> None:
        """Inertia beyond that of the model - kg*m**2 (kg)."""
        armature, bare = self._armatures
        armature[:] = bare + self._ratio**2 * inertia

    def set_friction(self, level: Number) -> None:
        """Level of dry friction - N*m (N)."""
        self._levels[:] = level if self.bristled else self._ratio * level

    @cached_property
    def _armatures(self) -> tuple[Array, Array]:
        """Of each axis, and what the model has."""
        armature = self._field("dof_armature")[:, self._dof]
        return armature, armature.copy()

    @cached_property
    def _levels(self) -> NDArray[np.float64]:
        """Of friction, (k, axes)."""
        if self.bristled:
            return self._field("actuator_biasprm")[:, self._bristles, BRISTLE_LEVELS].T
        return self._field("dof_frictionloss")[:, self._dof : self._dof + 1].T


class SimulationJoint(Joints):
    """One joint of a simulation, beside whatever else is applied to it; what effects change is changed in its model."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joint: str, ratio: float, bristles: str) -> None:
        super().__init__(
            model, lambda name: getattr(model, name)[None], data.qfrc_applied[None], joint, ratio, bristles
        )
        self._given = 0.0

    def set_torque(self, torque: Number) -> None:
        """In the place of what was set before; what others apply stays."""
        self.add_torque(torque - self._given)

    def add_torque(self, torque: Number) -> None:
        """See `Joints`."""
        super().add_torque(torque)
        self._given += float(torque)
