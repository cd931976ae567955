"""What drive and recording have of motion and current: sensors' faults are in both, filters in the recording alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.arrays import Array
from bench.effects.acting import FilteredSignal, MisreadEffort, MisreadMotion
from bench.effects.axis import Number
from bench.plant.axis_model import AxisModel
from bench.plant.closed_loop import States
from bench.plant.stepped_effects import on_axes


class EncodersSideBySide:
    """Encoders of axes side by side, as their drives have them."""

    def __init__(self, models: Sequence[AxisModel]) -> None:
        self._encoders = on_axes(models, MisreadMotion)

    def seen(self, position: Number, velocity: Number) -> tuple[Number, Number]:
        """What the drives have of the axes' true motion - rad (m), rad/s (m/s) - (axes,) each."""
        for some in self._encoders:
            turned, moving = some.effect.seen(some.values, some.of(position), some.of(velocity))
            position, velocity = some.with_these(position, turned), some.with_these(velocity, moving)
        return position, velocity


def reported(model: AxisModel, position: Array, velocity: Array, step: float) -> tuple[Array, Array]:
    """What sensors report of one axis' true motion, (n,) each at a constant step - s."""
    for effect, values in model.acting(MisreadMotion):
        position, velocity = effect.seen(values, position, velocity)
    for effect, values in _filters(model, "velocity"):
        velocity = effect.recorded(values, velocity, step)
    return position, velocity


def filters(model: AxisModel) -> bool:
    """Whether the velocity that is recorded depends on what came before."""
    return bool(_filters(model, "velocity"))


def true_velocity(model: AxisModel, velocity: Array, step: float) -> Array:
    """Velocity that the encoder saw, from the reported one, (n,): filters undone."""
    for effect, values in reversed(_filters(model, "velocity")):
        velocity = effect.unrecorded(values, velocity, step)
    return velocity


def true_motion(model: AxisModel, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Motion from what the encoder saw of it, (n,) each."""
    for effect, values in reversed(model.acting(MisreadMotion)):
        position, velocity = effect.unseen(values, position, velocity)
    return position, velocity


def misreads_effort(model: AxisModel) -> bool:
    """Whether the effort that is recorded is not the one that acts."""
    return bool(model.of_kind(MisreadEffort) or _filters(model, "current"))


def true_effort(model: AxisModel, effort: Array, since: float, step: float) -> Array:
    """Effort of one axis that acted, from the recorded one, (n,) at a constant step - s - from an instant on - s."""
    time = since + step * np.arange(effort.size, dtype=np.float64)
    for effect, values in reversed(_filters(model, "current")):
        effort = effect.unrecorded(values, effort, step)
    for effect, values in model.acting(MisreadEffort):
        effort = effect.acted(values, model.axis, effort, time)
    return effort


def reported_states(model: AxisModel, states: States) -> States:
    """A motion of one axis as its sensors report it."""
    step = float(states.time[1] - states.time[0])
    position, velocity = reported(model, states.position[:, 0], states.velocity[:, 0], step)
    torque = states.torque[:, 0]
    for effect, values in _filters(model, "current"):
        torque = effect.recorded(values, torque, step)
    return replace(states, position=position[:, None], velocity=velocity[:, None], torque=torque[:, None])


def _filters(model: AxisModel, signal: str) -> list[tuple[FilteredSignal, dict[str, float]]]:
    return [(effect, values) for effect, values in model.acting(FilteredSignal) if effect.signal == signal]
