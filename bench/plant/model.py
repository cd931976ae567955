"""The MuJoCo model of an axis, built from its MJCF and the values of a rig.

    J*alpha = M - K_w*w - K_0*sgn(w) - M_L

J - moment of inertia of everything that moves, on the motor's side - kg*m**2; M - motor torque - N*m; K_w - viscous
friction coefficient - N*m*s/rad; K_0 - Coulomb friction - N*m, which holds a standing axis against any torque below it;
M_L - load torque, on the motor's side - N*m; alpha, w - acceleration and velocity - rad/s**2, rad/s. On a linear axis
mass, force and metres take their places.

Integration is MuJoCo's semi-implicit Euler, made exact for this equation in two ways, both measured in docs/plant.md:

- Damping acts explicitly and the joint carries `half_step_inertia`, so that a step under constant torque and Coulomb
  friction ends at the velocity of the closed form.
- Velocity is kicked, then position drifts with the new velocity: MuJoCo's position belongs half a step later than its
  velocity (leapfrog; Hairer, Lubich, Wanner, Acta Numerica 12, 2003, 399-450). `bench.plant.run` starts it there and
  brings it back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import mujoco

from bench.assets import asset
from bench.axis_kind import COULOMB, ROTARY, VISCOUS, AxisKind
from bench.effects.mjcf import AXIS, LOAD, LOAD_TORQUE, MOTOR
from bench.effects.mjcf import DRIVE as DRIVE
from bench.errors import InputError
from bench.rig.load import Load
from bench.rig.rig import Rig
from bench.units import Quantity

#: Share of the motion that dry friction takes away in one step while it sticks; MuJoCo's default of 0.9 creeps.
STICKING_IMPEDANCE = (0.9999, 0.9999, 0.001, 0.5, 2.0)

#: The ground that is drawn under an axis.
FLOOR = "floor"
#: Mass of a body of unknown mass - kg: MuJoCo needs one, and it is negligible where the body moves.
NO_MASS = 1e-6

#: Inertia of a flat disk about its diameter, over that about its shaft: half, and as much more as a thickness of a
#: hundredth of the diameter gives it, so that numbers rounded in a file still add up to a body's.
ACROSS = 0.5 + 2.0 / 3.0 * 0.01**2

#: The visible disk is drawn to size up to what clears the floor - m.
LARGEST_VISIBLE_RADIUS = 0.13


@dataclass(frozen=True)
class AxisParameters:
    """What the equation of motion of an axis needs, on the motor's side of any gear.

    Attributes:
        inertia: J - kg*m**2 (kg on a linear axis).
        viscous_friction_coefficient: K_w - N*m*s/rad (N*s/m).
        coulomb_friction: K_0 - N*m (N).
        load_torque: M_L, resists positive motion - N*m (N).
        motor_inertia: the part of J on the motor's side of a coupling - kg*m**2 (kg).
        kind: of the axis.
    """

    inertia: float
    viscous_friction_coefficient: float = 0.0
    coulomb_friction: float = 0.0
    load_torque: float = 0.0
    motor_inertia: float = 0.0
    kind: AxisKind = ROTARY

    @classmethod
    def from_rig(cls, rig: Rig) -> AxisParameters:
        """Truth of a simulated axis: `[simulation]` of its rig, inertia from motor and load where it gives none.

        Raises:
            InputError: no `[simulation]`, no inertia to be had, or a rotor heavier than the whole.
        """
        simulation = rig.simulation
        if simulation is None:
            raise InputError(f"{rig.source}: simulation", "missing", "a simulated axis needs a table [simulation]")
        load = rig.load or Load()
        key = rig.axis_kind.inertia
        motor = rig.motor.inertia + (load.gear_inertia or 0.0)
        inertia = getattr(simulation, key)
        if inertia is None:
            inertia = motor + load.reflected(load.disk(rig.axis_kind))
        if inertia <= 0.0 or motor > inertia:
            raise InputError(
                f"{rig.source}: simulation.{key}",
                f"found {inertia:g} with {motor:g} in the motor",
                "allowed: above zero and not below what the motor has, or motor and load that give it",
            )
        return cls(
            inertia=inertia,
            viscous_friction_coefficient=simulation.viscous_friction_coefficient,
            coulomb_friction=simulation.coulomb_friction,
            load_torque=simulation.load_torque / load.gear_ratio,
            motor_inertia=motor,
            kind=rig.axis_kind,
        )

    @property
    def frictionless(self) -> AxisParameters:
        """The same axis without friction in its mechanics."""
        return replace(self, viscous_friction_coefficient=0.0, coulomb_friction=0.0)


def parameter_quantities(kind: AxisKind) -> dict[str, Quantity]:
    """What the fields of `AxisParameters` are called in files on a kind of axis, with unit there and bounds."""
    viscous, viscous_unit = kind.parameter(VISCOUS), kind.parameter_unit(VISCOUS)
    return {
        "inertia": Quantity(kind.inertia, "J", kind.inertia_unit, lower=0.0),
        "viscous_friction_coefficient": Quantity(viscous, "K_w", viscous_unit, lower=0.0),
        "coulomb_friction": Quantity(kind.parameter(COULOMB), "K_0", kind.effort_unit, lower=0.0),
        "load_torque": Quantity(f"load_{kind.effort}", "M_L", kind.effort_unit),
        "motor_inertia": Quantity(f"motor_{kind.inertia}", "J_m", kind.inertia_unit, lower=0.0),
    }


def half_step_inertia(inertia: float, damping: float, timestep: float) -> float:
    """Inertia that makes an explicit step with viscous friction exact - same unit as `inertia`.

    J' = J*(x/(1 - exp(-x)) - 1) with x = K_w*h/J turns w + h*(M - K_w*w)/(J + J') into
    exp(-x)*w + (1 - exp(-x))*M/K_w. To first order J' = K_w*h/2: friction acts at the middle of the step.
    """
    x = damping * timestep / inertia
    return inertia * (x / -math.expm1(-x) - 1.0) if x > 0.0 else 0.0


def build_spec(parameters: AxisParameters, timestep: float, load: Load | None = None) -> mujoco.MjSpec:
    """Editable model of an axis; `timestep` - s. `load` only draws the disk to size."""
    spec = mujoco.MjSpec.from_file(str(asset("mjcf", f"{parameters.kind.name}_axis.xml")))
    spec.option.timestep = timestep
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    _set_inertia(spec, parameters)
    _set_friction(spec.joint(AXIS), parameters, timestep)
    spec.actuator(LOAD_TORQUE).biasprm[0] = -parameters.load_torque
    if load is not None and parameters.kind.turns:
        _draw_disk(spec, load)
    return spec


def _set_inertia(spec: mujoco.MjSpec, parameters: AxisParameters) -> None:
    parts = {MOTOR: parameters.motor_inertia, LOAD: parameters.inertia - parameters.motor_inertia}
    for name, inertia in parts.items():
        body = spec.body(name)
        if parameters.kind.turns:
            body.inertia = disk_inertia(inertia)
        else:
            body.mass = inertia


def disk_inertia(inertia: float) -> list[float]:
    """Inertia about the shaft and about two diameters of a flat disk - kg*m**2 - whose shaft is x."""
    return [inertia, ACROSS * inertia, ACROSS * inertia]


def _set_friction(joint: mujoco.MjsJoint, parameters: AxisParameters, timestep: float) -> None:
    damping = parameters.viscous_friction_coefficient
    joint.damping = [damping, 0.0, 0.0]
    joint.armature = half_step_inertia(parameters.inertia, damping, timestep)
    joint.frictionloss = parameters.coulomb_friction
    joint.solimp_friction = STICKING_IMPEDANCE
    joint.solref_friction = [2.0 * timestep, 1.0]


def _draw_disk(spec: mujoco.MjSpec, load: Load) -> None:
    if load.outer_diameter is None:
        return
    radius = min(load.outer_diameter / 2.0, LARGEST_VISIBLE_RADIUS)
    thickness = load.thickness or 0.1 * radius
    spec.geom("disk").size = [radius, thickness / 2.0, 0.0]
    mark = spec.geom("angle mark")
    mark.size = [0.0008, 0.003, 0.34 * radius]
    mark.pos = [thickness / 2.0, 0.0, 0.6 * radius]
