"""What resists the motor of a model that moves steadily, at any angle and speed: all its effects asked at once.

Native effects are asked through MuJoCo, which makes their torques of position and speed; the others through their own
hooks, as in a simulation. Time stands at its end: what warms up is warm, what happens for a while is over.
"""

from __future__ import annotations

import mujoco
import numpy as np
from mujoco.batch import Batch

from bench.arrays import Array
from bench.effects.mjcf import AXIS, BRISTLES
from bench.plant.axis_model import AxisModel
from bench.plant.joints import BatchJoints
from bench.plant.stepped_effects import SteppedEffects

#: Timestep of a model that is asked and does not move - s.
TIMESTEP = 1e-4


def resisting_torque(model: AxisModel, position: Array, velocity: Array) -> Array:
    """Motor torque that a steady motion takes - N*m (N) - (n,), dry friction against its direction and none at rest.

    Args:
        model: with effects.
        position, velocity: of the motor - rad (m), rad/s (m/s) - (n,).
    """
    spec = model.spec(TIMESTEP)
    spec.joint(AXIS).frictionloss = dry_friction(model)
    bristles = spec.actuator(BRISTLES)
    if bristles is not None:  # steady, they have bent as far as dry friction bends them
        spec.delete(bristles)
    batch = Batch(spec.compile(), position.size)
    joint = batch.model.joint(AXIS)
    dof = joint.dofadr[0]
    batch.bind("qpos")[:, joint.qposadr[0]], batch.bind("qvel")[:, dof] = position, velocity
    applied, passive, made = (batch.bind(f"qfrc_{part}")[:, dof] for part in ("applied", "passive", "actuator"))
    effects = SteppedEffects(BatchJoints(batch), [model] * position.size, velocity)
    effects.act(np.full(position.size, np.inf), position, velocity, np.zeros(position.size))
    batch.forward()
    return batch.expand("dof_frictionloss")[:, dof] * np.sign(velocity) - applied - passive - made


def dry_friction(model: AxisModel) -> float:
    """Level of dry friction that is native in a model - N*m (N)."""
    spec = model.spec(TIMESTEP)
    bristles: mujoco.MjsActuator | None = spec.actuator(BRISTLES)
    return float(spec.joint(AXIS).frictionloss) if bristles is None else float(bristles.biasprm[3])
