"""A plant: an axis with its drive; what the two runners take of it, closed loops, and the motion that they give.

MuJoCo's position belongs half a step later than its velocity (see `bench.plant.axis_model`); runners start it there and
bring it back, so that positions in and out of them are those of their velocities.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import mujoco
import numpy as np

from bench.arrays import Array
from bench.effects.effect import Bristles, Coupling
from bench.effects.present import Present
from bench.effects.torque import Friction
from bench.errors import InputError
from bench.plant.axis_model import AxisModel, AxisParameters, winding_of
from bench.plant.drive import Cascade, CascadeDrive, References, add_pid, pid_inputs
from bench.rig.rig import Rig

#: Inputs of the actuator `drive` that are known before the motion, so that MuJoCo closes the loop: from a tick to
#: before another, held from each to the next - (ticks, inputs + 1). The last two are the motor's effort, and what is
#: known to resist it in addition to the axis.
PlannedInputs: TypeAlias = Callable[[int, int], Array]
#: Effects with which a drive cannot make the friction.
OF_MECHANICS = (Friction, Bristles, Coupling)
#: Bytes of inputs and states that a simulation keeps at once, however long it is.
BLOCK_BYTES = 8 * 2**20
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
        block_bytes: of inputs and states that are kept at once.
    """

    axis: AxisModel
    compiled: mujoco.MjModel
    controller: CascadeDrive | PlannedInputs
    time: Array
    position: float = 0.0
    velocity: float = 0.0
    substeps: int = 1
    every: int = 1
    since: float = 0.0
    began: float = 0.0
    block_bytes: int = BLOCK_BYTES

    @property
    def ticks(self) -> int:
        """How many there are."""
        return self.time.size

    @property
    def native(self) -> bool:
        """Whether MuJoCo runs it all by itself."""
        return not isinstance(self.controller, CascadeDrive) and self.axis.all_native


@dataclass(frozen=True)
class States:
    """True motion at a controller's ticks (ticks,), without any sensor; position and velocity are simultaneous.

    Attributes:
        time: s.
        position, velocity: rad (m on a linear axis), rad/s (m/s).
        torque: set-point from each tick to the next - N*m (N).
        motor_torque: what the motor makes; less the emulated friction - N*m (N).
    """

    time: Array
    position: Array
    velocity: Array
    torque: Array
    motor_torque: Array

    @property
    def diverged(self) -> bool:
        """Whether a value is not finite: runners leave nan where a simulation diverged."""
        return not all(np.isfinite(signal).all() for signal in self.signals)

    @property
    def signals(self) -> tuple[Array, ...]:
        """All but the time."""
        return self.position, self.velocity, self.torque, self.motor_torque


@dataclass(frozen=True)
class Plant:
    """An axis with its drive.

    Attributes:
        axis: with its effects; its friction acts as in `emulated`.
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

    @classmethod
    def from_rig(cls, rig: Rig, effects: Sequence[Present] = ()) -> Plant:
        """The simulated axis that a rig describes; InputError where `[drive]` or `[simulation]` lack or contradict.

        All friction acts in the mechanics, even where the drive makes the rig's, if an effect is friction too, or frees
        the load from the motor: the drive's software takes both for one rigid axis.
        """
        parameters, cascade = AxisParameters.from_rig(rig), Cascade.from_rig(rig)
        timestep = rig.simulated.timestep or cascade.control_period
        axis = AxisModel(parameters, tuple(effects), cascade.torque_limit, winding_of(rig))
        emulated = rig.simulated.friction == "drive" and not axis.of_kind(OF_MECHANICS)
        return cls(axis, cascade, timestep, emulated)

    @cached_property
    def model(self) -> AxisModel:
        """The axis without its drive, whose limit is its peak effort; friction as the mechanics have it."""
        parameters = self.axis.parameters.frictionless if self.emulated else self.axis.parameters
        return replace(self.axis, parameters=parameters, peak_effort=self.cascade.torque_limit)

    @property
    def velocity_loop(self) -> float:
        """Share of a speed error that the drive removes in one control period; above 1 it alternates, above 2 it grows.

        K_v*T/J, with K_i*T/2 next to K_v; J is what the motor turns at once: without the load where an effect couples
        it.
        """
        cascade, axis = self.cascade, self.axis.parameters
        gain = cascade.velocity_gain + cascade.integral_gain * cascade.control_period / 2.0
        return gain * cascade.control_period / (axis.motor_inertia if self.axis.coupled else axis.inertia)

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
        inputs, start, spec = pid_inputs(self.cascade, references), references.start, self.spec()
        add_pid(spec, self.cascade)
        return ClosedLoop(self.model, spec.compile(), lambda first, last: inputs[first:last], time, *start)

    def ticked_loop(self, references: References) -> ClosedLoop:
        """The axis with its drive ticked in Python, to be run once."""
        emulated, start = self.axis.parameters if self.emulated else None, references.start
        drive = CascadeDrive(self.cascade, references, self.model, emulated)
        return ClosedLoop(self.model, self.spec().compile(), drive, references.time, *start, substeps=self.substeps)
