"""Run axes: those that MuJoCo runs by itself natively, the others tick by tick."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import mujoco
import numpy as np

from bench.errors import InputError, SimulationError
from bench.plant.closed_loop import DIVERGED, ClosedLoop, States, side_by_side
from bench.plant.native import run_native
from bench.plant.plant import Plant
from bench.plant.references import References
from bench.plant.ticked import Progress, run_ticked


def run(plants: Sequence[Plant], references: Sequence[References], progress: Progress | None = None) -> States:
    """Axes under their drives along their references, one each, all over the same ticks.

    Axes that MuJoCo runs natively do so; if one reaches its torque limit, where the drive holds its integrator and
    MuJoCo's does not, it runs again with the others, tick by tick.

    Raises:
        InputError: references of another period than the drive's, or drives of different periods.
        SimulationError: a simulation diverged.
    """
    _check_ticks(plants, references)
    same = {plant: plant for plant in plants}
    pairs = [(same[plant], motion) for plant, motion in zip(plants, references, strict=True)]
    native = [k for k, (plant, _) in enumerate(pairs) if plant.native]
    found = dict(zip(native, run_loops([pairs[k][0].native_loop(pairs[k][1]) for k in native]), strict=True))
    ticked = [k for k, (plant, _) in enumerate(pairs) if k not in found or _limited(found[k], plant)]
    loops = [pairs[k][0].ticked_loop(pairs[k][1]) for k in ticked]
    found |= zip(ticked, run_loops(loops, progress), strict=True)
    if any(states.diverged for states in found.values()):
        raise SimulationError(DIVERGED)
    if progress is not None:
        progress(1.0)
    return side_by_side([found[k] for k in range(len(pairs))])


def run_loops(loops: Sequence[ClosedLoop], progress: Progress | None = None) -> list[States]:
    """Motion of each loop at its own ticks, nan where it diverged.

    Native ones run on all cores, the others side by side with those that are alike, which costs hardly more than one.
    """
    found: dict[int, States] = {}
    alike: dict[tuple[object, ...], list[int]] = {}
    for k, loop in enumerate(loops):
        if not loop.native:
            alike.setdefault(loop.alike, []).append(k)
    native = [k for k, loop in enumerate(loops) if loop.native]
    with silenced():
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            found |= zip(native, pool.map(run_native, (loops[k] for k in native)), strict=True)
        for group in alike.values():
            together = run_ticked([loops[k] for k in group], progress)
            for column, k in enumerate(group):
                found[k] = together.axis(column, -(-loops[k].ticks // loops[k].every))
    return [found[k] for k in range(len(loops))]


def _check_ticks(plants: Sequence[Plant], references: Sequence[References]) -> None:
    period = plants[0].cascade.control_period
    for plant, reference in zip(plants, references, strict=True):
        if plant.cascade.control_period != period or plant.timestep != plants[0].timestep:
            raise InputError("drive.control_period", "found different periods", "allowed: axes that tick together")
        if abs(reference.period / period - 1.0) > 1e-6:
            raise InputError("references", f"found a period of {reference.period:g} s", f"allowed: {period:g} s")


def _limited(states: States, plant: Plant) -> bool:
    return bool((np.abs(states.torque) >= plant.cascade.torque_limit).any())


@contextmanager
def silenced() -> Iterator[None]:
    """Keep MuJoCo from printing warnings and from leaving a MUJOCO_LOG.TXT behind, within the block."""
    before, silent = mujoco.MjLogConfig.get(), mujoco.MjLogConfig.get()
    silent.logto_console = silent.logto_file = False
    silent.set()
    try:
        yield
    finally:
        before.set()
