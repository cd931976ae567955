"""Effects that MuJoCo does not make by itself: in every step they set friction, inertia and torque.

They act as at the middle of the step, which keeps the integration second order: MuJoCo's position is there already (see
`bench.plant.axis_model`), velocity is extrapolated from the last two steps. Friction levels combine as

    forward, backward = (K_0 + sum of excesses +- sum of differences/2)*product of factors, neither below zero,

of which MuJoCo's dry friction takes the mean, so that sticking stays exact, and a torque half of the difference.

Values are arrays (..., axes) of any library of the array API standard, axes side by side; of a lone axis they are
numbers, of which all that is computed costs a fraction. What effects remember is given and returned, so that a step is
a function, which may be traced and mapped.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Generic, NamedTuple, TypeVar

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.arrays import Array, namespace
from bench.effects.acting import (
    AXIS,
    BRISTLES,
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
from bench.effects.present import Present
from bench.effects.signals import Axis, Moment, Number, Winding
from bench.plant.axis_model import AxisModel

Kind = TypeVar("Kind", bound=Effect)
#: Makes NumPy's numbers and arrays those of a library.
Made = Callable[[Any], Number]

#: Places of the two friction levels among the parameters of a passive motor with bristles.
BRISTLE_LEVELS = slice(3, 5)


def numpys(value: Number) -> Number:
    """NumPy's own."""
    return value


class Remembered(NamedTuple):
    """What effects remember from one step to the next.

    Attributes:
        velocity: at the start of the last step - rad/s (m/s) - (..., axes).
        kept: by effects of the drive, in their order - N*m (N) - (..., k) each.
    """

    velocity: Number
    kept: tuple[Number, ...]


class Acts(NamedTuple):
    """What effects make of a step, (..., axes) each.

    Attributes:
        reported: effort that the drive reports - N*m (N).
        motor: torque of the motor - N*m (N).
        torque: that acts beside it - N*m (N).
        friction: level of dry friction - N*m (N); None where no effect changes it.
        inertia: beyond that of the model - kg*m**2 (kg); None where no effect changes it.
        memory: for the next step.
    """

    reported: Number
    motor: Number
    torque: Number
    friction: Number | None
    inertia: Number | None
    memory: Remembered


