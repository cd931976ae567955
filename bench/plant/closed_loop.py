"""A closed loop: an axis in MuJoCo and what controls it, ready for one of the two runners; and the motion they give.

MuJoCo's position belongs half a step later than its velocity (see `bench.plant.axis_model`); runners start it there and
bring it back, so that positions in and out of them are those of the velocities beside them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.arrays import Array
from bench.effects.signals import Number
from bench.plant.axis_model import AxisModel
from bench.plant.stepped_effects import per_axis

#: Bytes of inputs and states that a simulation holds at once, however long it is.
BLOCK_BYTES = 8 * 2**20
#: Of the number of a tick, which come in turn, and true position and velocity at it - rad (m), rad/s (m/s) - (axes,):
#: effort from it to the next - N*m (N) - (axes,), reported, asked of the motor, and known to resist beside. Of a lone
#: axis all may be numbers.
Tick = Callable[[int, Number, Number], tuple[Number, Number, Number]]
DIVERGED = "the simulation diverged: lower the drive's gains or its control period"


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """An axis with its controller, and how it starts.

    Attributes:
        axis: the model with the effects that act inside the loop.
        compiled: the axis for MuJoCo, what is native in it and its actuator `drive`.
        controller: of the actuator.
        time: of the controller's ticks, from zero - s - (ticks,).
        position, velocity: to start with - rad (m), rad/s (m/s).
        substeps: steps of the integration per tick.
        every: ticks from one that is recorded to the next.
        since: first tick from the start of the recording, in which the time of effects counts - s.
        began: start of that recording from that of the first, of several that are joined - s.
    """

    axis: AxisModel
    compiled: mujoco.MjModel
    controller: Controller
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
        return isinstance(self.controller, PlannedInputs) and self.axis.all_native

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


class Controller(ABC):
    """What sets the inputs of the actuator `drive` of an axis."""

    @classmethod
    @abstractmethod
    def side_by_side(cls, loops: Sequence[ClosedLoop], setpoints: Array) -> Tick:
        """What controls the axes of loops whose controllers are all of this class.

        `setpoints` are the inputs of the actuators before the effort, to be written at each tick - (axes, inputs).
        """


class PlannedInputs(Controller):
    """Inputs that are known before the motion: MuJoCo's own actuator closes the loop."""

    @abstractmethod
    def between(self, start: int, stop: int) -> Array:
        """Inputs from a tick to before another, held from each to the next - (ticks, inputs + 1).

        The last two are the motor's effort, and what is known to resist it beside the axis.
        """

    @classmethod
    def side_by_side(cls, loops: Sequence[ClosedLoop], setpoints: Array) -> Tick:
        """Read in blocks; after the end of a loop its last inputs are held."""
        rows = _rows_of(loops, setpoints.shape[1] + 2)

        def tick(k: int, position: Number, velocity: Number) -> tuple[Number, Number, Number]:
            inputs = next(rows)
            setpoints[:] = inputs[:, :-2]
            effort = per_axis(inputs[:, -2])
            return effort, effort, per_axis(inputs[:, -1])

        return tick


class Listed(PlannedInputs):
    """Inputs in an array, (ticks, inputs), of an axis with nothing known beside it."""

    def __init__(self, inputs: Array) -> None:
        self._inputs = np.column_stack([inputs, np.zeros(len(inputs))])

    def between(self, start: int, stop: int) -> Array:
        """See `PlannedInputs`."""
        return self._inputs[start:stop]


def blocks(ticks: int, bytes_per_tick: int) -> Iterator[tuple[int, int]]:
    """First tick of each block and the one after its last."""
    size = max(1, BLOCK_BYTES // bytes_per_tick)
    return ((start, min(start + size, ticks)) for start in range(0, ticks, size))


def _rows_of(loops: Sequence[ClosedLoop], inputs: int) -> Iterator[Array]:
    """Planned inputs at each tick of the longest loop - (axes, inputs)."""
    for start, stop in blocks(max(loop.ticks for loop in loops), 8 * inputs * len(loops)):
        held = []
        for loop in loops:
            assert isinstance(loop.controller, PlannedInputs)
            first = min(start, loop.ticks - 1)
            known = loop.controller.between(first, min(stop, loop.ticks))
            held.append(known[np.minimum(np.arange(start, stop), loop.ticks - 1) - first])
        yield from np.stack(held, axis=1)
