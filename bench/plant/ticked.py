"""The ticked runner: axes side by side on a batch, their controllers and effects acting between MuJoCo's steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from mujoco.batch import MODEL_FIELDS, Batch
from numpy.typing import NDArray

from bench.effects.axis import Number
from bench.effects.mjcf import AXIS, DRIVE
from bench.plant.closed_loop import ClosedLoop, States
from bench.plant.joints import BatchJoints
from bench.plant.stepped_effects import SteppedEffects, per_axis

Progress = Callable[[float], None]

#: Axes from which it pays to share a step between threads: calling them costs some 10 to 50 us, an axis 2 to 4.
SHARED_FROM = 64
#: Ticks between two reports of progress.
REPORT_EVERY = 1000


def run_ticked(loops: Sequence[ClosedLoop], progress: Progress | None = None) -> States:
    """Motion of axes side by side, nan where one diverged; the same arithmetic for one axis and a thousand.

    MuJoCo's warnings are the caller's to silence.

    Args:
        loops: alike, as `ClosedLoop.alike` has it; all run as long as the longest.
        progress: called with the share done.
    """
    axes, every = _SideBySide(loops), loops[0].every
    time = max((loop.time for loop in loops), key=len)
    recorded = States(time[::every], *np.zeros((4, -(-time.size // every), len(loops))))
    for k in range(time.size):
        position, velocity = axes.state()
        setpoint, motor = axes.controller.tick(k, position, velocity)
        reported, made = axes.advance(time[k], setpoint, motor)
        if k % every == 0:
            row = k // every
            recorded.position[row], recorded.velocity[row] = position, velocity
            recorded.torque[row], recorded.motor_torque[row] = reported, made
        if progress is not None and k % REPORT_EVERY == 0:
            progress(k / time.size)
    recorded.velocity[:, axes.diverged] = np.nan
    return recorded


class _SideBySide:
    """Axes on a batch."""

    def __init__(self, loops: Sequence[ClosedLoop]) -> None:
        batch, first = batch_of([loop.compiled for loop in loops]), loops[0]
        joint, actuator = batch.model.joint(AXIS), batch.model.actuator(DRIVE).id
        self._batch, self._step, self._substeps = batch, batch.model.opt.timestep, first.substeps
        self._position = batch.bind("qpos")[:, joint.qposadr[0]]
        self._velocity = batch.bind("qvel")[:, joint.dofadr[0]]
        self._velocity[:] = [loop.velocity for loop in loops]
        self._position[:] = np.array([loop.position for loop in loops]) + self._step / 2.0 * self._velocity
        at = batch.model.actuator_ctrladr[actuator]
        inputs = batch.bind("ctrl")[:, at : at + batch.model.actuator_ctrlnum[actuator]]
        self._effort = inputs[:, -1]
        self.controller = type(first.controller).side_by_side(loops, inputs[:, :-1])
        self._since, self._began = (per_axis([getattr(loop, name) for loop in loops]) for name in ("since", "began"))
        self._effects = None
        if not all(loop.axis.all_native for loop in loops):
            axes = [loop.axis for loop in loops]
            self._effects = SteppedEffects(BatchJoints(batch), axes, per_axis(self._velocity))

    def state(self) -> tuple[Number, Number]:
        """True position and velocity as they are now - rad (m), rad/s (m/s) - (axes,), or numbers of a lone axis."""
        self._here, self._now = per_axis(self._position), per_axis(self._velocity)
        return self._here - self._step / 2.0 * self._now, self._now

    def advance(self, time: float, setpoint: Number, motor: Number) -> tuple[Number, Number]:
        """Go on by a tick from the state that was read; returns reported effort and motor torque, means over its steps.

        Args:
            time: at its start - s.
            setpoint, motor: effort that is reported, and asked of the motor - N*m (N).
        """
        if self._effects is None:
            self._effort[:] = motor
            self._batch.step(nstep=self._substeps)
            return setpoint, motor
        flowing, acting = self._step_on(time, motor)
        if self._substeps > 1:
            for substep in range(1, self._substeps):
                self.state()
                flows, acts = self._step_on(time + substep * self._step, motor)
                flowing, acting = flowing + flows, acting + acts
            flowing, acting = flowing / self._substeps, acting / self._substeps
        return setpoint + (flowing - motor), acting

    def _step_on(self, time: float, motor: Number) -> tuple[Number, Number]:
        """One step from the state that was read: effort that flows, and acts - N*m (N) - (axes,)."""
        assert self._effects is not None
        flowing, acts = self._effects.act(self._since + time, self._here, self._now, motor, self._began)
        self._effort[:] = acts
        self._batch.step()
        return flowing, acts

    @property
    def diverged(self) -> NDArray[np.bool_]:
        """Of which axes MuJoCo warned - (axes,)."""
        return np.any(np.reshape(self._batch.warning, (self._batch.nsim, -1)), axis=1)


def batch_of(models: Sequence[mujoco.MjModel]) -> Batch:
    """A batch with one simulation per model; fields in which the models differ become per-simulation ones."""
    batch = Batch(models[0], len(models), nthread=1 if len(models) < SHARED_FROM else 0)
    distinct = list({id(model): model for model in models}.values())
    for name in sorted(MODEL_FIELDS):
        if len(distinct) > 1 and not name.startswith("opt."):
            values = {id(model): getattr(model, name) for model in distinct}
            if any(not np.array_equal(value, values[id(models[0])]) for value in values.values()):
                batch.expand(name)[:] = np.stack([values[id(model)] for model in models])
    return batch
