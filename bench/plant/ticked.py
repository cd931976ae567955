"""Effects that MuJoCo does not make by itself: in every step they set friction, inertia and torque of a batch of axes.

They act as at the middle of the step, which keeps the integration second order: MuJoCo's position is there already (see
`bench.plant.model`), velocity is extrapolated from the last two steps. Friction levels combine as

    forward, backward = (K_0 + sum of excesses +- sum of differences/2)*product of factors, neither below zero,

of which MuJoCo's dry friction takes the mean, so that sticking stays exact, and a torque half of the difference.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.effects.kinds import Electronics, Friction, Mechanism, Moment, Number, Sensing
from bench.plant.axis_model import AxisModel
from bench.plant.rows import Rows, abreast, gather
from bench.plant.seat import Seat


class TickedEffects:
    """Ticked effects of axes side by side.

    Args:
        seat: where MuJoCo has the axes.
        models: one for each of them.
        velocity: they start with - rad/s (m/s) - (axes,), or a number of a lone axis.
    """

    def __init__(self, seat: Seat, models: Sequence[AxisModel], velocity: Number) -> None:
        self._seat, self._step = seat, seat.step
        self._none = abreast([0.0] * len(models))
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
        self._before = velocity
        reported, torque = self._driven(time + 0.5 * self._step, middle, demand)
        at = Moment(time + 0.5 * self._step, position, middle, torque, began)
        if self._factors:
            for rows in self._factors:
                factor = rows.effect.torque_factor(rows.values, rows.axis, rows.moment(at))
                torque = rows.put(torque, rows.of(torque) * factor)
            at = Moment(at.time, position, middle, torque, began)
        applied = self._none - self._friction.offset(at)
        for rows in self._resisting:
            resisting = rows.effect.resisting_torque(rows.values, rows.axis, rows.moment(at))
            applied = rows.put(applied, rows.of(applied) - resisting)
        self._seat.set_torque(applied)
        if self._inertia:
            added = self._none
            for rows in self._inertia:
                more = rows.effect.added_inertia(rows.values, rows.axis, rows.moment(at))
                added = rows.put(added, rows.of(added) + more)
            self._seat.set_added_inertia(added)
        return reported, torque

    def _driven(self, time: Number, velocity: Number, demand: Number) -> tuple[Number, Number]:
        """In the order of the signal: what flows of a demand, what that truly is, what acts, what torque it makes."""
        reported = demand
        for rows in self._flowing:
            wanted, speed = rows.of(demand), rows.of(velocity)
            flows, rows.memory = rows.effect.flowing(rows.values, rows.axis, speed, wanted, rows.memory, self._step)
            reported = rows.put(reported, flows)
        torque = reported
        for rows in self._acted:
            torque = rows.put(torque, rows.effect.acted(rows.values, rows.axis, rows.of(torque), rows.of(time)))
        for rows in self._acting:
            acts, rows.memory = rows.effect.acting(rows.values, rows.of(torque), rows.memory, self._step)
            torque = rows.put(torque, acts)
        for rows in self._delivered:
            torque = rows.put(torque, rows.effect.delivered(rows.values, rows.axis, rows.of(torque)))
        return reported, torque


class _FrictionLevels:
    """The level of dry friction, where effects change it in every step."""

    def __init__(self, seat: Seat, models: Sequence[AxisModel]) -> None:
        mechanisms = gather(models, Friction, ticked=True)
        self._coulomb = abreast([model.parameters.coulomb_friction for model in models])
        self._none = abreast([0.0] * len(models))
        self._excesses = _through(mechanisms, "friction_excess")
        self._factors = _through(mechanisms, "friction_factor")
        self._differences = _through(mechanisms, "friction_difference")
        self._under_load = _through(mechanisms, "friction_under_load")
        self._loads = _through(gather(models, Mechanism), "load_torque") if self._under_load else []
        self._seat = seat
        self._changes = bool(self._excesses or self._factors or self._differences or self._under_load)

    def offset(self, at: Moment) -> Number:
        """Set the level; returns half the difference of the two directions' levels - N*m (N) - (axes,)."""
        if not self._changes:
            return 0.0
        level = self._coulomb
        for rows in self._excesses:
            excess = rows.effect.friction_excess(rows.values, rows.axis, rows.moment(at))
            level = rows.put(level, rows.of(level) + excess)
        if self._under_load:
            level = self._with_load(level, at)
        half = self._none
        for rows in self._differences:
            difference = rows.effect.friction_difference(rows.values, rows.axis)
            half = rows.put(half, rows.of(half) + 0.5 * difference)
        for rows in self._factors:
            factor = rows.effect.friction_factor(rows.values, rows.axis, rows.moment(at))
            level, half = (rows.put(each, rows.of(each) * factor) for each in (level, half))
        if not self._differences:
            self._seat.set_friction(np.maximum(level, 0.0))
            return 0.0
        forward, backward = np.maximum(level + half, 0.0), np.maximum(level - half, 0.0)
        if self._seat.bristled:  # which bend to the level of their direction, and hold no torque beside
            self._seat.set_friction(np.where(at.velocity > 0.0, forward, backward))
            return 0.0
        self._seat.set_friction(0.5 * (forward + backward))
        return 0.5 * (forward - backward)

    def _with_load(self, level: Number, at: Moment) -> Number:
        """The level with what the transmitted torque adds to it - N*m (N) - (axes,)."""
        load = self._none
        for rows in self._loads:
            load = rows.put(load, rows.of(load) + rows.effect.load_torque(rows.values, rows.moment(at)))
        for rows in self._under_load:
            pulled = rows.effect.friction_under_load(rows.values, rows.axis, rows.moment(at), rows.of(load))
            level = rows.put(level, rows.of(level) + pulled)
        return level


def _through(rows: Sequence[Rows], hook: str) -> list[Rows]:
    return [some for some in rows if some.effect.overrides(hook)]
