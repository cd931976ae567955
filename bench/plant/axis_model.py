"""The model of an axis: its equation of motion and the effects beyond it, and the MuJoCo model of both.

    J*alpha = M - K_w*w - K_0*sgn(w) - M_L

J - moment of inertia of everything that moves, on the motor's side - kg*m**2; M - motor torque - N*m; K_w - viscous
friction coefficient - N*m*s/rad; K_0 - Coulomb friction - N*m, which keeps a standing axis at rest against any torque
below it; M_L - load torque, on the motor's side - N*m; alpha, w - acceleration and velocity - rad/s**2, rad/s. On a
linear axis mass, force and metres take their places.

Integration is MuJoCo's semi-implicit Euler, made exact for this equation in two ways, both measured in docs/plant.md:

- Damping acts explicitly and the joint carries `half_step_inertia`, so that a step under constant torque and Coulomb
  friction ends at the velocity of the closed form.
- Velocity is kicked, then position drifts with the new velocity: MuJoCo's position belongs half a step later than its
  velocity (leapfrog; Hairer, Lubich, Wanner, Acta Numerica 12, 2003, 399-450). `bench.plant.run` starts it there and
  brings it back.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import mujoco

from bench.assets import asset
from bench.axis_kind import COULOMB, ROTARY, VISCOUS, AxisKind
from bench.effects.effect import Bristles, Coupling, Effect, Stage
from bench.effects.mjcf import AXIS, LOAD, LOAD_TORQUE, MOTOR
from bench.effects.present import Present
from bench.effects.signals import Axis, Winding
from bench.effects.torque import Friction
from bench.errors import InputError
from bench.rig.rig import Load, Rig
from bench.rig.values import LARGEST_INERTIA, LARGEST_VISCOUS
from bench.trace.trace import LARGEST
from bench.units import Quantity

Kind = TypeVar("Kind", bound=Effect)

#: What acts between the effort that is asked for and the one that moves the axis; and that with what the drive sees.
OF_TORQUE = frozenset({Stage.CURRENT_SENSOR, Stage.CURRENT_LOOP, Stage.TORQUE_CONSTANT})
IN_THE_LOOP = OF_TORQUE | {Stage.ENCODER}
#: Share of the motion that dry friction takes away in one step while it sticks; MuJoCo's default of 0.9 creeps.
STICKING_IMPEDANCE = (0.9999, 0.9999, 0.001, 0.5, 2.0)
#: The ground that is drawn under an axis.
FLOOR = "floor"
#: Mass of a body of unknown mass - kg: MuJoCo needs one, and it is negligible where the body moves.
NO_MASS = 1e-6
#: Inertia of a disk about its diameter over that about its shaft; its thickness is a hundredth, for rounded numbers.
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

        InputError where there is no `[simulation]`, no inertia to be had, or a rotor heavier than the whole.
        """
        simulation, load, kind = rig.simulated, rig.load or Load(), rig.axis_kind
        motor = rig.motor.inertia + (load.gear_inertia or 0.0)
        inertia = getattr(simulation, kind.inertia)
        if inertia is None:
            inertia = motor + load.reflected(load.disk(kind))
        if inertia <= 0.0 or motor > inertia:
            raise InputError(
                f"{rig.source}: simulation.{kind.inertia}",
                f"found {inertia:g} with {motor:g} in the motor",
                "allowed: above zero and not below what the motor has, or motor and load that give it",
            )
        return cls(
            inertia=inertia,
            viscous_friction_coefficient=simulation.viscous_friction_coefficient,
            coulomb_friction=simulation.coulomb_friction,
            load_torque=simulation.load_torque / load.gear_ratio,
            motor_inertia=motor,
            kind=kind,
        )

    @property
    def values(self) -> dict[str, tuple[float, str]]:
        """Its quantities by their names in files, each with its unit."""
        return {q.name: (getattr(self, field), q.unit) for field, q in parameter_quantities(self.kind).items()}

    @property
    def frictionless(self) -> AxisParameters:
        """The same axis without friction in its mechanics."""
        return replace(self, viscous_friction_coefficient=0.0, coulomb_friction=0.0)


def parameter_quantities(kind: AxisKind) -> dict[str, Quantity]:
    """What the fields of `AxisParameters` are called in files on a kind of axis, with unit there and bounds."""
    viscous, viscous_unit = kind.parameter(VISCOUS), kind.parameter_unit(VISCOUS)
    effort, most = kind.effort_unit, LARGEST[kind.effort]
    return {
        "inertia": Quantity(kind.inertia, "J", kind.inertia_unit, 0.0, LARGEST_INERTIA),
        "viscous_friction_coefficient": Quantity(viscous, "K_w", viscous_unit, 0.0, LARGEST_VISCOUS),
        "coulomb_friction": Quantity(kind.parameter(COULOMB), "K_0", effort, 0.0, most),
        "load_torque": Quantity(f"load_{kind.effort}", "M_L", effort, -most, most),
        "motor_inertia": Quantity(f"motor_{kind.inertia}", "J_m", kind.inertia_unit, 0.0, LARGEST_INERTIA),
    }


