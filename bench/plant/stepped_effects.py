"""Effects that MuJoCo does not make by itself: in every step they set friction, inertia and torque.

They act as at the middle of the step, which keeps the integration second order: MuJoCo's position is there already (see
`bench.plant.axis_model`), velocity is extrapolated from the last two steps. Friction levels combine as

    forward, backward = (K_0 + sum of what is added in the direction)*product of factors, neither below zero,

of which MuJoCo's dry friction takes the mean, so that sticking stays exact, and a torque half of the difference.

Values are arrays (..., axes) of any library of the array API standard, axes side by side; of a lone axis they are
numbers, of which all that is computed costs a fraction. What effects remember is given and returned, so that a step is
a function, which may be traced and mapped.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Generic, NamedTuple, TypeVar, cast

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.arrays import Array, namespace
from bench.effects.effect import DriveLimit, Effect, Lag, Stage
from bench.effects.mjcf import AXIS, BRISTLES
from bench.effects.present import Present
from bench.effects.signals import Axis, AxisState, Number, Winding
from bench.effects.torque import Friction, Inertia, Torque
from bench.plant.axis_model import AxisModel

Kind = TypeVar("Kind", bound=Effect)
Kind_co = TypeVar("Kind_co", bound=Effect, covariant=True)
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
        everything = on_axes(models, Effect, made)
        self._flowing = of_kind(everything, DriveLimit)
        self._lags = [some for some in of_kind(everything, Lag) if some.effect.signal == "torque"]
        torques = of_kind(everything, Torque)
        self._sensors, self._motor = (
            [some for some in torques if some.effect.stage == stage]
            for stage in (Stage.CURRENT_SENSOR, Stage.TORQUE_CONSTANT)
        )
        follow = any(some.effect.follows_load for some in torques)
        self._loads = [some for some in torques if some.effect.transmitted] if follow else []
        ticked = of_kind(on_axes(models, Effect, made, ticked=True), Torque)
        self._commutation = [some for some in ticked if some.effect.stage == Stage.COMMUTATION]
        self._resisting = [
            some
            for some in ticked
            if some.effect.stage == Stage.MECHANICS and type(some.effect).torque is not Friction.torque
        ]
        self._inertia = of_kind(ticked, Inertia)
        # stable: those that add before those that scale what is added
        self._frictions = sorted(of_kind(ticked, Friction), key=lambda some: some.effect.scales_friction)
        self._directed = any(some.effect.directed for some in self._frictions)

    def start(self, velocity: Number) -> Remembered:
        """Before a first step, of a velocity - rad/s (m/s) - (..., axes)."""
        return Remembered(velocity, tuple(0.0 * some.of(velocity) for some in (*self._flowing, *self._lags)))

    def again(self, memory: Remembered, where: Number, velocity: Number) -> Remembered:
        """A memory that begins anew with a velocity - rad/s (m/s) - where a bool is true, (..., axes) each."""
        xp, drives = namespace(velocity), (*self._flowing, *self._lags)
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
            began: the recording, as `AxisState` has it - s - one for all axes, or (axes,).
        """
        middle, time = 1.5 * velocity - 0.5 * memory.velocity, time + 0.5 * self._step
        at = AxisState(time, position, middle, demand, began, step=self._step)
        reported, torque, kept = self._driven(memory.kept, at)
        at = at._replace(effort=torque)
        friction, offset = self._friction(at)
        applied = self._none - offset
        for some in self._resisting:
            applied = some.with_these(applied, some.of(applied) - some.torque(at))
        inertia = None
        for some in self._inertia:
            before = self._none if inertia is None else inertia
            more, _ = some.effect.inertia(some.values, some.axis, some.of(position))
            inertia = some.with_these(before, some.of(before) + more)
        return Acts(reported, torque, applied, friction, inertia, Remembered(velocity, kept))

    def _driven(self, before: tuple[Number, ...], at: AxisState) -> tuple[Number, Number, tuple[Number, ...]]:
        """In the order of the signal: what flows of a demand, what that truly is, what acts, what torque it makes.

        Returns what is reported, the torque, and what is kept of both.
        """
        reported, kept, memories = at.effort, [], iter(before)
        for some in self._flowing:
            wanted, speed = some.of(at.effort), some.of(at.velocity)
            flows, end = some.effect.flowing(some.values, some.axis, speed, wanted, next(memories), self._step)
            reported = some.with_these(reported, flows)
            kept.append(end)
        torque = _less(reported, self._sensors, at)
        for some in self._lags:
            acts, end = some.effect.stepped(some.values, some.of(torque), next(memories), self._step)
            torque = some.with_these(torque, acts)
            kept.append(end)
        return reported, _less(_less(torque, self._motor, at), self._commutation, at), tuple(kept)

    def _friction(self, at: AxisState) -> tuple[Number | None, Number]:
        """Mean level of dry friction over both directions, None where no effect changes it, and half the difference."""
        if not self._frictions:
            return None, 0.0
        if self._loads:
            load = self._none  # that the transmission carries
            for some in self._loads:
                load = some.with_these(load, some.of(load) + some.torque(at))
            at = at._replace(load=load)
        xp, forward = namespace(self._coulomb), self._level(at)
        if not self._directed:
            return xp.maximum(forward, 0.0), 0.0
        backward = xp.maximum(self._level(at._replace(direction=-1.0)), 0.0)
        forward = xp.maximum(forward, 0.0)
        mean, offset = 0.5 * (forward + backward), 0.5 * (forward - backward)
        if self._bristled is not None:  # bristles bend to the level of their direction, and no torque acts with them
            mean = xp.where(self._bristled, xp.where(at.velocity > 0.0, forward, backward), mean)
            offset = xp.where(self._bristled, self._none, offset)
        return mean, offset

    def _level(self, at: AxisState) -> Number:
        """Level of dry friction in one direction."""
        level = self._coulomb
        for some in self._frictions:
            these, state = some.of(level), some.state(at)
            if some.effect.scales_friction:
                state = state._replace(friction=these)
            level = some.with_these(level, these + some.effect.friction(some.values, some.axis, state))
        return level


def _less(effort: Number, effects: Sequence[EffectOnAxes[Torque]], at: AxisState) -> Number:
    """Effort that remains of one after what each of some effects takes."""
    for some in effects:
        reached = some.of(effort)
        effort = some.with_these(effort, reached - some.torque(at._replace(effort=effort)))
    return effort


@dataclass(frozen=True)
class EffectOnAxes(Generic[Kind_co]):
    """One effect on some axes of several.

    Attributes:
        effect: what it is.
        count: of all axes.
        index: of those that have it, (k,); None where all do.
        places: of each axis (axes,) among values of all axes, followed by those of these; None where all have it.
        values: of its quantities, (k,) each, or numbers of a lone axis.
        axis: constants of these axes, alike.
    """

    effect: Kind_co
    count: int
    index: Number | None
    places: Number | None
    values: dict[str, Number]
    axis: Axis

    def state(self, at: AxisState) -> AxisState:
        """State of these axes."""
        return at if self.index is None else AxisState(*(self.of(each) for each in at))

    def torque(self: EffectOnAxes[Torque], at: AxisState) -> Number:
        """Its torque on these axes, in a state of all."""
        return self.effect.torque(self.values, self.axis, self.state(at))

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


def of_kind(effects: Sequence[EffectOnAxes[Effect]], kind: type[Kind]) -> list[EffectOnAxes[Kind]]:
    """Those of a kind, in their order."""
    return [cast(EffectOnAxes[Kind], some) for some in effects if isinstance(some.effect, kind)]


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
