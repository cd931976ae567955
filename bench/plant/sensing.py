"""What drive and recording have of motion and current: sensors' faults are in both, filters in the recording alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.arrays import Array
from bench.effects.kinds import Number, Sensing
from bench.effects.present import Present
from bench.plant.axis_model import AxisModel
from bench.plant.rows import Rows
from bench.plant.states import States


def seen_by_drive(encoders: Sequence[Rows], position: Number, velocity: Number) -> tuple[Number, Number]:
    """What the drives of axes side by side have of their true motion, (axes,) each."""
    for rows in encoders:
        turned, moving = rows.effect.seen(rows.values, rows.of(position), rows.of(velocity))
        position, velocity = rows.put(position, turned), rows.put(velocity, moving)
    return position, velocity


def reported(model: AxisModel, position: Array, velocity: Array, step: float) -> tuple[Array, Array]:
    """What sensors report of one axis' true motion, (n,) each at a constant step - s."""
    position, velocity = seen(model, position, velocity)
    return position, filtered(model, velocity, step)


def seen(model: AxisModel, position: Array, velocity: Array) -> tuple[Array, Array]:
    """What the encoder of one axis sees of its true motion, (n,) each, instant by instant."""
    for present, effect in _pairs(model.of_kind(Sensing)):
        position, velocity = effect.seen(dict(present.values), position, velocity)
    return position, velocity


def filters(model: AxisModel) -> bool:
    """Whether the velocity that is recorded depends on what came before."""
    return any(effect.overrides("filtered") for _, effect in _pairs(model.of_kind(Sensing)))


def filtered(model: AxisModel, velocity: Array, step: float) -> Array:
    """What is recorded of the velocity that the encoder sees, (n,) at a constant step - s."""
    for present, effect in _pairs(model.of_kind(Sensing)):
        velocity = effect.filtered(dict(present.values), velocity, step)
    return velocity


def true_velocity(model: AxisModel, velocity: Array, step: float) -> Array:
    """Velocity that the encoder saw, from the reported one, (n,): filters undone."""
    for present, effect in reversed(_pairs(model.of_kind(Sensing))):
        velocity = effect.unfiltered(dict(present.values), velocity, step)
    return velocity


def true_motion(model: AxisModel, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Motion from what the encoder saw of it, (n,) each."""
    for present, effect in reversed(_pairs(model.of_kind(Sensing))):
        position, velocity = effect.unseen(dict(present.values), position, velocity)
    return position, velocity


def misreads_effort(model: AxisModel) -> bool:
    """Whether the effort that is recorded is not the one that acts."""
    effects = [effect for _, effect in _pairs(model.of_kind(Sensing))]
    return any(effect.overrides(hook) for effect in effects for hook in ("acted", "unrecorded"))


def true_effort(model: AxisModel, effort: Array, since: float, step: float) -> Array:
    """Effort of one axis that acted, from the recorded one, (n,) at a constant step - s - from an instant on - s."""
    pairs, time = _pairs(model.of_kind(Sensing)), since + step * np.arange(effort.size, dtype=np.float64)
    for present, effect in reversed(pairs):
        effort = effect.unrecorded(dict(present.values), effort, step)
    for present, effect in pairs:
        effort = effect.acted(dict(present.values), model.axis, effort, time)
    return effort


def reported_states(model: AxisModel, states: States) -> States:
    """A motion of one axis as its sensors report it."""
    step = float(states.time[1] - states.time[0])
    position, velocity = reported(model, states.position[:, 0], states.velocity[:, 0], step)
    torque = states.torque[:, 0]
    for present, effect in _pairs(model.of_kind(Sensing)):
        torque = effect.recorded(dict(present.values), torque, step)
    return replace(states, position=position[:, None], velocity=velocity[:, None], torque=torque[:, None])


def _pairs(sensing: Sequence[Present]) -> list[tuple[Present, Sensing]]:
    return [(present, present.effect) for present in sensing if isinstance(present.effect, Sensing)]
