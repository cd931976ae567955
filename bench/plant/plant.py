"""A plant: an axis with its drive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import mujoco
import numpy as np

from bench.effects.acting import Friction
from bench.effects.present import Present
from bench.errors import InputError
from bench.plant.axis_model import AxisModel, AxisParameters, winding_of
from bench.plant.closed_loop import ClosedLoop
from bench.plant.drive import Cascade, FollowReferences, References, add_pid, pid_inputs
from bench.rig.rig import Rig


@dataclass(frozen=True)
class Plant:
    """An axis with its drive.

    Attributes:
        axis: with its effects; its friction acts wherever `emulated` says.
        cascade: of the drive.
        timestep: of the integration, a whole part of the control period - s.
        emulated: whether the drive's software makes the friction instead of the mechanics.
    """

    axis: AxisModel
    cascade: Cascade
    timestep: float
    emulated: bool = False

    def __post_init__(self) -> None:
        period = self.cascade.control_period
        if abs(self.substeps * self.timestep / period - 1.0) > 1e-9:
            allowed = f"allowed: the control period of {period:g} s or a whole part of it"
            raise InputError("simulation.timestep", f"found {self.timestep:g} s", allowed)
        friction = self.model.of_kind(Friction)
        if self.emulated and friction:
            allowed = 'allowed: friction = "mechanics" in [simulation], where friction has its effects'
            raise InputError(f"effect {friction[0].name}", "found friction made by the drive", allowed)

    @classmethod
    def from_rig(cls, rig: Rig, effects: Sequence[Present] = ()) -> Plant:
        """The simulated axis that a rig describes; InputError where `[drive]` or `[simulation]` lack or contradict."""
        parameters, cascade = AxisParameters.from_rig(rig), Cascade.from_rig(rig)
        timestep = rig.simulated.timestep or cascade.control_period
        axis = AxisModel(parameters, tuple(effects), float(cascade.torque_limit), winding_of(rig))
        return cls(axis, cascade, timestep, rig.simulated.friction == "drive")

    @cached_property
    def model(self) -> AxisModel:
        """The axis without its drive, whose limit is its peak effort; friction as the mechanics have it."""
        parameters = self.axis.parameters.frictionless if self.emulated else self.axis.parameters
        return replace(self.axis, parameters=parameters, peak_effort=float(self.cascade.torque_limit))

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

    def native_loop(self, references: References) -> ClosedLoop:
        """The axis with its drive as MuJoCo's `pid`, which does not hold its integrator while limited."""
        time = self.timestep * np.arange(references.time.size, dtype=np.float64)
        inputs, start = pid_inputs(self.cascade, references), references.start
        return ClosedLoop(self.model, self._with_pid, lambda first, last: inputs[first:last], time, *start)

    def ticked_loop(self, references: References) -> ClosedLoop:
        """The axis with its drive ticked in Python."""
        drive = FollowReferences(self.cascade, references, self.axis.parameters if self.emulated else None)
        start = references.start
        return ClosedLoop(self.model, self._mechanics, drive, references.time, *start, substeps=self.substeps)

    @cached_property
    def _mechanics(self) -> mujoco.MjModel:
        return self.spec().compile()

    @cached_property
    def _with_pid(self) -> mujoco.MjModel:
        spec = self.spec()
        add_pid(spec, self.cascade)
        return spec.compile()
