"""What drive and recording see of the motion, where sensors have effects: tick by tick, and along whole recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.effects.physics import Sensing
from bench.effects.present import Present
from bench.plant.axis_model import AxisModel
from bench.plant.rows import gather
from bench.plant.states import States

Array = NDArray[np.float64]


class Sensed:
    """Sensors of axes side by side, tick by tick: first the encoder, then the filters of velocity.

    Args:
        models: one for each axis.
        position, velocity: they start with - rad (m), rad/s (m/s) - (axes,).
        step: from tick to tick - s.
    """

    def __init__(self, models: Sequence[AxisModel], position: Array, velocity: Array, step: float) -> None:
        rows = gather(models, Sensing)
        self._encoders = [some for some in rows if some.effect.acts_through("seen")]
        self._filters = [some for some in rows if some.effect.acts_through("filtered")]
        self._step = step
        _, self._before = self._seen(position, velocity)
        for some in self._filters:
            some.memory = self._before[some.index].copy()

    def see(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """What is reported of the next tick's true position and velocity, (axes,) each."""
        position, now = self._seen(position, velocity)
        velocity = now.copy() if self._filters else now
        for rows in self._filters:
            i = rows.index
            rows.memory = rows.effect.filtered(rows.values, self._before[i], velocity[i], rows.memory, self._step)
            velocity[i] = rows.memory
        self._before = now
        return position, velocity

    def _seen(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        # copied, as both may be views of a batch that steps on
        position, velocity = position.copy(), velocity.copy()
        for rows in self._encoders:
            i = rows.index
            position[i], velocity[i] = rows.effect.seen(rows.values, position[i], velocity[i])
        return position, velocity


def reported(model: AxisModel, position: Array, velocity: Array, step: float) -> tuple[Array, Array]:
    """What sensors report of one axis' true motion, (n,) each at a constant step - s."""
    sensing = model.of_kind(Sensing)
    for present, effect in _pairs(sensing):
        position, velocity = effect.seen(dict(present.values), position, velocity)
    for present, effect in _pairs(sensing):
        velocity = effect.filtered_along(dict(present.values), velocity, step)
    return position, velocity


def true_velocity(model: AxisModel, velocity: Array, step: float) -> Array:
    """Velocity that the encoder saw, from the reported one, (n,): filters undone."""
    for present, effect in reversed(_pairs(model.of_kind(Sensing))):
        velocity = effect.unfiltered_along(dict(present.values), velocity, step)
    return velocity


def true_motion(model: AxisModel, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Motion from what the encoder saw of it, (n,) each."""
    for present, effect in reversed(_pairs(model.of_kind(Sensing))):
        position, velocity = effect.unseen(dict(present.values), position, velocity)
    return position, velocity


def reported_states(model: AxisModel, states: States) -> States:
    """A motion of one axis as its sensors report it."""
    step = float(states.time[1] - states.time[0])
    position, velocity = reported(model, states.position[:, 0], states.velocity[:, 0], step)
    return replace(states, position=position[:, None], velocity=velocity[:, None])


def _pairs(sensing: Sequence[Present]) -> list[tuple[Present, Sensing]]:
    return [(present, present.effect) for present in sensing if isinstance(present.effect, Sensing)]