class SteppedEffects:
    """Ticked effects of axes side by side.

    Args:
        models: one for each axis.
        step: of the integration - s.
        bristled: of which axes bristles carry the dry friction, which bend to the level of their direction; bool, or
            (axes,).
        made: makes arrays of the library that steps.
    """

    def __init__(self, models: Sequence[AxisModel], step: float, bristled: Number = False, made: Made = numpys) -> None:
        self._step, self._none = step, made(per_axis([0.0] * len(models)))
        self._coulomb = made(per_axis([model.parameters.coulomb_friction for model in models]))
        self._bristled = made(np.squeeze(bristled)) if np.any(bristled) else None
        self._flowing = on_axes(models, DriveLimit, made)
        self._acting = on_axes(models, TorqueLag, made)
        self._delivered = on_axes(models, TorqueLoss, made)
        self._acted = on_axes(models, MisreadEffort, made)
        self._excesses = on_axes(models, RaisesFriction, made, ticked=True)
        self._scales = on_axes(models, ScalesFriction, made, ticked=True)
        self._differences = on_axes(models, DirectedFriction, made, ticked=True)
        self._loads = on_axes(models, LoadTorque, made) if on_axes(models, FollowsLoad) else []
        self._inertia = on_axes(models, VaryingInertia, made, ticked=True)
        self._resisting = on_axes(models, ResistingTorque, made, ticked=True)
        self._factors = on_axes(models, ScalesTorque, made, ticked=True)

    def start(self, velocity: Number) -> Remembered:
        """Before a first step, of a velocity - rad/s (m/s) - (..., axes)."""
        return Remembered(velocity, tuple(0.0 * some.of(velocity) for some in (*self._flowing, *self._acting)))

    def again(self, memory: Remembered, where: Number, velocity: Number) -> Remembered:
        """A memory that begins anew with a velocity - rad/s (m/s) - where a bool is true, (..., axes) each."""
        xp, drives = namespace(velocity), (*self._flowing, *self._acting)
        kept = [xp.where(some.of(where), 0.0 * one, one) for some, one in zip(drives, memory.kept, strict=True)]
        return Remembered(xp.where(where, velocity, memory.velocity), tuple(kept))

    def act(
        self,
        memory: Remembered,
        time: Number,
        position: Number,
        velocity: Number,
        demand: Number,
        began: Number = 0.0,
    ) -> Acts:
        """What acts in the next step; of a lone axis everything may be numbers. Velocities must not change afterwards.

        Args:
            memory: of the step before.
            time: at the start of the step, since the recording's start - s - one for all axes, or (..., axes).
            position: MuJoCo's, half a step on - rad (m) - (..., axes).
            velocity: at the start of the step - rad/s (m/s) - (..., axes).
            demand: effort that the drive asks for - N*m (N) - (..., axes).
            began: the recording, as `Moment` has it - s - one for all axes, or (axes,).
        """
        middle, time = 1.5 * velocity - 0.5 * memory.velocity, time + 0.5 * self._step
        reported, torque, kept = self._driven(memory.kept, time, middle, demand)
        at = Moment(time, position, middle, torque, began)
        if self._factors:
            for some in self._factors:
                factor = some.effect.torque_factor(some.values, some.axis, some.moment(at))
                torque = some.with_these(torque, some.of(torque) * factor)
            at = Moment(time, position, middle, torque, began)
        friction, offset = self._friction(at)
        applied = self._none - offset
        for some in self._resisting:
            resisting = some.effect.resisting_torque(some.values, some.axis, some.moment(at))
            applied = some.with_these(applied, some.of(applied) - resisting)
        inertia = None
        for some in self._inertia:
            before = self._none if inertia is None else inertia
            more = some.effect.added_inertia(some.values, some.axis, some.moment(at))
            inertia = some.with_these(before, some.of(before) + more)
        return Acts(reported, torque, applied, friction, inertia, Remembered(velocity, kept))

    def _driven(
        self, before: tuple[Number, ...], time: Number, velocity: Number, demand: Number
    ) -> tuple[Number, Number, tuple[Number, ...]]:
        """In the order of the signal: what flows of a demand, what that truly is, what acts, what torque it makes.

        Returns what is reported, the torque, and what is kept of both.
        """
        reported, kept, memories = demand, [], iter(before)
        for some in self._flowing:
            wanted, speed = some.of(demand), some.of(velocity)
            flows, end = some.effect.flowing(some.values, some.axis, speed, wanted, next(memories), self._step)
            reported = some.with_these(reported, flows)
            kept.append(end)
        torque = reported
        for some in self._acted:
            torque = some.with_these(torque, some.effect.acted(some.values, some.axis, some.of(torque), some.of(time)))
        for some in self._acting:
            acts, end = some.effect.acting(some.values, some.of(torque), next(memories), self._step)
            torque = some.with_these(torque, acts)
            kept.append(end)
        for some in self._delivered:
            torque = some.with_these(torque, some.effect.delivered(some.values, some.axis, some.of(torque)))
        return reported, torque, tuple(kept)

    def _friction(self, at: Moment) -> tuple[Number | None, Number]:
        """Mean level of dry friction over both directions, None where no effect changes it, and half the difference."""
        if not (self._excesses or self._scales or self._differences):
            return None, 0.0
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
        for some in self._scales:
            factor = some.effect.friction_factor(some.values, some.axis, some.moment(at))
            level, half = (some.with_these(each, some.of(each) * factor) for each in (level, half))
        xp = namespace(level)
        if not self._differences:
            return xp.maximum(level, 0.0), 0.0
        forward, backward = xp.maximum(level + half, 0.0), xp.maximum(level - half, 0.0)
        mean, offset = 0.5 * (forward + backward), 0.5 * (forward - backward)
        if self._bristled is not None:  # bristles bend to the level of their direction, and hold no torque beside
            mean = xp.where(self._bristled, xp.where(at.velocity > 0.0, forward, backward), mean)
            offset = xp.where(self._bristled, self._none, offset)
        return mean, offset


@dataclass(frozen=True)
class EffectOnAxes(Generic[Kind]):
    """One effect on some axes of several.

    Attributes:
        effect: what it is.
        count: of all axes.
        index: of those that have it, (k,); None where all do.
        places: of each axis (axes,) among values of all axes, followed by those of these; None where all have it.
        values: of its quantities, (k,) each, or numbers of a lone axis.
        axis: constants of these axes, alike.
    """

    effect: Kind
    count: int
    index: Number | None
    places: Number | None
    values: dict[str, Number]
    axis: Axis

    def moment(self, at: Moment) -> Moment:
        """What these axes see of a moment."""
        if self.index is None:
            return at
        return Moment(*(self.of(each) for each in (at.time, at.position, at.velocity, at.effort, at.began, at.load)))

    def of(self, values: Number) -> Number:
        """Of values of all axes, or one for all, those of these axes."""
        if self.index is None or np.shape(values)[-1:] != (self.count,):
            return values
        return namespace(values).take(values, self.index, axis=-1)

    def with_these(self, values: Number, these: Number) -> Number:
        """Values of all axes with those of these axes in their places; what came in stays as it is."""
        if self.index is None:
            return these
        xp, lead = namespace(these), np.broadcast_shapes(values.shape[:-1], these.shape[:-1])
        both = [xp.broadcast_to(each, (*lead, each.shape[-1])) for each in (values, these)]
        return xp.take(xp.concat(both, axis=-1), self.places, axis=-1)


