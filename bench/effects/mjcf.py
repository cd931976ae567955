"""Parts of the MuJoCo model of an axis: their names, and what effects add to it."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:  # 0.2 s, needed only to simulate
    import mujoco

#: The model that effects are added to, as MuJoCo lets it be edited.
Spec: TypeAlias = "mujoco.MjSpec"
AXIS, MOTOR, LOAD, DRIVE, LOAD_TORQUE = "axis", "motor", "load", "drive", "load torque"
#: The actuator between motor and load by which known torque acts on the load, in addition to what the drive takes less.
LINKS = "links"
#: The actuator whose bristles are the axis' friction, where it has some.
BRISTLES = "bristles"
#: Places of the two friction levels among that actuator's bias parameters.
BRISTLE_LEVELS = slice(3, 5)

#: A passive DC motor brakes by K**2/R times speed; its constant is chosen so small that this vanishes in rounding.
PASSIVE_MOTOR_CONSTANT = 1e-12


def add_resisting_torque(spec: Spec, torque: float) -> None:
    """Add a constant torque against positive motion - N*m (N)."""
    spec.actuator(LOAD_TORQUE).biasprm[0] -= torque


def passive_motor(
    spec: Spec,
    name: str,
    cogging: tuple[float, float, float] = (0.0, 0.0, 0.0),
    lugre: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0),
) -> None:
    """Add a DC motor without input to the axis, which only cogs or has bristle friction.

    Args:
        cogging: amplitude - N*m (N) -, harmonic - 1 (1/m) - and phase - rad - of a driving torque A*sin(n*q + phi).
        lugre: stiffness, damping and levels of bristles, as MuJoCo has them.
    """
    import mujoco

    actuator = spec.add_actuator(name=name, target=AXIS, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    actuator.set_to_dcmotor(
        motorconst=[PASSIVE_MOTOR_CONSTANT, PASSIVE_MOTOR_CONSTANT],
        resistance=1.0,
        cogging=list(cogging),
        lugre=list(lugre),
        ctrlspec=int(mujoco.mjtCtrlInput.mjINPUT_NONE),
    )


def pull_load(spec: Spec) -> None:
    """Have known torque act on the load behind a coupling: what the motor has less of, the coupling has, too."""
    import mujoco

    coupling = spec.body(LOAD).joints[0]
    spec.add_actuator(name=LINKS, target=coupling.name, trntype=mujoco.mjtTrn.mjTRN_JOINT, gear=[-1, 0, 0, 0, 0, 0])


def add_coupling_joint(spec: Spec, name: str) -> mujoco.MjsJoint:
    """Add a joint between motor and load along the axis; its position is load less motor - rad (m)."""
    axis = spec.joint(AXIS)
    return spec.body(LOAD).add_joint(name=name, type=axis.type, axis=axis.axis)
