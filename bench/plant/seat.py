"""Where MuJoCo has an axis: what effects set of it in every step, on a batch of simulations or on a single one.

Effects speak on the motor's side; behind a gear of i motor turns per turn of the joint, torque and dry friction are i
times, inertia i**2 times as much there.
"""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.kinds import Number
from bench.effects.mjcf import AXIS, BRISTLES

#: Places of the two friction levels among the parameters of a passive motor with bristles.
BRISTLE_LEVELS = slice(3, 5)


class Seat(Protocol):
    """Axes side by side in MuJoCo, all values on the motor's side, (axes,) each, or numbers of a lone axis."""

    @property
    def step(self) -> float:
        """Timestep - s."""
        ...

    @property
    def bristled(self) -> bool:
        """Whether bristles carry the dry friction, which bend to the level of their direction."""
        ...

    def set_torque(self, torque: Number) -> None:
        """Torque that is applied beside the drive's - N*m (N)."""
        ...

    def add_torque(self, torque: Number) -> None:
        """More of it in the same step - N*m (N)."""
        ...

    def set_added_inertia(self, inertia: Number) -> None:
        """Inertia beyond that of the model - kg*m**2 (kg)."""
        ...

    def set_friction(self, level: Number) -> None:
        """Level of dry friction - N*m (N)."""
        ...


class BatchSeat:
    """The axes of a batch.

    Args:
        batch: that simulates them.
        joint: of each.
        ratio: of the gear before it, motor turns per turn of the joint.
        bristles: actuator whose bristles are the friction, if the model has one of this name.
    """

    def __init__(self, batch: Batch, joint: str = AXIS, ratio: float = 1.0, bristles: str = BRISTLES) -> None:
        self._batch, self._ratio = batch, ratio
        self._dof = int(batch.model.joint(joint).dofadr[0])
        self._bristles = mujoco.mj_name2id(batch.model, mujoco.mjtObj.mjOBJ_ACTUATOR, bristles)
        self._applied = batch.bind("qfrc_applied")[:, self._dof]

    @property
    def step(self) -> float:
        """Timestep - s."""
        return float(self._batch.model.opt.timestep)

    @property
    def bristled(self) -> bool:
        """See `Seat`."""
        return self._bristles >= 0

    def set_torque(self, torque: Number) -> None:
        """See `Seat`."""
        self._applied[:] = self._ratio * torque

    def add_torque(self, torque: Number) -> None:
        """See `Seat`."""
        self._applied += self._ratio * torque

    def set_added_inertia(self, inertia: Number) -> None:
        """See `Seat`."""
        armature, bare = self._armatures
        armature[:] = bare + self._ratio**2 * inertia

    def set_friction(self, level: Number) -> None:
        """See `Seat`."""
        self._levels[:] = level if self.bristled else self._ratio * level

    @cached_property
    def _armatures(self) -> tuple[Array, Array]:
        """Of each axis, and what the model has."""
        armature = self._batch.expand("dof_armature")[:, self._dof]
        return armature, armature.copy()

    @cached_property
    def _levels(self) -> NDArray[np.float64]:
        """Of friction, (k, axes)."""
        if self.bristled:
            return self._batch.expand("actuator_biasprm")[:, self._bristles, BRISTLE_LEVELS].T
        return self._batch.expand("dof_frictionloss")[:, self._dof : self._dof + 1].T


class ModelSeat:
    """One joint of a model with its data, beside whatever else is applied to it.

    Args:
        model, data: of a simulation; what effects change of the model is changed in it.
        joint: of the axis.
        ratio: of the gear before it, motor turns per turn of the joint.
        bristles: actuator whose bristles are the friction, if the model has one of this name.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joint: str, ratio: float, bristles: str) -> None:
        self._model, self._data, self._ratio = model, data, ratio
        self._dof = int(model.joint(joint).dofadr[0])
        self._bristles = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, bristles)
        self._armature, self._given = float(model.dof_armature[self._dof]), 0.0

    @property
    def step(self) -> float:
        """Timestep - s."""
        return float(self._model.opt.timestep)

    @property
    def bristled(self) -> bool:
        """See `Seat`."""
        return self._bristles >= 0

    def set_torque(self, torque: Number) -> None:
        """In the place of what was set before; what others apply stays."""
        self.add_torque(torque - self._given)

    def add_torque(self, torque: Number) -> None:
        """See `Seat`."""
        self._data.qfrc_applied[self._dof] += self._ratio * float(torque)
        self._given += float(torque)

    def set_added_inertia(self, inertia: Number) -> None:
        """See `Seat`."""
        self._model.dof_armature[self._dof] = self._armature + self._ratio**2 * float(inertia)

    def leave(self) -> None:
        """Give the model back the inertia it had."""
        self._model.dof_armature[self._dof] = self._armature

    def set_friction(self, level: Number) -> None:
        """See `Seat`."""
        if self.bristled:
            self._model.actuator_biasprm[self._bristles, BRISTLE_LEVELS] = level
        else:
            self._model.dof_frictionloss[self._dof] = self._ratio * float(level)