def on_axes(
    models: Sequence[AxisModel], kind: type[Kind], made: Made = numpys, ticked: bool = False
) -> list[EffectOnAxes[Kind]]:
    """Effects of a kind, in the order of their names; an effect that an axis has twice makes two of them.

    With `ticked` only those that MuJoCo does not make by itself; arrays are `made` those of a library.
    """
    found: dict[tuple[str, int], dict[int, Present]] = {}
    for row, model in enumerate(models):
        count: Counter[str] = Counter()
        for present in model.of_kind(kind):
            if not ticked or present in model.ticked:
                found.setdefault((present.name, count[present.name]), {})[row] = present
                count[present.name] += 1
    return [_gathered(models, found[key], kind, made) for key in sorted(found)]


def _gathered(
    models: Sequence[AxisModel], having: Mapping[int, Present], kind: type[Kind], made: Made
) -> EffectOnAxes[Kind]:
    """An effect on the axes that have it."""
    index, values = list(having), [dict(present.values) for present in having.values()]
    effect = having[index[0]].effect
    assert isinstance(effect, kind)
    axes = [models[row].axis for row in index]
    windings = [axis.winding for axis in axes if axis.winding is not None]
    winding = Winding(**stacked(windings, made=made)) if len(windings) == len(axes) else None
    places = np.arange(len(models))
    places[index] = len(models) + np.arange(len(index))
    everywhere = len(index) == len(models)
    return EffectOnAxes(
        effect,
        len(models),
        None if everywhere else made(np.array(index)),
        None if everywhere else made(places),
        {key: made(per_axis([value[key] for value in values])) for key in values[0]},
        Axis(**stacked(axes, without="winding", made=made), winding=winding),
    )


def stacked(ones: Sequence[Any], without: str = "", made: Made = numpys) -> dict[str, Any]:
    """Fields of dataclasses of numbers, but for one, as `per_axis` has them of all."""
    names = [field.name for field in fields(ones[0]) if field.name != without]
    return {name: made(per_axis([float(getattr(one, name)) for one in ones])) for name in names}


def per_axis(values: Sequence[float] | Array) -> Number:
    """Values of axes side by side, (axes,), as they are now; that of a lone axis as a number.

    NumPy's, which overflows to infinity as arrays do, where one of Python's raises an error.
    """
    return np.float64(values[0]) if len(values) == 1 else np.array(values, dtype=np.float64)


class Joints:
    """Joints of simulations side by side, to which what effects make of a step is written, in the joints' own units.

    Args:
        model: of all simulations.
        field: gives a field of the model that each simulation may have for itself, to be written - (simulations, ...).
        applied: torques that are applied beside those of actuators, to be written - (simulations, nv).
        joints: of each simulation, by name.
        bristles: of each joint the actuator whose bristles are its friction, if the model has one of this name.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        field: Callable[[str], Number],
        applied: Number,
        joints: Sequence[str] = (AXIS,),
        bristles: Sequence[str] = (BRISTLES,),
    ) -> None:
        dofs = [int(model.joint(name).dofadr[0]) for name in joints]
        self._columns = slice(dofs[0], dofs[0] + 1) if len(dofs) == 1 else dofs
        self._field, self._applied, self._count = field, applied, len(dofs)
        kind = mujoco.mjtObj.mjOBJ_ACTUATOR
        self._bristles = [mujoco.mj_name2id(model, kind, name) for name in bristles]
        self.bristled: NDArray[np.bool_] = np.array(self._bristles) >= 0
        self._dry, self._bending = not self.bristled.all(), [int(k) for k in np.flatnonzero(self.bristled)]

    @classmethod
    def of(cls, batch: Batch) -> Joints:
        """The axis of each simulation of a batch."""
        return cls(batch.model, batch.expand, batch.bind("qfrc_applied"))

    def take(self, acts: Acts) -> None:
        """What acts in the next step: values (simulations, joints), or (simulations*joints,), or for all."""
        self.apply(self._on_rows(acts.torque))
        if acts.inertia is not None:
            armature, bare = self._armatures
            armature[:, self._columns] = bare + self._on_rows(acts.inertia)
        if acts.friction is not None:
            level = self._on_rows(acts.friction)
            if self._dry:
                self._field("dof_frictionloss")[:, self._columns] = level
            for k in self._bending:
                own = level[:, k : k + 1] if np.ndim(level) else level
                self._field("actuator_biasprm")[:, self._bristles[k], BRISTLE_LEVELS] = own

    def apply(self, torque: Number) -> None:
        """Apply a torque beside those of actuators - N*m (N)."""
        self._applied[:, self._columns] = torque

    def restore_inertia(self) -> None:
        """Take what effects added to the joints' inertia off again."""
        if "_armatures" in self.__dict__:
            armature, bare = self._armatures
            armature[:, self._columns] = bare

    def _on_rows(self, values: Number) -> Number:
        return values.reshape(-1, self._count) if np.ndim(values) else values

    @cached_property
    def _armatures(self) -> tuple[Number, Number]:
        """Of all joints of the model, and what it has at these."""
        armature = self._field("dof_armature")
        return armature, armature[:, self._columns] + 0.0
