"""A plant: an axis with its drive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import mujoco

from bench.effects.kinds import Friction, Winding
from bench.effects.present import Present
from bench.errors import InputError
from bench.plant.axis_model import AxisModel, winding_of
from bench.plant.drive import Cascade
from bench.plant.model import AxisParameters
from bench.rig.rig import Rig


@dataclass(frozen=True)
class Plant:
    """An axis with its drive.

    Attributes:
        parameters: of the equation of motion; friction in them acts wherever `emulated` says.
        cascade: of the drive.
        timestep: of the integration, a whole part of the control period - s.
        emulated: whether the drive's software makes the friction instead of the mechanics.
        effects: beyond the equation of motion.
        winding: of the motor, for effects that need it.
    """

    parameters: AxisParameters
    cascade: Cascade
    timestep: float
    emulated: bool = False
    effects: tuple[Present, ...] = ()
    winding: Winding | None = None

    def __post_init__(self) -> None:
        if abs(self.substeps * self.timestep / self.cascade.control_period - 1.0) > 1e-9:
            raise InputError(
                "simulation.timestep",
                f"found {self.timestep:g} s",
                f"allowed: the control period of {self.cascade.control_period:g} s or a whole part of it",
            )
        friction = [present.name for present in self.model.of_kind(Friction)]
        if self.emulated and friction:
            raise InputError(
                f"effect {friction[0]}",
                "found friction made by the drive",
                'allowed: friction = "mechanics" in [simulation], where friction has its effects',
            )

    @classmethod
    def from_rig(cls, rig: Rig, effects: Sequence[Present] = ()) -> Plant:
        """The simulated axis that a rig describes, with effects.

        Raises:
            InputError: no `[drive]`, no `[simulation]`, or values in them that do not go together.
        """
        parameters, cascade = AxisParameters.from_rig(rig), Cascade.from_rig(rig)
        assert rig.simulation is not None
        timestep = rig.simulation.timestep or cascade.control_period
        emulated = rig.simulation.friction == "drive"
        return cls(parameters, cascade, timestep, emulated, tuple(effects), winding_of(rig))

    @cached_property
    def model(self) -> AxisModel:
        """The axis without its drive; friction as the mechanics have it."""
        parameters = self.parameters.frictionless if self.emulated else self.parameters
        return AxisModel(parameters, self.effects, float(self.cascade.torque_limit), self.winding)

    @property
    def substeps(self) -> int:
        """Steps of the integration per tick of the drive."""
        return max(1, round(self.cascade.control_period / self.timestep))

    @property
    def native(self) -> bool:
        """Whether MuJoCo's own actuator can be the drive, as long as its torque is not limited."""
        return self.substeps == 1 and not self.emulated and self.model.all_native

    def spec(self) -> mujoco.MjSpec:
        """Model of the mechanics."""
        return self.model.spec(self.timestep)
