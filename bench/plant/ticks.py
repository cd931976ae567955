"""Axes side by side on a batch, their drives ticked in Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from mujoco.batch import MODEL_FIELDS, Batch

from bench.effects.kinds import Sensing
from bench.effects.mjcf import AXIS, DRIVE
from bench.errors import SimulationError
from bench.plant.drive import Cascade, CascadeDrive, FrictionEmulation
from bench.plant.plant import Plant
from bench.plant.quiet import quiet
from bench.plant.references import References, side_by_side
from bench.plant.rows import abreast, gather
from bench.plant.seat import BatchSeat
from bench.plant.sensing import seen_by_drive
from bench.plant.states import DIVERGED, States
from bench.plant.ticked import TickedEffects

Progress = Callable[[float], None]

#: Axes from which it pays to share a step between threads: calling them costs some 10 to 50 us, an axis 2 to 4.
SHARED_FROM = 64
#: Ticks between two reports of progress.
REPORT_EVERY = 1000


def run_ticks(plants: Sequence[Plant], references: Sequence[References], progress: Progress | None = None) -> States:
    """Axes side by side, their drives ticked in Python; the same arithmetic for one axis and a thousand."""
    compiled = {plant: plant.spec().compile() for plant in set(plants)}
    batch = batch_of([compiled[plant] for plant in plants])
    joint = batch.model.joint(AXIS)
    position = batch.bind("qpos")[:, joint.qposadr[0]]
    velocity = batch.bind("qvel")[:, joint.dofadr[0]]
    torque_input = batch.bind("ctrl")[:, batch.model.actuator_ctrladr[batch.model.actuator(DRIVE).id]]
    motion, substeps = side_by_side(list(references)), plants[0].substeps
    half = plants[0].timestep / 2.0
    drive = CascadeDrive(_cascades(plants), motion, _emulations(plants))
    velocity[:] = motion.velocity[0]
    position[:] = motion.position[0] + half * velocity
    models = [plant.model for plant in plants]
    encoders = [rows for rows in gather(models, Sensing) if rows.effect.overrides("seen")]
    ticked = any(not model.all_native for model in models)
    acting = TickedEffects(BatchSeat(batch), models, abreast(velocity)) if ticked else None
    record = States(motion.time, *(np.zeros_like(motion.velocity) for _ in range(4)))
    with quiet():
        for k in range(len(motion.time)):
            now = abreast(velocity)
            there = abreast(position) - half * now
            record.position[k], record.velocity[k] = there, now
            setpoint, motor = drive.tick(k, *seen_by_drive(encoders, there, now))
            if acting is None:
                record.torque[k], record.motor_torque[k] = setpoint, motor
                torque_input[:] = motor
                batch.step(nstep=substeps)
            else:
                for substep in range(substeps):
                    time = motion.time[k] + substep * batch.model.opt.timestep
                    flowing, acts = acting.act(time, abreast(position), abreast(velocity), motor)
                    torque_input[:] = acts
                    record.torque[k] += (setpoint + (flowing - motor)) / substeps
                    record.motor_torque[k] += acts / substeps
                    batch.step()
            if progress is not None and k % REPORT_EVERY == 0:
                progress(k / len(motion.time))
    if batch.warning.any():
        raise SimulationError(DIVERGED)
    return record


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


def _cascades(plants: Sequence[Plant]) -> Cascade:
    names = ("position_gain", "velocity_gain", "integral_gain", "inertia_feedforward", "torque_limit")
    gains = {name: abreast([float(getattr(plant.cascade, name)) for plant in plants]) for name in names}
    return Cascade(**gains, control_period=plants[0].cascade.control_period)


def _emulations(plants: Sequence[Plant]) -> FrictionEmulation | None:
    """Friction made in software, null on axes that have theirs in the mechanics; None if all of them do."""
    if not any(plant.emulated for plant in plants):
        return None
    made = [plant.parameters if plant.emulated else plant.parameters.frictionless for plant in plants]
    return FrictionEmulation(
        abreast([parameters.viscous_friction_coefficient for parameters in made]),
        abreast([parameters.coulomb_friction for parameters in made]),
        abreast([parameters.inertia for parameters in made]),
    )
