"""What effects do to the MJCF of an axis: names of its parts, and torques that MuJoCo makes natively."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # 0.2 s, needed only to simulate
    import mujoco


AXIS, MOTOR, LOAD, DRIVE, LOAD_TORQUE = "axis", "motor", "load", "drive", "load torque"
#: The actuator whose bristles are the axis' friction, where it has some.
BRISTLES = "bristles"

#: A passive DC motor brakes by K**2/R times speed; its constant is chosen so small that this vanishes in rounding.
PASSIVE_MOTOR_CONSTANT = 1e-12


def add_resisting_torque(spec: mujoco.MjSpec, torque: float) -> None:
    """Add a constant torque against positive motion - N*m (N)."""
    spec.actuator(LOAD_TORQUE).biasprm[0] -= torque


def add_periodic_torque(spec: mujoco.MjSpec, name: str, amplitude: float, harmonic: float, phase: float) -> None:
    """Add a resisting torque A*sin(n*q + phi): the cogging of a passive DC motor, whose sign is that of driving.

    Args:
        spec: to be added to.
        name: of the actuator.
        amplitude: A - N*m (N).
        harmonic: n - 1 (1/m).
        phase: phi - rad.
    """
    passive_motor(spec, name, cogging=(-amplitude, harmonic, phase))


def passive_motor(
    spec: mujoco.MjSpec,
    name: str,
    cogging: tuple[float, float, float] = (0.0, 0.0, 0.0),
    lugre: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0),
) -> None:
    """A DC motor without input on the axis, of which only cogging or bristle friction is left."""
    import mujoco

    actuator = spec.add_actuator(name=name, target=AXIS, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    actuator.set_to_dcmotor(
        motorconst=[PASSIVE_MOTOR_CONSTANT, PASSIVE_MOTOR_CONSTANT],
        resistance=1.0,
        cogging=list(cogging),
        lugre=list(lugre),
        ctrlspec=int(mujoco.mjtCtrlInput.mjINPUT_NONE),
    )


def add_coupling_joint(spec: mujoco.MjSpec, name: str) -> mujoco.MjsJoint:
    """A joint between motor and load along the axis; its position is load less motor - rad (m)."""
    axis = spec.joint(AXIS)
    return spec.body(LOAD).add_joint(name=name, type=axis.type, axis=axis.axis)
