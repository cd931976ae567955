"""An axis as a linear system: speed over torque of its MuJoCo model while it moves, so that dry friction is constant.

    x' = A*x + B*u  per step,    H(f) = C*(z - A)**-1*B,  z = exp(2j*pi*f*h)

x - positions and speeds; u - torque of the motor - N*m (N); h - step. MuJoCo linearises its own model, by centred
differences (`mjd_transitionFD`).
"""

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.effect import Contact, Coupling
from bench.effects.mjcf import AXIS, DRIVE
from bench.plant.axis_model import AxisModel

#: Step - s -, so short that the integrator's own error is below 1e-3 at 1 kHz; displacement of a difference.
STEP, DISPLACEMENT = 2e-6, 1e-6


def speed_over_torque(model: AxisModel, frequency: Array) -> NDArray[np.complex128] | None:
    """Response of inertia, viscous friction and an elastic coupling at frequencies (k,) - Hz: rad/s/(N*m) (m/s/N).

    None of an axis with a dead zone, which is not linear.
    """
    if model.of_kind(Contact):
        return None
    spec = model.with_effects(model.of_kind(Coupling)).spec(STEP)
    joint, drive = spec.joint(AXIS), spec.actuator(DRIVE)
    joint.frictionloss = 0.0
    built = spec.compile()
    data, size = mujoco.MjData(built), 2 * built.nv
    a, b = np.zeros((size, size)), np.zeros((size, built.nu))
    mujoco.mjd_transitionFD(built, data, DISPLACEMENT, True, a, b, None, None)
    speed = built.nv + int(built.jnt_dofadr[joint.id])
    z = np.exp(2j * np.pi * np.asarray(frequency) * STEP)
    systems = z[:, None, None] * np.eye(size) - a
    return np.linalg.solve(systems, b[None, :, [drive.id]].astype(complex))[:, speed, 0].astype(np.complex128)
