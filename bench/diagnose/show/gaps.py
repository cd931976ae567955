"""Show the gap shrink: torque and velocity, on both recordings, after each effect that was kept."""

from __future__ import annotations

import math
from dataclasses import replace

from bench.balance.fit import Fit
from bench.balance.stored import Balance
from bench.diagnose.add.add import Added
from bench.diagnose.found import Gap, Shrunk
from bench.diagnose.recordings import Recordings
from bench.plant.track import measured_velocity
from bench.trace.noise import white_noise


def shrinking(recordings: Recordings, added: Added) -> list[Shrunk]:
    """Gaps of the bare axis and after each addition, the last one as it was kept."""
    found = []
    for stage in added.extension.stages:
        balance = Balance.of(stage.fitted).repeating(added.repeats)
        torque = [balance.gap(rows) for rows in (recordings.rows, recordings.other) if rows is not None]
        velocity = [added.gaps.of(stage, recorded) for recorded in added.recorded]
        found.append(Shrunk(stage.effect, tuple(torque), tuple(velocity)))
    if added.refined.gap is not None:
        velocity = added.gaps.of_models([added.refined.model] * len(added.recorded), added.recorded)
        found[-1] = replace(found[-1], velocity=tuple(velocity))
    return found


def torque_gap(steps: list[Shrunk], whole: Fit, unit: str) -> Gap:
    """Of all effects together, over all rows; beside it what is left on those that judge the fit, where not all do."""
    pairs = list(zip(steps[0].torque, steps[-1].torque, strict=True))
    judged = None if whole.determined.all() else (float(whole.determined.mean()), whole.rms)
    return Gap(unit, whole.floor, pairs[0], pairs[1] if len(pairs) > 1 else None, judged)


def velocity_gap(recordings: Recordings, steps: list[Shrunk]) -> Gap:
    """Of all effects together; None where MuJoCo cannot have the model or a simulation diverged."""
    pairs = [
        pair if all(map(math.isfinite, pair)) else None
        for pair in zip(steps[0].velocity, steps[-1].velocity, strict=True)
    ]
    floor = white_noise(measured_velocity(recordings.trace))
    unit = recordings.rig.axis_kind.speed_unit
    return Gap(unit, floor, pairs[0], pairs[1] if len(pairs) > 1 else None)
