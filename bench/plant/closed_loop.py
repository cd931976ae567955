"""A closed loop: an axis in MuJoCo and what controls it, ready for one of the two runners; and the motion they give.

MuJoCo's position belongs half a step later than its velocity (see `bench.plant.axis_model`); runners start it there and
bring it back, so that positions in and out of them are those of the velocities beside them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import mujoco
import numpy as np

from bench.arrays import Array
from bench.plant.axis_model import AxisModel
from bench.plant.drive import FollowReferences

#: Inputs of the actuator `drive` that are known before the motion, so that MuJoCo closes the loop: from a tick to
#: before another, held from each to the next - (ticks, inputs + 1). The last two are the motor's effort, and what is
#: known to resist it beside the axis.
PlannedInputs: TypeAlias = Callable[[int, int], Array]
DIVERGED = "the simulation diverged: lower the drive's gains or its control period"


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """An axis with its controller, and how it starts.

    Attributes:
        axis: the model with the effects that act inside the loop.
        compiled: the axis for MuJoCo, what is native in it and its actuator `drive`.
        controller: of the actuator: the drive, or inputs that are known before.
        time: of the controller's ticks, from zero - s - (ticks,).
        position, velocity: to start with - rad (m), rad/s (m/s).
        substeps: steps of the integration per tick.
        every: ticks from one that is recorded to the next.
        since: first tick from the start of the recording, in which the time of effects counts - s.
        began: start of that recording from that of the first, of several that are joined - s.
    """

    axis: AxisModel
    compiled: mujoco.MjModel
    controller: FollowReferences | PlannedInputs
    time: Array
    position: float = 0.0
    velocity: float = 0.0
    substeps: int = 1
    every: int = 1
    since: float = 0.0
    began: float = 0.0

    @property
    def ticks(self) -> int:
        """How many there are."""
        return self.time.size

    @property
    def native(self) -> bool:
        """Whether MuJoCo runs it all by itself."""
        return not isinstance(self.controller, FollowReferences) and self.axis.all_native

    @property
    def alike(self) -> tuple[object, ...]:
        """What loops have in common that can run side by side; none is twice as long as another or more."""
        timestep = round(self.compiled.opt.timestep, 12)
        return type(self.controller), self.axis.structure, timestep, self.substeps, self.every, self.ticks.bit_length()


@dataclass(frozen=True)
class States:
    """True motion at a controller's ticks, without any sensor; position and velocity are simultaneous.

    Attributes:
        time: s - (ticks,).
        position, velocity: rad (m on a linear axis), rad/s (m/s) - (ticks, axes).
        torque: set-point from each tick to the next - N*m (N) - (ticks, axes).
        motor_torque: what the motor makes; less the emulated friction - N*m (N) - (ticks, axes).
    """

    time: Array
    position: Array
    velocity: Array
    torque: Array
    motor_torque: Array

    def axis(self, index: int, ticks: int | None = None) -> States:
        """Motion of one axis, over its first ticks; signals stay two-dimensional."""
        return States(self.time[:ticks], *(signal[:ticks, index : index + 1] for signal in self.signals))

    @property
    def diverged(self) -> bool:
        """Whether a value is not finite: runners leave nan where a simulation diverged."""
        return not all(np.isfinite(signal).all() for signal in self.signals)

    @property
    def signals(self) -> tuple[Array, ...]:
        """All but the time."""
        return self.position, self.velocity, self.torque, self.motor_torque
