"""Where MuJoCo has an axis: what effects set of a joint in every step, on a batch of simulations or on a single one.

Effects speak on the motor's side; behind a gear of i motor turns per turn of the joint, torque and dry friction are i
times, inertia i**2 times as much there.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.axis import Number
from bench.effects.mjcf import AXIS, BRISTLES

#: Places of the two friction levels among the parameters of a passive motor with bristles.
BRISTLE_LEVELS = slice(3, 5)


class Joints(ABC):
    """A joint of simulations side by side, all values on the motor's side, (axes,) each, or numbers of a lone axis.

    Attributes:
        step: of the integration - s.
        bristled: whether bristles carry the dry friction, which bend to the level of their direction.

    Args:
        model: of all simulations.
        joint: of the axis.
        ratio: of the gear before it, motor turns per turn of the joint.
        bristles: actuator whose bristles are the friction, if the model has one of this name.
        applied: torque that is applied to the joint beside the drive's, to be written - (axes,).
    """

    def __init__(self, model: mujoco.MjModel, joint: str, ratio: float, bristles: str, applied: Array) -> None:
        self._ratio, self._applied = ratio, applied
        self._dof = int(model.joint(joint).dofadr[0])
        self._bristles = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, bristles)
        self.step, self.bristled = float(model.opt.timestep), self._bristles >= 0

    @abstractmethod
    def _field(self, name: str) -> Array:
        """A field of the model that each simulation may have for itself, to be written - (axes, ...)."""

    def set_torque(self, torque: Number) -> None:
        """Torque that is applied beside the drive's - N*m (N)."""
        self._applied[:] = self._ratio * torque

    def add_torque(self, torque: Number) -> None:
        """More of it in the same step - N*m (N)."""
        self._applied += self._ratio * torque

    def set_added_inertia(self, inertia: Number) -> None:
        """Inertia beyond that of the model - kg*m**2 (kg)."""
        armature, bare = self._armatures
        armature[:] = bare + self._ratio**2 * inertia

    def set_friction(self, level: Number) -> None:
        """Level of dry friction - N*m (N)."""
        self._levels[:] = level if self.bristled else self._ratio * level

    @cached_property
    def _armatures(self) -> tuple[Array, Array]:
        """Of each axis, and what the model has."""
        armature = self._field("dof_armature")[:, self._dof]
        return armature, armature.copy()

    @cached_property
    def _levels(self) -> NDArray[np.float64]:
        """Of friction, (k, axes)."""
        if self.bristled:
            return self._field("actuator_biasprm")[:, self._bristles, BRISTLE_LEVELS].T
        return self._field("dof_frictionloss")[:, self._dof : self._dof + 1].T


class BatchJoints(Joints):
    """The joints of a batch; arguments as of `Joints`."""

    def __init__(self, batch: Batch, joint: str = AXIS, ratio: float = 1.0, bristles: str = BRISTLES) -> None:
        dof = int(batch.model.joint(joint).dofadr[0])
        super().__init__(batch.model, joint, ratio, bristles, batch.bind("qfrc_applied")[:, dof])
        self._batch = batch

    def _field(self, name: str) -> Array:
        return self._batch.expand(name)


class SimulationJoint(Joints):
    """One joint of a simulation, beside whatever else is applied to it; what effects change is changed in its model."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joint: str, ratio: float, bristles: str) -> None:
        dof = int(model.joint(joint).dofadr[0])
        super().__init__(model, joint, ratio, bristles, data.qfrc_applied[dof : dof + 1])
        self._model, self._given = model, 0.0

    def _field(self, name: str) -> Array:
        return getattr(self._model, name)[None]

    def set_torque(self, torque: Number) -> None:
        """In the place of what was set before; what others apply stays."""
        self.add_torque(torque - self._given)

    def add_torque(self, torque: Number) -> None:
        """See `Joints`."""
        super().add_torque(torque)
        self._given += float(torque)

    def restore(self) -> None:
        """Give the model back the inertia it had."""
        self.set_added_inertia(0.0)