def effect_values(present: Present, kind: AxisKind) -> dict[str, tuple[float, str]]:
    """Quantities of an effect on a kind of axis by their names, each with its unit."""
    units = {quantity.name: kind.unit(quantity) for quantity in present.effect.quantities}
    return {key: (value, units[key]) for key, value in present.values}


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
    for name, inertia in ((MOTOR, parameters.motor_inertia), (LOAD, parameters.inertia - parameters.motor_inertia)):
        if parameters.kind.turns:
            spec.body(name).inertia = disk_inertia(inertia)
        else:
            spec.body(name).mass = inertia
    joint, damping = spec.joint(AXIS), parameters.viscous_friction_coefficient
    joint.damping = [damping, 0.0, 0.0]
    joint.armature = half_step_inertia(parameters.inertia, damping, timestep)
    joint.frictionloss = parameters.coulomb_friction
    joint.solimp_friction, joint.solref_friction = STICKING_IMPEDANCE, [2.0 * timestep, 1.0]
    spec.actuator(LOAD_TORQUE).biasprm[0] = -parameters.load_torque
    if load is not None and load.outer_diameter is not None and parameters.kind.turns:
        radius = min(load.outer_diameter / 2.0, LARGEST_VISIBLE_RADIUS)
        thickness = load.thickness or 0.1 * radius
        spec.geom("disk").size = [radius, thickness / 2.0, 0.0]
        mark = spec.geom("angle mark")
        mark.size = [0.0008, 0.003, 0.34 * radius]
        mark.pos = [thickness / 2.0, 0.0, 0.6 * radius]
    return spec


def disk_inertia(inertia: float) -> list[float]:
    """Inertia about the shaft and about two diameters of a flat disk - kg*m**2 - whose shaft is x."""
    return [inertia, ACROSS * inertia, ACROSS * inertia]


@dataclass(frozen=True)
class AxisModel:
    """An axis with effects. Their order does not matter: they are kept sorted, all their quantities given, absent ones
    out.

    `peak_effort` is the motor's torque at peak current - N*m (N) -, infinite where unknown; `winding` is for effects
    that need it. InputError where an effect lacks a quantity, or the axis lacks what an effect needs.
    """

    parameters: AxisParameters
    effects: tuple[Present, ...] = ()
    peak_effort: float = math.inf
    winding: Winding | None = None

    def __post_init__(self) -> None:
        axis = self.axis
        present = [Present.of(p.name, p.resolved(axis)) for p in self.effects if not p.absent(axis)]
        object.__setattr__(self, "effects", tuple(sorted(present, key=lambda p: (p.name, p.values))))
        couplings = [p.name for p in present if isinstance(p.effect, Coupling)]
        if len(couplings) > 1:
            raise InputError("effects", f"found {' and '.join(couplings)}", "allowed: one coupling of motor and load")
        if couplings and not 0.0 < self.parameters.motor_inertia < self.parameters.inertia:
            raise InputError(
                couplings[0],
                f"found {self.parameters.motor_inertia:g} of {self.parameters.inertia:g} kg*m**2 in the motor",
                "allowed: a rig that states the motor's inertia and has a load",
            )

    @property
    def axis(self) -> Axis:
        """What effects may know of the axis."""
        p = self.parameters
        return Axis(
            inertia=p.inertia,
            motor_inertia=p.motor_inertia,
            viscous=p.viscous_friction_coefficient,
            coulomb=p.coulomb_friction,
            peak_effort=self.peak_effort,
            winding=self.winding,
        )

    def of_kind(self, kind: type[Effect] | tuple[type[Effect], ...]) -> tuple[Present, ...]:
        """Effects of a kind, or of one of several."""
        return tuple(present for present in self.effects if isinstance(present.effect, kind))

    def at_stage(self, stages: Collection[Stage]) -> tuple[Present, ...]:
        """Effects of some stages."""
        return tuple(present for present in self.effects if present.effect.stage in stages)

    def acting(self, kind: type[Kind]) -> list[tuple[Kind, dict[str, float]]]:
        """The same with the values of their quantities - SI."""
        return [(p.effect, dict(p.values)) for p in self.effects if isinstance(p.effect, kind)]

    @cached_property
    def native(self) -> tuple[Present, ...]:
        """Mechanisms that MuJoCo makes by itself."""
        # dry friction that changes in every step, or is carried by what bends to its level
        varies = bool(self.of_kind(Bristles)) or any(not p.effect.directed for p in self.of_kind(Friction))
        return tuple(p for p in self.effects if p.effect.native(dict(p.values), varies))

    @cached_property
    def ticked(self) -> tuple[Present, ...]:
        """Mechanisms that have to act in every step."""
        of_mechanics = self.at_stage((Stage.COMMUTATION, Stage.MECHANICS))
        return tuple(present for present in of_mechanics if present not in self.native)

    @property
    def stepped(self) -> tuple[Present, ...]:
        """Effects that change friction, inertia or torque of the axis in every step."""
        return *self.ticked, *self.at_stage(OF_TORQUE)

    @property
    def coupled(self) -> bool:
        """Whether an effect joins motor and load."""
        return bool(self.of_kind(Coupling))

    @property
    def all_native(self) -> bool:
        """Whether MuJoCo runs the whole axis and its drive by itself."""
        return not self.ticked and not self.at_stage(IN_THE_LOOP)

    @property
    def structure(self) -> tuple[str, ...]:
        """Names of what is built into the model."""
        return tuple(present.name for present in self.native)

    def spec(self, timestep: float) -> mujoco.MjSpec:
        """Editable MuJoCo model with all that is native in it; `timestep` - s."""
        spec = build_spec(self.parameters, timestep)
        for count, present in enumerate(self.native):
            present.effect.add(spec, f"{present.name} {count}", dict(present.values), self.axis)
        return spec

    def with_effects(self, effects: Sequence[Present]) -> AxisModel:
        """The same axis with other effects."""
        return replace(self, effects=tuple(effects))


def winding_of(rig: Rig) -> Winding | None:
    """The winding of a rig's motor; None unless constant, resistance, inductance and back-EMF constant are known."""
    motor, constant = rig.motor, rig.motor.torque_per_ampere
    known = [float(v) for v in (motor.resistance, motor.inductance, motor.back_emf_constant) if v is not None]
    return None if constant is None or len(known) < 3 else Winding(constant.constant, *known)
