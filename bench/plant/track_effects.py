"""An axis with effects tracks a recording with low gains: its velocity less the recorded one is the velocity gap.

As `bench.plant.track`, with every effect where it acts: electronics on the recorded effort before the simulation,
mechanisms in MuJoCo (by rollouts where all of them are native, else step by step), sensing on what comes out. What
holds the model is the true motion as far as the recording tells it: sensing is undone on the set-points, or the model
would be pulled after the sensor's errors.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from bench.arrays import Array
from bench.effects.kinds import Mechanism
from bench.effects.mjcf import AXIS, DRIVE
from bench.errors import SimulationError
from bench.plant.blocks import blocks
from bench.plant.native import OpenLoop, run_blocks
from bench.plant.quiet import quiet
from bench.plant.rows import abreast
from bench.plant.seat import BatchSeat
from bench.plant.states import DIVERGED
from bench.plant.stretches import Held, Reported, Stretch, all_stretches, inputs_of
from bench.plant.ticked import TickedEffects
from bench.plant.ticks import batch_of
from bench.plant.track import BANDWIDTH


def track_motion(held: Held, bandwidth: float = BANDWIDTH) -> tuple[Array, Array]:
    """Position - rad (m) - and velocity - rad/s (m/s) - that a model reports, held to its recording, (n,) each.

    Each stretch without holes starts from the recording; time of effects counts from the recording's start. Where the
    recording holds no position, that of each stretch counts from zero.

    Args:
        held: the model and its recording.
        bandwidth: of the cascade that holds the model - rad/s.

    Returns:
        nan where `bench.plant.track.in_stretches` does not hold.

    Raises:
        SimulationError: the model diverged.
    """
    (simulated,) = _track([held], bandwidth, signals=2)
    if simulated is None:
        raise SimulationError(DIVERGED)
    return simulated[1], simulated[0]


def track_models(held: Sequence[Held], bandwidth: float = BANDWIDTH) -> list[Array | None]:
    """Velocities that models report, each held to its recording - rad/s (m/s) - (n,) each; None where one diverged.

    Models of one structure run side by side, which costs hardly more than one of them where effects are ticked.
    Lone samples between holes are nan, as in `track_motion`.
    """
    return [None if found is None else found[0] for found in _track(held, bandwidth, signals=1)]


def _track(held: Sequence[Held], bandwidth: float, signals: int) -> list[Array | None]:
    """The same as (signals, n): velocity, and position where two signals are wanted."""
    simulated = [np.full((signals, len(one.trace)), np.nan) for one in held]
    stretches = all_stretches(held, bandwidth)
    native = [stretch for stretch in stretches if not stretch.held.model.ticked]
    with quiet():
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            runs = zip(native, pool.map(partial(_run_native, simulated), native), strict=True)
            diverged = {stretch.row for stretch, sound in runs if not sound}
        for alike in _alike([stretch for stretch in stretches if stretch.held.model.ticked]):
            runs = zip(alike, _run_ticked(simulated, alike), strict=True)
            diverged |= {stretch.row for stretch, sound in runs if not sound}
    return [None if row in diverged else found for row, found in enumerate(simulated)]


def _alike(stretches: Sequence[Stretch]) -> list[list[Stretch]]:
    """Stretches that can run side by side: of one structure and timestep, none twice as long as another or more."""
    groups: dict[tuple[object, ...], list[Stretch]] = {}
    for stretch in stretches:
        key = stretch.held.model.structure, round(stretch.compiled.opt.timestep, 12), stretch.steps.bit_length()
        groups.setdefault(key, []).append(stretch)
    return list(groups.values())


def _run_native(simulated: Sequence[Array], stretch: Stretch) -> bool:
    """Run an axis that MuJoCo runs by itself; what it reports goes where its row has it. False if it diverges."""
    (inputs,), reported = inputs_of([stretch]), Reported(stretch, simulated[stretch.row][:, stretch.part])
    try:
        for block in run_blocks(OpenLoop(stretch.compiled, inputs, stretch.steps, *inputs.start)):
            reported.add(block.start, block.position, block.velocity)
    except SimulationError:
        return False
    reported.finish()
    return True


def _run_ticked(simulated: Sequence[Array], stretches: Sequence[Stretch]) -> list[bool]:
    """The same for axes side by side whose effects act in every step."""
    models, inputs = [stretch.compiled for stretch in stretches], inputs_of(stretches)
    batch, step, count = batch_of(models), models[0].opt.timestep, len(stretches)
    joint, first = models[0].joint(AXIS), models[0].actuator_ctrladr[models[0].actuator(DRIVE).id]
    position = batch.bind("qpos")[:, joint.qposadr[0]]
    velocity = batch.bind("qvel")[:, joint.dofadr[0]]
    driven = batch.bind("ctrl")[:, first : first + 3]
    starts = np.array([each.start for each in inputs])
    velocity[:] = starts[:, 1]
    position[:] = starts[:, 0] + step / 2.0 * velocity
    since, began = (abreast([getattr(one, name) for one in stretches]) for name in ("since", "began"))
    mechanisms = [stretch.held.model.with_effects(stretch.held.model.of_kind(Mechanism)) for stretch in stretches]
    acting = TickedEffects(BatchSeat(batch), mechanisms, abreast(velocity))
    reported = [Reported(stretch, simulated[stretch.row][:, stretch.part]) for stretch in stretches]
    sound = np.ones(count, dtype=np.bool_)
    for start, stop in blocks(max(stretch.steps for stretch in stretches), 8 * 5 * count):
        controls, record = np.empty((stop - start, count, 3)), np.empty((2, stop - start, count))
        for i, each in enumerate(inputs):
            controls[:, i] = each(start, stop)
        for k, control in enumerate(controls):
            there, now = abreast(position), abreast(velocity)
            record[0, k], record[1, k] = there - step / 2.0 * now, now
            driven[:] = control
            driven[:, 2] = acting.act(since + (start + k) * step, there, now, abreast(control[:, 2]), began)[1]
            batch.step()
        sound &= np.isfinite(record).all(axis=(0, 1))
        for i, each in enumerate(reported):
            each.add(start, record[0, :, i], record[1, :, i])
    sound &= ~np.asarray(batch.warning).reshape(count, -1).any(axis=1)
    for each in reported:
        each.finish()
    return sound.tolist()
