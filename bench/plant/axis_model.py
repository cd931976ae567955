"""The model of an axis: its equation of motion and the effects beyond it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import mujoco

from bench.effects.acting import (
    CarriesFriction,
    Electronics,
    Mechanism,
    MisreadEffort,
    MisreadMotion,
    Native,
    RaisesFriction,
    ScalesFriction,
)
from bench.effects.axis import Axis, Winding
from bench.effects.effect import Coupling, Effect
from bench.effects.present import Present
from bench.errors import InputError
from bench.plant.model import AxisParameters, build_spec
from bench.rig.load import Load
from bench.rig.rig import Rig

Kind = TypeVar("Kind", bound=Effect)

#: What acts between the effort that is asked for and the one that moves the axis; and with what the drive sees of the
#: motion, all that it has to do with.
OF_TORQUE = (Electronics, MisreadEffort)
IN_THE_LOOP = (*OF_TORQUE, MisreadMotion)


@dataclass(frozen=True)
class AxisModel:
    """An axis with effects. Their order does not matter: they are kept sorted, and absent ones are left out.

    Attributes:
        parameters: of the equation of motion.
        effects: with values; afterwards all their quantities are given.
        peak_effort: motor torque at peak current - N*m (N); infinite where unknown.
        winding: of the motor, for effects that need it.

    Raises:
        InputError: an effect lacks a quantity, or the axis lacks what an effect needs.
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
                "allowed: a rig that states the motor's inertia, and a load beside it",
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

    def acting(self, kind: type[Kind]) -> list[tuple[Kind, dict[str, float]]]:
        """The same with the values of their quantities - SI."""
        return [(p.effect, dict(p.values)) for p in self.effects if isinstance(p.effect, kind)]

    @cached_property
    def native(self) -> tuple[Present, ...]:
        """Mechanisms that MuJoCo makes by itself."""
        scaled = scales_friction(self.effects)
        able = [(p, p.effect) for p in self.effects if isinstance(p.effect, Native)]
        return tuple(p for p, effect in able if effect.native(dict(p.values), scaled))

    @cached_property
    def ticked(self) -> tuple[Present, ...]:
        """Mechanisms that have to act in every step."""
        return tuple(present for present in self.of_kind(Mechanism) if present not in self.native)

    @property
    def stepped(self) -> tuple[Present, ...]:
        """Effects that change friction, inertia or torque of the axis in every step."""
        return *self.ticked, *self.of_kind(OF_TORQUE)

    @property
    def coupled(self) -> bool:
        """Whether an effect joins motor and load."""
        return bool(self.of_kind(Coupling))

    @property
    def all_native(self) -> bool:
        """Whether MuJoCo runs the whole axis and its drive by itself."""
        return not self.ticked and not self.of_kind(IN_THE_LOOP)

    @property
    def structure(self) -> tuple[str, ...]:
        """What is built into the model; models of one structure run side by side."""
        return tuple(present.name for present in self.native)

    def spec(self, timestep: float, load: Load | None = None) -> mujoco.MjSpec:
        """Editable MuJoCo model with all that is native in it; arguments as `build_spec`."""
        spec = build_spec(self.parameters, timestep, load)
        for count, present in enumerate(self.native):
            assert isinstance(present.effect, Native)
            present.effect.add(spec, f"{present.name} {count}", dict(present.values), self.axis)
        return spec

    def with_effects(self, effects: Sequence[Present]) -> AxisModel:
        """The same axis with other effects."""
        return replace(self, effects=tuple(effects))


def scales_friction(effects: Sequence[Present]) -> bool:
    """Whether dry friction changes in every step, or is carried by what bends to its level."""
    return any(isinstance(p.effect, (ScalesFriction, RaisesFriction, CarriesFriction)) for p in effects)


def winding_of(rig: Rig) -> Winding | None:
    """The winding of a rig's motor; None unless constant, resistance, inductance and back-EMF constant are known."""
    motor = rig.motor
    known = motor.resistance, motor.inductance, motor.back_emf_constant
    if motor.torque_per_ampere is None or any(value is None for value in known):
        return None
    resistance, inductance, back_emf = (float(value) for value in known if value is not None)
    return Winding(motor.torque_per_ampere.constant, resistance, inductance, back_emf)
