"""Columns of a hypothesis: the recording as it sees it, laid out for least squares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.dead_zone import dead_zone_columns
from bench.diagnose.friction_levels import rubbing
from bench.diagnose.hypothesis import (
    BACKLASH,
    CURRENT_LAG,
    ECCENTRICITY,
    ELASTIC,
    TRANSFORMS,
    VELOCITY_LAG,
    Hypothesis,
    Named,
)
from bench.diagnose.load_side import acting
from bench.diagnose.outside import physics_of
from bench.diagnose.soft_coupling import Acting, coupled_columns
from bench.diagnose.transforms import corrected, lagged
from bench.diagnose.workbench import Workbench
from bench.effects.effect import Column, Signals

Array = NDArray[np.float64]

#: Owners of columns that belong to no effect.
BASE, MAINS = -1, -2
#: Column of the time by which torque is behind speed.
MISALIGNMENT = 3


def prepared(bench: Workbench, hypothesis: Hypothesis) -> Workbench:
    """The recording as the hypothesis sees it: angle corrected, torque as it acts."""
    eccentricity = hypothesis.shape_of(ECCENTRICITY)
    lag = (hypothesis.shape_of(CURRENT_LAG) or (0.0,))[0]

    def change(signals: Signals) -> Signals:
        signals = corrected(signals, eccentricity) if eccentricity else signals
        effort = lagged(signals.effort, lag, signals.sample_period) if lag else signals.effort
        return replace(signals, torque=effort)

    if not (eccentricity or lag):
        return bench
    return replace(bench.with_signals(change), memory=bench.memory)  # its keys name eccentricity and lag


def kinematic(bench: Workbench, order: int) -> tuple[str, int]:
    """Raw signal and derivative that give the `order`-th derivative of speed."""
    return ("position", order + 1) if bench.conditioning.source == "position" else ("velocity", order)


def lags(bench: Workbench, hypothesis: Hypothesis) -> tuple[float, float]:
    """Lag to undo on speed and acceleration, and on everything else - s."""
    current = (hypothesis.shape_of(CURRENT_LAG) or (0.0,))[0]
    velocity = (hypothesis.shape_of(VELOCITY_LAG) or (0.0,))[0] if bench.conditioning.source == "velocity" else 0.0
    return current + velocity, current


def build(bench: Workbench, hypothesis: Hypothesis) -> tuple[Array, NDArray[np.int64]]:
    """Columns (m, p) of a hypothesis and the effect each belongs to (p,)."""
    seen = prepared(bench, hypothesis)
    moving, resting = lags(bench, hypothesis)
    speed, acceleration = kinematic(bench, 0), kinematic(bench, 1)

    def motion(signals: Signals) -> list[Column]:
        return [[(getattr(signals, name), order)] for name, order in (acceleration, speed)]

    made_of = moving, resting, hypothesis.shape_of(ECCENTRICITY)
    parts = [
        seen.memory.get(("motion", *made_of), lambda: seen.table(motion, moving)),
        seen.memory.get(("rest", *made_of), lambda: seen.table(lambda s: [[(s.sign, 0)], [(-s.effort, 1)]], resting)),
    ]
    owners = [BASE] * 4
    if hypothesis.mains:
        parts.append(seen.table(lambda s: [wave for f in hypothesis.mains for wave in _hum(s, f)], resting))
        owners += [MAINS] * 2 * len(hypothesis.mains)
    for index, effect in enumerate(hypothesis.effects):
        rubbed, loads = rubbing(seen, hypothesis, index), acting(hypothesis) if effect.name == ELASTIC else ()

        def table_of(rubbed: Workbench = rubbed, effect: Named = effect, loads: Sequence[Acting] = loads) -> Array:
            return effect_columns(rubbed, effect, moving, resting, loads)

        shared = rubbed is seen and not loads
        table = seen.memory.get((effect, *made_of), table_of) if shared else table_of()
        parts.append(table)
        owners += [index] * table.shape[1]
    return np.concatenate(parts, axis=1), np.array(owners)


def _hum(signals: Signals, frequency: float) -> list[Column]:
    angle = 2.0 * np.pi * frequency * signals.time
    return [[(np.sin(angle), 0)], [(np.cos(angle), 0)]]


def effect_columns(
    seen: Workbench, effect: Named, moving: float, resting: float, loads: Sequence[Acting] = ()
) -> Array:
    """Columns (m, k) of one effect; none for one that only changes how the others are made."""
    if effect.name == ELASTIC:
        return coupled_columns(seen, [effect.shape], loads, moving)
    if effect.name == BACKLASH:
        return dead_zone_columns(seen, np.array([effect.shape]), moving)
    if effect.name in TRANSFORMS:
        return np.empty((seen.effort.size, 0))
    physics = physics_of(effect.name)
    return seen.table(lambda s: physics.columns(s, effect.shape), resting)
