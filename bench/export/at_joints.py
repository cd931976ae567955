"""Effects at joints, as a function of the joints' state; and the torque of the actuators that drive them.

Everything is on the joint's side of a gear here. With i motor turns per turn of the joint, q_m = i*q and M = i*M_m, so
that friction is i times, inertia i**2 times the motor's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.arrays import namespace
from bench.effects.signals import Number
from bench.plant.model_file import StoredModel
from bench.plant.stepped_effects import Acts, Made, Remembered, SteppedEffects, numpys, per_axis


class AtJoints:
    """What MuJoCo does not make by itself, at joints side by side: a function of arrays (..., joints) of any library.

    Args:
        models: of each joint.
        step: of the integration - s.
        bristled: of which joints bristles carry the friction (joints,).
        made: makes arrays of the library.
    """

    def __init__(
        self, models: Sequence[StoredModel], step: float, bristled: NDArray[np.bool_], made: Made = numpys
    ) -> None:
        ratio = np.array([stored.mounting.gear_ratio for stored in models])
        self._ratio = made(per_axis(ratio))
        self._levels = made(per_axis(np.where(bristled, 1.0, ratio)))  # bristles are behind the gear themselves
        self._effects = SteppedEffects([stored.model for stored in models], step, bristled, made)

    def start(self, velocity: Number) -> Remembered:
        """What is remembered before a first step, of the joints' velocity - rad/s (m/s) - (..., joints)."""
        return self._effects.start(self._ratio * velocity)

    def again(self, memory: Remembered, where: Number, velocity: Number) -> Remembered:
        """A memory that begins anew where simulations were reset: bool - (..., joints), or one for all joints."""
        return self._effects.again(memory, where, self._ratio * velocity)

    def act(self, memory: Remembered, time: Number, position: Number, velocity: Number, torque: Number) -> Acts:
        """What acts in the step that comes.

        Args:
            memory: of the step before.
            time: at the start of the step - s - one for all, or (..., joints).
            position, velocity: of the joints then - rad (m), rad/s (m/s) - (..., joints).
            torque: of their actuators - N*m (N) - (..., joints).

        Returns:
            `torque` to apply beside the actuators', `friction` level and additional `inertia` of the joints, which are
            None where no effect changes them, and the `memory` of this step.
        """
        ratio = self._ratio
        acts = self._effects.act(memory, time, ratio * position, ratio * velocity, torque / ratio)
        return acts._replace(
            torque=ratio * (acts.torque + acts.motor) - torque,
            friction=None if acts.friction is None else self._levels * acts.friction,
            inertia=None if acts.inertia is None else ratio**2 * acts.inertia,
        )


@dataclass(frozen=True)
class Actuators:
    """Actuators that drive some joints, as arrays of the library that steps.

    Attributes:
        needs_forces: whether MuJoCo has to compute forces first, as those of a servo or a winding.
        limited: whether an input or a force has a limit.
        controls: places of their inputs in `ctrl` (k,).
        actuators: their numbers (k,).
        gears: torque of each joint per force of each (k, joints).
        gains: force per input (k,).
        asked: which of them MuJoCo has to be asked for, as it makes the force of more than the input (k,).
        limits: lowest and highest input, lowest and highest force (k,) each.
    """

    needs_forces: bool
    limited: bool
    controls: Number
    actuators: Number
    gears: Number
    gains: Number
    asked: Number
    limits: Sequence[Number]

    @classmethod
    def of(cls, model: mujoco.MjModel, joints: Sequence[str], made: Made = numpys) -> Actuators:
        """All actuators with an input on joints of a model."""
        ids = np.array([model.joint(name).id for name in joints], dtype=np.intp)
        on = (model.actuator_trnid[:, :1] == ids) & (model.actuator_trntype[:, None] == mujoco.mjtTrn.mjTRN_JOINT)
        chosen = np.flatnonzero(on.any(axis=1) & (model.actuator_ctrlnum > 0))
        plain = model.actuator_gaintype[chosen] == mujoco.mjtGain.mjGAIN_FIXED
        plain &= model.actuator_biastype[chosen] == mujoco.mjtBias.mjBIAS_NONE
        plain &= model.actuator_dyntype[chosen] == mujoco.mjtDyn.mjDYN_NONE
        limits = np.full((4, chosen.size), np.inf) * [[-1.0], [1.0], [-1.0], [1.0]]
        for column, k in enumerate(chosen):
            if plain[column] and model.actuator_ctrllimited[model.actuator_ctrladr[k]]:
                limits[:2, column] = model.actuator_ctrlrange[model.actuator_ctrladr[k]]
            if model.actuator_forcelimited[k]:
                limits[2:, column] = model.actuator_forcerange[k]
        return cls(
            not plain.all(),
            bool(np.isfinite(limits).any()),
            made(model.actuator_ctrladr[chosen].astype(np.intp)),
            made(chosen),
            made(np.where(on[chosen], model.actuator_gear[chosen, :1], 0.0)),
            made(np.where(plain, model.actuator_gainprm[chosen, 0], 0.0)),
            made(~plain),
            [made(bound) for bound in limits],
        )

    def torque(self, control: Number, force: Number) -> Number:
        """Torque of the joints - N*m (N) - (..., joints), of inputs (..., nu) and forces (..., actuators)."""
        xp, (low, high, weakest, strongest) = namespace(control), self.limits
        inputs = xp.take(control, self.controls, axis=-1)
        driven = inputs * self.gains
        if self.limited:
            driven = xp.clip(xp.clip(inputs, low, high) * self.gains, weakest, strongest)
        if self.needs_forces:
            driven = xp.where(self.asked, xp.take(force, self.actuators, axis=-1), driven)
        return driven @ self.gears
