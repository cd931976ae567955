"""What resists the motor of a model that moves steadily, at any angle and speed: all its effects asked at once.

Native effects are asked through MuJoCo, which makes their torques of position and speed; the others through their own
hooks, as in a simulation. Time stands at its end: what warms up is warm, what happens for a while is over.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.batch import Batch

from bench.arrays import Array
from bench.effects.kinds import Number
from bench.effects.mjcf import AXIS, BRISTLES
from bench.plant.axis_model import AxisModel
from bench.plant.ticked import TickedEffects

#: Timestep of a model that is asked and does not move - s.
TIMESTEP = 1e-4


@dataclass
class _Recorder:
    """A seat that keeps what effects would set."""

    friction: Number
    torque: Number = 0.0
    step: float = TIMESTEP
    bristled: bool = False

    def set_torque(self, torque: Number) -> None:
        self.torque = torque

    def add_torque(self, torque: Number) -> None:
        self.torque = self.torque + torque

    def set_added_inertia(self, inertia: Number) -> None:
        """Inertia resists no steady motion."""

    def set_friction(self, level: Number) -> None:
        self.friction = level


def resisting_torque(model: AxisModel, position: Array, velocity: Array) -> Array:
    """Motor torque that a steady motion takes - N*m (N) - (n,), dry friction against its direction and none at rest.

    Args:
        model: with effects.
        position, velocity: of the motor - rad (m), rad/s (m/s) - (n,).
    """
    spec = model.spec(TIMESTEP)
    spec.joint(AXIS).frictionloss = 0.0
    bristles = spec.actuator(BRISTLES)
    if bristles is not None:  # steady, they have bent as far as dry friction bends them
        spec.delete(bristles)
    batch = Batch(spec.compile(), position.size)
    joint = batch.model.joint(AXIS)
    batch.bind("qpos")[:, joint.qposadr[0]], batch.bind("qvel")[:, joint.dofadr[0]] = position, velocity
    passive, made = batch.bind("qfrc_passive"), batch.bind("qfrc_actuator")
    batch.forward()
    recorder = _Recorder(np.full(position.size, dry_friction(model)))
    ticked = TickedEffects(recorder, [model] * position.size, velocity)
    nothing = np.zeros(position.size)
    ticked.act(np.full(position.size, np.inf), position, velocity, nothing)
    dof = joint.dofadr[0]
    return recorder.friction * np.sign(velocity) - recorder.torque - passive[:, dof] - made[:, dof]


def dry_friction(model: AxisModel) -> float:
    """Level of dry friction that is native in a model - N*m (N)."""
    spec = model.spec(TIMESTEP)
    bristles: mujoco.MjsActuator | None = spec.actuator(BRISTLES)
    return float(spec.joint(AXIS).frictionloss) if bristles is None else float(bristles.biasprm[3])
