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
from typing import Any, Generic, NamedTuple, TypeAlias, TypeVar, cast

import numpy as np

from bench.arrays import Array, namespace
from bench.effects.effect import DriveLimit, Effect, Lag, Stage
from bench.effects.present import Present
from bench.effects.signals import Axis, AxisState, Number, Winding
from bench.effects.torque import Friction, Inertia, Torque
from bench.plant.axis_model import AxisModel

Kind = TypeVar("Kind", bound=Effect)
Kind_co = TypeVar("Kind_co", bound=Effect, covariant=True)
#: Makes NumPy's numbers and arrays those of a library.
Made = Callable[[Any], Number]


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
    """The results of effects in a step, (..., axes) each.

    Attributes:
        reported: effort that the drive reports - N*m (N).
        motor: torque of the motor - N*m (N).
        torque: of others - N*m (N).
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
        everything = on_axes(models, made)
        self._flowing = of_kind(everything, DriveLimit)
        self._lags = [some for some in of_kind(everything, Lag) if some.effect.signal == "torque"]
        torques, ticked = of_kind(everything, Torque), of_kind(on_axes(models, made, ticked=True), Torque)
        self._sensors = [some for some in torques if some.effect.stage == Stage.CURRENT_SENSOR]
        self._motor = [some for some in torques if some.effect.stage == Stage.TORQUE_CONSTANT]
        self._motor += [some for some in ticked if some.effect.stage == Stage.COMMUTATION]
        self._electric = bool(self._flowing or self._sensors or self._lags or self._motor)
        follow = any(some.effect.follows_load for some in torques)
        self._loads = [some for some in torques if some.effect.transmitted] if follow else []
        mechanics = [some for some in ticked if some.effect.stage == Stage.MECHANICS]
        self._resisting = [some for some in mechanics if type(some.effect).torque is not Friction.torque]
        self._inertia = of_kind(ticked, Inertia)
        # stable: those that add before those that scale what is added
        self._frictions = sorted(of_kind(ticked, Friction), key=lambda some: some.effect.scales_friction)
        self._directed = any(some.effect.directed for some in self._frictions)

    def start(self, velocity: Number) -> Remembered:
        """Before a first step, of a velocity - rad/s (m/s) - (..., axes)."""
        return Remembered(velocity, tuple(0.0 * some.of(velocity) for some in (*self._flowing, *self._lags)))

    def again(self, memory: Remembered, where: Number, velocity: Number) -> Remembered:
        """A memory that begins again with a velocity - rad/s (m/s) - where a bool is true, (..., axes) each."""
        xp, drives = namespace(velocity), (*self._flowing, *self._lags)
        kept = [xp.where(some.of(where), 0.0 * one, one) for some, one in zip(drives, memory.kept, strict=True)]
        return Remembered(xp.where(where, velocity, memory.velocity), tuple(kept))

    def act(
        self, memory: Remembered, time: Number, position: Number, velocity: Number, demand: Number, began: Number = 0.0
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
        step = self._step
        middle = 1.5 * velocity - 0.5 * memory.velocity
        at = AxisState(time + 0.5 * step, position, middle, demand, began, 0.0, 0.0, 1.0, step)
        reported, torque, kept = demand, demand, ()
        if self._electric:
            reported, torque, kept = self._driven(memory.kept, at)
            at = at._replace(effort=torque)
        friction, applied = self._friction(at)
        for some in self._resisting:
            applied = some.changed(_resisted, applied, at)
        inertia = None
        for some in self._inertia:
            inertia = some.changed(_laden, self._none if inertia is None else inertia, at)
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
        torque = reported
        for some in self._sensors:
            torque = some.changed(_lost, torque, at)
        for some in self._lags:
            acts, end = some.effect.stepped(some.values, some.of(torque), next(memories), self._step)
            torque = some.with_these(torque, acts)
            kept.append(end)
        for some in self._motor:
            torque = some.changed(_lost, torque, at)
        return reported, torque, tuple(kept)

    def _friction(self, at: AxisState) -> tuple[Number | None, Number]:
        """Mean level of dry friction over both directions, None where no effect changes it; torque of half of their
        difference.
        """
        if not self._frictions:
            return None, self._none
        if self._loads:
            load = self._none  # that the transmission carries
            for some in self._loads:
                load = some.changed(_carried, load, at)
            at = at._replace(load=load)
        forward = _not_below_zero(self._level(at))
        if not self._directed:
            return forward, self._none
        backward = _not_below_zero(self._level(at.of_direction(-1.0)))
        mean, offset = 0.5 * (forward + backward), 0.5 * (backward - forward)
        if self._bristled is not None:  # bristles bend to the level of their direction, and no torque acts with them
            xp = namespace(at.velocity)
            mean = xp.where(self._bristled, xp.where(at.velocity > 0.0, forward, backward), mean)
            offset = xp.where(self._bristled, self._none, offset)
        return mean, offset

    def _level(self, at: AxisState) -> Number:
        """Level of dry friction in one direction."""
        level = self._coulomb
        for some in self._frictions:
            level = some.changed(_rubbed, level, at)
        return level


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

    def changed(self, change: Change[Kind_co], values: Number, at: AxisState) -> Number:
        """Values of all axes, changed by the effect on those that have it, in a state of all."""
        if self.index is None:
            return change(self, values, at)
        return self.with_these(values, change(self, self.of(values), AxisState(*(self.of(each) for each in at))))

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


#: The result of an effect on some axes from values of these, in their state.
Change: TypeAlias = Callable[[EffectOnAxes[Kind], Number, AxisState], Number]


def _resisted(some: EffectOnAxes[Torque], applied: Number, at: AxisState) -> Number:
    """Applied torque less the effect's."""
    return applied - some.effect.torque(some.values, some.axis, at)


