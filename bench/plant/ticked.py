"""Effects that MuJoCo does not make by itself: in every step they set friction, inertia and torque of a batch of axes.

They act as at the middle of the step, which keeps the integration second order: MuJoCo's position is there already (see
`bench.plant.model`), velocity is extrapolated from the last two steps. Friction levels combine as

    forward, backward = (K_0 + sum of excesses +- sum of differences/2)*product of factors, neither below zero,

of which MuJoCo's dry friction takes the mean, so that sticking stays exact, and a torque half of the difference.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.arrays import Array
from bench.effects.kinds import Electronics, Friction, Mechanism, Moment, Sensing
from bench.plant.axis_model import AxisModel
from bench.plant.rows import Rows, gather
from bench.plant.seat import Seat


class TickedEffects:
    """Ticked effects of axes side by side.

    Args:
        seat: where MuJoCo has the axes.
        models: one for each of them.
        velocity: they start with - rad/s (m/s) - (axes,).
    """

    def __init__(self, seat: Seat, models: Sequence[AxisModel], velocity: Array) -> None:
        self._seat, self._step = seat, seat.step
        self._mechanisms = gather(models, Mechanism, ticked=True)
        electronics = gather(models, Electronics)
        self._flowing = _through(electronics, "flowing")
        self._acting = _through(electronics, "acting")
        self._delivered = _through(electronics, "delivered")
        self._acted = _through(gather(models, Sensing), "acted")
        self._friction = _FrictionLevels(seat, models)
        self._inertia = _through(self._mechanisms, "added_inertia")
        self._resisting = _through(self._mechanisms, "resisting_torque")
        self._factors = _through(self._mechanisms, "torque_factor")
        self._before = velocity.copy()

    def act(
        self, time: float | Array, position: Array, velocity: Array, demand: Array, began: float | Array = 0.0
    ) -> tuple[Array, Array]:
        """Set up the next step; returns the effort that is reported and the motor's torque, (axes,) each.

        Args:
            time: at the start of the step, since the recording's start - s - one for all axes, or (axes,).
            position: MuJoCo's, half a step on - rad (m) - (axes,).
            velocity: at the start of the step - rad/s (m/s) - (axes,).
            demand: effort that the drive asks for - N*m (N) - (axes,).
            began: the recording, as `Moment` has it - s - one for all axes, or (axes,).
        """
        middle = 1.5 * velocity - 0.5 * self._before
        self._before = velocity.copy()
        reported, torque = self._driven(time + 0.5 * self._step, middle, demand)
        at = Moment(time + 0.5 * self._step, position, middle, torque, began)
        if self._factors:
            torque = torque.copy()
            for rows in self._factors:
                torque[rows.index] *= rows.effect.torque_factor(rows.values, rows.axis, rows.moment(at))
            at = Moment(at.time, position, middle, torque, began)
        applied = np.zeros_like(velocity) - self._friction.offset(at)
        for rows in self._resisting:
            applied[rows.index] -= rows.effect.resisting_torque(rows.values, rows.axis, rows.moment(at))
        self._seat.set_torque(applied)
        if self._inertia:
            added = np.zeros_like(velocity)
            for rows in self._inertia:
                added[rows.index] += rows.effect.added_inertia(rows.values, rows.axis, rows.moment(at))
            self._seat.set_added_inertia(added)
        return reported, torque

    def _driven(self, time: float | Array, velocity: Array, demand: Array) -> tuple[Array, Array]:
        """In the order of the signal: what flows of a demand, what that truly is, what acts, what torque it makes."""
        reported = demand.copy()
        for rows in self._flowing:
            i = rows.index
            flows = rows.effect.flowing(rows.values, rows.axis, velocity[i], demand[i], rows.memory, self._step)
            reported[i], rows.memory = flows
        torque = reported.copy()
        for rows in self._acted:
            at = time[rows.index] if isinstance(time, np.ndarray) else time
            torque[rows.index] = rows.effect.acted(rows.values, rows.axis, torque[rows.index], at)
        for rows in self._acting:
            i = rows.index
            torque[i], rows.memory = rows.effect.acting(rows.values, torque[i], rows.memory, self._step)
        for rows in self._delivered:
            torque[rows.index] = rows.effect.delivered(rows.values, rows.axis, torque[rows.index])
        return reported, torque


class _FrictionLevels:
    """The level of dry friction, where effects change it in every step."""

    def __init__(self, seat: Seat, models: Sequence[AxisModel]) -> None:
        mechanisms = gather(models, Friction, ticked=True)
        self._coulomb = np.array([model.parameters.coulomb_friction for model in models])
        self._excesses = _through(mechanisms, "friction_excess")
        self._factors = _through(mechanisms, "friction_factor")
        self._differences = _through(mechanisms, "friction_difference")
        self._under_load = _through(mechanisms, "friction_under_load")
        self._loads = _through(gather(models, Mechanism), "load_torque") if self._under_load else []
        self._seat = seat
        self._changes = bool(self._excesses or self._factors or self._differences or self._under_load)

    def offset(self, at: Moment) -> Array | float:
        """Set the level; returns half the difference of the two directions' levels - N*m (N) - (axes,)."""
        if not self._changes:
            return 0.0
        level = self._coulomb.copy()
        for rows in self._excesses:
            level[rows.index] += rows.effect.friction_excess(rows.values, rows.axis, rows.moment(at))
        if self._under_load:
            load = np.zeros(level.size)
            for rows in self._loads:
                load[rows.index] += rows.effect.load_torque(rows.values, rows.moment(at))
            for rows in self._under_load:
                values, axis, i = rows.values, rows.axis, rows.index
                level[i] += rows.effect.friction_under_load(values, axis, rows.moment(at), load[i])
        half = np.zeros(level.size)
        for rows in self._differences:
            half[rows.index] += 0.5 * rows.effect.friction_difference(rows.values, rows.axis)
        for rows in self._factors:
            factor = rows.effect.friction_factor(rows.values, rows.axis, rows.moment(at))
            level[rows.index] *= factor
            half[rows.index] *= factor
        if not self._differences:
            self._seat.set_friction(np.maximum(level, 0.0))
            return 0.0
        forward, backward = np.maximum(level + half, 0.0), np.maximum(level - half, 0.0)
        if self._seat.bristled:  # which bend to the level of their direction, and hold no torque beside
            self._seat.set_friction(np.where(at.velocity > 0.0, forward, backward))
            return 0.0
        self._seat.set_friction(0.5 * (forward + backward))
        return 0.5 * (forward - backward)


def _through(rows: Sequence[Rows], hook: str) -> list[Rows]:
    return [some for some in rows if some.effect.overrides(hook)]
