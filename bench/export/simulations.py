"""MuJoCo's simulations of one model, one or many side by side, whose state and parameters are written in place."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.effects.mjcf import AXIS, BRISTLE_LEVELS, BRISTLES
from bench.effects.signals import Number
from bench.plant.stepped_effects import Acts


@dataclass(frozen=True)
class Simulations:
    """Simulations of one model side by side.

    Attributes:
        model: of all of them.
        count: how many.
        state: gives a field of their data (count, ...), live.
        field: gives a field of the model that each has for itself (count, ...), live.
        forward: computes forces.
        advance: goes on by a step.
    """

    model: mujoco.MjModel
    count: int
    state: Callable[[str], Number]
    field: Callable[[str], Number]
    forward: Callable[[], object]
    advance: Callable[[], object]

    @classmethod
    def lone(cls, model: mujoco.MjModel, data: mujoco.MjData) -> Simulations:
        """One, whose model is written to."""

        def state(name: str) -> Number:
            return np.asarray(getattr(data, name))[None]

        def field(name: str) -> Number:
            return getattr(model, name)[None]

        forward, advance = (lambda: mujoco.mj_forward(model, data)), (lambda: mujoco.mj_step(model, data))
        return cls(model, 1, state, cache(field), forward, advance)

    @classmethod
    def of(cls, batch: Batch) -> Simulations:
        """Those of a batch."""
        return cls(batch.model, batch.nsim, cache(batch.bind), cache(batch.expand), batch.forward, batch.step)


class Joints:
    """Joints of simulations, to which the results of effects in a step are written, in the joints' own units.

    Args:
        simulations: whose joints they are.
        joints: of each simulation, by name.
        bristles: of each joint the actuator whose bristles are its friction, if the model has one of this name.
    """

    def __init__(
        self, simulations: Simulations, joints: Sequence[str] = (AXIS,), bristles: Sequence[str] = (BRISTLES,)
    ) -> None:
        model, kind = simulations.model, mujoco.mjtObj.mjOBJ_ACTUATOR
        dofs = [int(model.joint(name).dofadr[0]) for name in joints]
        self._columns = slice(dofs[0], dofs[0] + 1) if len(dofs) == 1 else dofs
        self._field, self._count, self.applied = simulations.field, len(dofs), simulations.state("qfrc_applied")
        self._bristles = [mujoco.mj_name2id(model, kind, name) for name in bristles]
        self.bristled: NDArray[np.bool_] = np.array(self._bristles) >= 0
        self._dry, self._bending = not self.bristled.all(), [int(k) for k in np.flatnonzero(self.bristled)]

    def take(self, acts: Acts) -> None:
        """What acts in the next step: values (simulations, joints), or (simulations*joints,), or for all."""
        self.apply(self._on_rows(acts.torque))
        if acts.inertia is not None:
            armature, bare = self._armatures
            armature[:, self._columns] = bare + self._on_rows(acts.inertia)
        if acts.friction is not None:
            level = self._on_rows(acts.friction)
            if self._dry:
                self._field("dof_frictionloss")[:, self._columns] = level
            for k in self._bending:
                own = level[:, k : k + 1] if np.ndim(level) else level
                self._field("actuator_biasprm")[:, self._bristles[k], BRISTLE_LEVELS] = own

    def apply(self, torque: Number) -> None:
        """Apply a torque in addition to those of actuators - N*m (N)."""
        self.applied[:, self._columns] = torque

    def restore_inertia(self) -> None:
        """Take what effects added to the joints' inertia off again."""
        if "_armatures" in self.__dict__:
            armature, bare = self._armatures
            armature[:, self._columns] = bare

    def _on_rows(self, values: Number) -> Number:
        return values.reshape(-1, self._count) if np.ndim(values) else values

    @cached_property
    def _armatures(self) -> tuple[Number, Number]:
        """Of all joints of the model, and what it has at these."""
        armature = self._field("dof_armature")
        return armature, armature[:, self._columns] + 0.0
