"""Many axes, integrated side by side: exact stick-slip between, second-order splitting around it.

A body under a constant torque with viscous and dry friction moves, stops and breaks away exactly (`move`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.validation.independent.effects import Effect, Rows
from bench.validation.independent.rig import Axis, stack

Array = NDArray[np.float64]


def speed_weight(rate: Array, time: Array) -> Array:
    """phi(t) = (1 - exp(-k*t))/k - s; t for k = 0. rate k = K_w/J - 1/s."""
    x = rate * time
    series = time * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0))))
    small = x < 1e-3
    if small.all():  # as of nearly every step
        return series
    return np.where(small, series, -np.expm1(-x) / np.where(rate > 0.0, rate, 1.0))


def distance_weight(rate: Array, time: Array) -> Array:
    """psi(t) = (t - phi(t))/k, the integral of phi - s**2; t**2/2 for k = 0."""
    x = rate * time
    series = time**2 / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0))))
    small = x < 1e-3
    if small.all():  # as of nearly every step
        return series
    return np.where(small, series, (time - speed_weight(rate, time)) / np.where(rate > 0.0, rate, 1.0))


def stopping_time(rate: Array, speed: Array, acceleration: Array) -> Array:
    """When w(t) = w0 + a0*phi(t) reaches zero, phi(t) = -w0/a0: t = -log(1 - k*phi)/k - s."""
    weight = -speed / acceleration
    x = rate * weight
    series = weight * (1.0 + x / 2.0 + x**2 / 3.0 + x**3 / 4.0 + x**4 / 5.0)
    return np.where(np.abs(x) < 1e-3, series, -np.log1p(-x) / np.where(rate > 0.0, rate, 1.0))


def breakaway(torque: Array, forward_level: Array, backward_level: Array) -> Array:
    """Direction in which a resting body starts: +1, -1, or 0 while |torque| stays within the friction level."""
    return np.where(torque > forward_level, 1.0, np.where(torque < -backward_level, -1.0, 0.0))


def move(
    speed: Array,
    torque: Array,
    forward_level: Array,
    backward_level: Array,
    inertia: Array,
    rate: Array,
    weights: tuple[Array, Array],
    step: float,
) -> tuple[Array, Array]:
    """Speed after `step`, and distance gone, of J*dw/dt = torque - K_w*w - level*sgn(w); all arguments constant in it.

    A body that comes to rest within the step stays there if the torque is within the level of the direction it pulls
    to, and starts again from the instant of rest otherwise.

    Args:
        speed, torque, inertia, rate: w - rad/s, M - N*m, J - kg*m**2, K_w/J - 1/s - (n,) each.
        forward_level, backward_level: dry friction against positive and negative motion - N*m - (n,).
        weights: phi and psi of the whole step - s, s**2 - (n,).
    """
    direction = np.sign(speed)
    if not direction.all():
        direction = np.where(direction == 0.0, breakaway(torque, forward_level, backward_level), direction)
    friction = np.where(direction > 0.0, forward_level, backward_level) * direction
    acceleration = (torque - friction) / inertia - rate * speed
    if not direction.all():
        acceleration = np.where(direction == 0.0, 0.0, acceleration)
    after = speed + acceleration * weights[0]
    distance = speed * step + acceleration * weights[1]
    stops = np.flatnonzero(after * direction < 0.0)
    if stops.size:
        w, a, k, moment = speed[stops], acceleration[stops], rate[stops], torque[stops]
        time = stopping_time(k, w, a)
        way = w * time + a * distance_weight(k, time)
        onward = breakaway(moment, forward_level[stops], backward_level[stops])
        level = np.where(onward > 0.0, forward_level[stops], backward_level[stops])
        start = np.where(onward == 0.0, 0.0, (moment - onward * level) / inertia[stops])
        after[stops] = start * speed_weight(k, step - time)
        distance[stops] = way + start * distance_weight(k, step - time)
    return after, distance


class Plant:
    """Axes with their effects. `demand` in, motion out; nothing here depends on a drive.

    The step is drift, kick, drift: position-dependent torques act at the position half a step on, which makes the
    undamped axis symplectic and the whole second order; speed-dependent ones use the speed extrapolated to there. The
    kick solves J*dw/dt = M - K_w*w - K_0*sgn(w) exactly, with stops and breakaways within the step (`move`).

    Attributes:
        axes: their constants, as arrays - (n,).
        position, velocity: of the motor - rad, rad/s - (n,).
        load_position, load_velocity: of the load, where a coupling separates it; unused elsewhere.
        current, acting_current: that the drive measures, and that makes torque - A.
        recorded_current: the one that is measured, behind its filter if there is one - A.
        motor_torque, load_torque: during the last step, of the motor and of what its gear carries - N*m.
        measured_position, measured_velocity: what ideal electronics would read from the sensor.
        sensed_velocity: the same before the filter on the speed, if there is one.
    """

    def __init__(
        self, axes: Sequence[Axis], effects: Sequence[Sequence[Effect]], position: float = 0.0, velocity: float = 0.0
    ) -> None:
        n = len(axes)
        self.axes: Any = stack(axes)
        self.position, self.velocity = np.full(n, position, dtype=float), np.full(n, velocity, dtype=float)
        self.current, self.motor_torque, self.time, self.midtime = np.zeros(n), np.zeros(n), 0.0, 0.0
        self.recorded_current, self._before = self.current, self.velocity
        self._acting = _acting(self, effects)
        self.load_position, self.load_velocity = self.position.copy(), self.velocity.copy()
        self._load_before = self.load_velocity.copy()
        self._body = self.axes.inertia.copy()
        joints = np.zeros(n, dtype=int)
        for rows in self._acting["transmitted_torque"]:
            joints[rows.index] += 1
            self._body[rows.index] = rows.rotor_inertia
        if joints.max() > 1:
            raise ValueError("an axis has one coupling between motor and load")
        self._load_inertia = self.axes.inertia - self._body
        self._rate = self.axes.viscous / self._body
        self._weights: dict[float, tuple[np.ndarray, np.ndarray]] = {}
        self._sense()
        for rows in self._acting["filtered"]:
            rows.memory = self.measured_velocity[rows.index].copy()

    def advance(self, demand: np.ndarray, step: float) -> None:
        """Advance by `step` - s - while the drive demands a current - A - (n,)."""
        self.midtime = self.time + step / 2.0
        start, speed = self.position, self.velocity
        self.position = start + speed * (step / 2.0)  # hooks see the middle of the step
        self.velocity = 1.5 * speed - 0.5 * self._before
        self.acting_current = self._drive_current(demand, step)
        self.motor_torque = self.axes.torque_constant * self.acting_current
        for rows in self._acting["torque_factor"]:
            self.motor_torque[rows.index] *= rows.effect.torque_factor(rows)
        net = self.motor_torque.copy()
        self.load_torque = np.zeros_like(net)
        for rows in self._acting["resisting_torque"]:
            torque = rows.effect.resisting_torque(rows)
            net[rows.index] -= torque
            self.load_torque[rows.index] += torque * rows.effect.transmitted
        for rows in self._acting["transmitted_torque"]:
            net[rows.index] -= self._move_load(rows, step)
        forward, backward = self._friction_levels()
        body, rate, weights = self._inertia(step)
        for rows in self._acting["bristle_torque"]:
            i = rows.index
            rows.level = np.maximum(np.where(self.velocity[i] > 0.0, forward[i], backward[i]), 1e-12)
            rows.memory = rows.effect.bend(speed[i], rows.level, rows.memory, step / 2.0)
            net[i] -= rows.effect.bristle_torque(rows, rows.level, rows.memory)
        for rows in self._acting["bristle_torque"]:
            forward[rows.index] = backward[rows.index] = 0.0
        after, distance = move(speed, net, forward, backward, body, rate, weights, step)
        for rows in self._acting["remember"]:
            rows.memory = rows.effect.remember(rows, rows.memory, step)
        for rows in self._acting["bristle_torque"]:
            rows.memory = rows.effect.bend(after[rows.index], rows.level, rows.memory, step / 2.0)
        self._before, self.velocity, self.position = speed, after, start + distance
        sensed = self.sensed_velocity
        self._sense()
        for rows in self._acting["filtered"]:
            i = rows.index
            rows.memory = rows.effect.filtered(sensed[i], self.sensed_velocity[i], rows.memory, step)
            self.measured_velocity[i] = rows.memory
        self.time += step

    def _drive_current(self, demand: np.ndarray, step: float) -> np.ndarray:
        """Current that makes torque, at the middle of the step; the measured one is advanced to its end."""
        before, self.current, middle = self.current, demand.copy(), demand.copy()
        for rows in self._acting["driven_current"]:
            i = rows.index
            self.current[i] = rows.effect.driven_current(rows, demand[i], before[i], step)
            middle[i] = 0.5 * (before[i] + self.current[i])
        for rows in self._acting["true_current"]:
            middle[rows.index] = rows.effect.true_current(rows, middle[rows.index])
        for rows in self._acting["acting_current"]:
            measured, start = middle[rows.index].copy(), rows.memory
            middle[rows.index] = rows.effect.acting_current(measured, start, step / 2.0)
            rows.memory = rows.effect.acting_current(measured, start, step)
        self.recorded_current = self.current.copy()
        for rows in self._acting["recorded_current"]:
            rows.memory = rows.effect.recorded_current(self.current[rows.index], rows.memory, step)
            self.recorded_current[rows.index] = rows.memory
        return middle

    def _friction_levels(self) -> np.ndarray:
        """(K_0 + excess +- difference/2)*factor, against positive and against negative motion (2, n)."""
        levels = np.stack([self.axes.coulomb] * 2)
        for rows in self._acting["friction_excess"]:
            levels[:, rows.index] += rows.effect.friction_excess(rows)
        for rows in self._acting["friction_difference"]:
            levels[:, rows.index] += np.outer([0.5, -0.5], rows.effect.friction_difference(rows))
        for rows in self._acting["friction_factor"]:
            levels[:, rows.index] *= rows.effect.friction_factor(rows)
        return np.maximum(levels, 0.0)

    def _move_load(self, rows: Rows, step: float) -> np.ndarray:
        """Torque from motor to load at the middle of the step, and the load moved by it."""
        i = rows.index
        speed = self.load_velocity[i]
        middle = self.load_position[i] + speed * (step / 2.0)
        expected = 1.5 * speed - 0.5 * self._load_before[i]
        torque = rows.effect.transmitted_torque(rows, self.position[i] - middle, self.velocity[i] - expected)
        after = speed + step * torque / self._load_inertia[i]
        self._load_before[i], self.load_velocity[i] = speed, after
        self.load_position[i] = middle + after * (step / 2.0)
        return torque

    def _inertia(self, step: float) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray]]:
        body, rate, varying = self._body, self._rate, self._acting["added_inertia"]
        if varying:
            body = body.copy()
            for rows in varying:
                body[rows.index] += rows.effect.added_inertia(rows)
            rate = self.axes.viscous / body
        if varying or step not in self._weights:
            whole = np.full_like(body, step)
            self._weights[step] = speed_weight(rate, whole), distance_weight(rate, whole)
        return body, rate, self._weights[step]

    def _sense(self) -> None:
        """What the sensor reads of position and speed, a filter of the speed aside."""
        self.measured_position, self.sensed_velocity = self.position.copy(), self.velocity.copy()
        for rows in self._acting["measured"]:
            i = rows.index
            read = rows.effect.measured(self.position[i], self.velocity[i])
            self.measured_position[i], self.sensed_velocity[i] = read
        self.measured_velocity = self.sensed_velocity.copy()


def _acting(plant: Plant, effects: Sequence[Sequence[Effect]]) -> defaultdict[str, list[Rows]]:
    """For each hook the effects that have it, each stacked over its axes."""
    found: dict[tuple[type[Effect], int], list[tuple[int, Effect]]] = {}
    for row, those in enumerate(effects):
        for order, effect in enumerate(those):
            repeats = sum(type(other) is type(effect) for other in those[:order])
            found.setdefault((type(effect), repeats), []).append((row, effect))
    acting: defaultdict[str, list[Rows]] = defaultdict(list)
    for (kind, _), pairs in found.items():
        index = np.array([row for row, _ in pairs])
        everywhere = len(index) == len(effects)
        rows = Rows(plant, slice(None) if everywhere else index, stack([effect for _, effect in pairs]))
        for hook in dir(kind):
            acting[hook].append(rows)
    return acting
