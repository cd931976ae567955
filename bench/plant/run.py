"""Run axes under their drives: native ones as rollouts in C, the others tick by tick on a batch of axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.errors import InputError
from bench.plant.native import run_native
from bench.plant.plant import Plant
from bench.plant.references import References
from bench.plant.states import States, abreast
from bench.plant.ticks import Progress, run_ticks


def run(plants: Sequence[Plant], references: Sequence[References], progress: Progress | None = None) -> States:
    """Axes under their drives along their references, one each, all over the same ticks.

    Axes that MuJoCo runs natively do so in one rollout; if one reaches its torque limit, where the drive holds its
    integrator and MuJoCo's does not, it runs again with the others, tick by tick.

    Raises:
        InputError: references of another period than the drive's, or drives of different periods.
        SimulationError: a simulation diverged.
    """
    _check_ticks(plants, references)
    states = [run_native(p, r) if p.native else None for p, r in zip(plants, references, strict=True)]
    ticked = [i for i, s in enumerate(states) if s is None or _limited(s, plants[i])]
    columns: list[States | None] = list(states)
    for alike in _alike(plants, ticked):
        together = run_ticks([plants[i] for i in alike], [references[i] for i in alike], progress)
        for column, i in enumerate(alike):
            columns[i] = together.axis(column)
    if progress is not None:
        progress(1.0)
    return abreast([column for column in columns if column is not None])


def _alike(plants: Sequence[Plant], indices: Sequence[int]) -> list[list[int]]:
    """Axes grouped by what is built into their models: only such can run side by side."""
    groups: dict[tuple[str, ...], list[int]] = {}
    for i in indices:
        groups.setdefault(plants[i].model.structure, []).append(i)
    return list(groups.values())


def _check_ticks(plants: Sequence[Plant], references: Sequence[References]) -> None:
    period = plants[0].cascade.control_period
    for plant, reference in zip(plants, references, strict=True):
        if plant.cascade.control_period != period or plant.timestep != plants[0].timestep:
            raise InputError("drive.control_period", "found different periods", "allowed: axes that tick together")
        if abs(reference.period / period - 1.0) > 1e-6:
            raise InputError("references", f"found a period of {reference.period:g} s", f"allowed: {period:g} s")


def _limited(states: States, plant: Plant) -> bool:
    return bool((np.abs(states.torque) >= plant.cascade.torque_limit).any())
