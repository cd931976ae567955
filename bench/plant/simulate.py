"""Simulate a rig: its axis under its drive along a motion, as its sensors record it, with the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.effects.present import Present
from bench.errors import InputError
from bench.plant.limits import MotionLimits
from bench.plant.plant import Plant
from bench.plant.profile_names import DEFAULT
from bench.plant.profiles import plan
from bench.plant.references import References
from bench.plant.run import run
from bench.plant.s_curve import MOST_TICKS
from bench.plant.sensing import reported_states
from bench.plant.sensors import Sensors
from bench.plant.states import States
from bench.plant.ticked import Progress
from bench.plant.truth import Truth
from bench.rig.rig import Rig
from bench.trace.trace import Trace


@dataclass(frozen=True)
class Simulated:
    """One simulated recording.

    Attributes:
        trace: what the sensors recorded.
        truth: what it was simulated from.
        states: the true motion at the drive's ticks, signals of shape (ticks, 1).
        references: what the drive followed.
    """

    trace: Trace
    truth: Truth
    states: States
    references: References


def simulate(
    rig: Rig,
    profile: str = DEFAULT,
    seed: int = 0,
    references: References | None = None,
    progress: Progress | None = None,
    effects: Sequence[Present] = (),
) -> Simulated:
    """Simulate the axis of a rig.

    Args:
        rig: with `[drive]` and `[simulation]`.
        profile: name of the motion, see `bench.plant.profiles`.
        seed: of the sensors' noise.
        references: a motion of one's own, signals of shape (ticks,); `profile` then only names it.
        progress: called with the share done.
        effects: added to it, in any order.

    Raises:
        InputError: the rig lacks what the simulation needs, or the profile is unknown.
        SimulationError: the simulation diverged.
    """
    plant, sensors = Plant.from_rig(rig, effects), Sensors.from_rig(rig)
    if references is None:
        references = plan(profile, MotionLimits.from_rig(rig, plant.parameters, plant.cascade.control_period))
    steps = float(references.time[-1]) / plant.timestep
    if steps > MOST_TICKS:
        allowed = f"allowed: up to {MOST_TICKS:g} for this motion"
        raise InputError(f"{rig.source}: simulation.timestep", f"takes {steps:.3g} steps", allowed)
    states = run([plant], [references], progress)
    origin = f"simulation of {rig.name}, {profile}, seed {seed}"
    trace = sensors.record(reported_states(plant.model, states), references, np.random.default_rng(seed), origin)
    friction = "drive" if plant.emulated else "mechanics"
    truth = Truth(rig.name, plant.parameters, friction, sensors, profile, seed, plant.model.effects)
    return Simulated(trace, truth, states, references)