def _lost(some: EffectOnAxes[Torque], effort: Number, at: AxisState) -> Number:
    """Effort that reaches the effect, less what it takes of that."""
    return effort - some.effect.torque(some.values, some.axis, at._replace(effort=effort))


def _carried(some: EffectOnAxes[Torque], load: Number, at: AxisState) -> Number:
    """Torque of the load with the effect's."""
    return load + some.effect.torque(some.values, some.axis, at)


def _laden(some: EffectOnAxes[Inertia], inertia: Number, at: AxisState) -> Number:
    """Inertia with the effect's."""
    return inertia + some.effect.inertia(some.values, some.axis, at.position)[0]


def _rubbed(some: EffectOnAxes[Friction], level: Number, at: AxisState) -> Number:
    """Level of dry friction with the effect's."""
    at = at.of_friction(level) if some.effect.scales_friction else at
    return level + some.effect.friction(some.values, some.axis, at)


def _not_below_zero(level: Number) -> Number:
    return namespace(level).maximum(level, 0.0)


def on_axes(models: Sequence[AxisModel], made: Made, ticked: bool = False) -> list[EffectOnAxes[Effect]]:
    """Effects in the order of their names, an effect that an axis has twice as two; arrays are `made` a library's.

    With `ticked` only those that MuJoCo does not make by itself.
    """
    found: dict[tuple[str, int], dict[int, Present]] = {}
    for row, model in enumerate(models):
        count: Counter[str] = Counter()
        for present in model.ticked if ticked else model.effects:
            found.setdefault((present.name, count[present.name]), {})[row] = present
            count[present.name] += 1
    return [_gathered(models, found[key], made) for key in sorted(found)]


def of_kind(effects: Sequence[EffectOnAxes[Effect]], kind: type[Kind]) -> list[EffectOnAxes[Kind]]:
    """Those of a kind, in their order."""
    return [cast(EffectOnAxes[Kind], some) for some in effects if isinstance(some.effect, kind)]


def _gathered(models: Sequence[AxisModel], having: Mapping[int, Present], made: Made) -> EffectOnAxes[Effect]:
    """An effect on the axes that have it."""
    index, values = list(having), [dict(present.values) for present in having.values()]
    axes = [models[row].axis for row in index]
    windings = [axis.winding for axis in axes if axis.winding is not None]
    winding = Winding(**stacked(windings, made)) if len(windings) == len(axes) else None
    places = np.arange(len(models))
    places[index] = len(models) + np.arange(len(index))
    everywhere = len(index) == len(models)
    return EffectOnAxes(
        having[index[0]].effect,
        len(models),
        None if everywhere else made(np.array(index)),
        None if everywhere else made(places),
        {key: made(per_axis([value[key] for value in values])) for key in values[0]},
        Axis(**stacked(axes, made, without="winding"), winding=winding),
    )


def stacked(ones: Sequence[Any], made: Made, without: str = "") -> dict[str, Any]:
    """Fields of dataclasses of numbers, but for one, as `per_axis` has them of all."""
    names = [field.name for field in fields(ones[0]) if field.name != without]
    return {name: made(per_axis([float(getattr(one, name)) for one in ones])) for name in names}


def per_axis(values: Sequence[float] | Array) -> Number:
    """Values of axes side by side, (axes,), as they are now; that of a lone axis as a number.

    NumPy's, which overflows to infinity as arrays do, where one of Python's raises an error.
    """
    return np.float64(values[0]) if len(values) == 1 else np.array(values, dtype=np.float64)
