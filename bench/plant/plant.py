"""A plant: an axis with its drive."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco

from bench.errors import InputError
from bench.plant.drive import Cascade
from bench.plant.model import AxisParameters, build_spec
from bench.rig.rig import Rig


@dataclass(frozen=True)
class Plant:
    """An axis with its drive.

    Attributes:
        parameters: of the equation of motion; friction in them acts wherever `emulated` says.
        cascade: of the drive.
        timestep: of the integration, a whole part of the control period - s.
        emulated: whether the drive's software makes the friction instead of the mechanics.
    """

    parameters: AxisParameters
    cascade: Cascade
    timestep: float
    emulated: bool = False

    def __post_init__(self) -> None:
        if abs(self.substeps * self.timestep / self.cascade.control_period - 1.0) > 1e-9:
            raise InputError(
                "simulation.timestep",
                f"found {self.timestep:g} s",
                f"allowed: the control period of {self.cascade.control_period:g} s or a whole part of it",
            )

    @classmethod
    def from_rig(cls, rig: Rig) -> Plant:
        """The simulated axis that a rig describes.

        Raises:
            InputError: no `[drive]`, no `[simulation]`, or values in them that do not go together.
        """
        parameters, cascade = AxisParameters.from_rig(rig), Cascade.from_rig(rig)
        assert rig.simulation is not None
        timestep = rig.simulation.timestep or cascade.control_period
        return cls(parameters, cascade, timestep, rig.simulation.friction == "drive")

    @property
    def substeps(self) -> int:
        """Steps of the integration per tick of the drive."""
        return max(1, round(self.cascade.control_period / self.timestep))

    @property
    def native(self) -> bool:
        """Whether MuJoCo's own actuator can be the drive, as long as its torque is not limited."""
        return self.substeps == 1 and not self.emulated

    def spec(self) -> mujoco.MjSpec:
        """Model of the mechanics."""
        return build_spec(self.parameters.frictionless if self.emulated else self.parameters, self.timestep)
