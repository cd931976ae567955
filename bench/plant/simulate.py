"""Simulate a rig: its axis under its drive along a motion as its sensors record it, and the truth to write beside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.effects.present import Present
from bench.errors import InputError
from bench.files import write_text
from bench.plant.axis_model import AxisParameters, effect_values
from bench.plant.closed_loop import States
from bench.plant.drive import References
from bench.plant.plant import Plant
from bench.plant.profile_names import DEFAULT
from bench.plant.profiles import MOST_TICKS, MotionLimits, plan
from bench.plant.run import Progress, run
from bench.plant.sensing import Sensors, reported_states
from bench.rig.rig import Rig
from bench.structured import json_text
from bench.trace.trace import Trace

SCHEMA = "bench.truth/1"


@dataclass(frozen=True)
class Simulated:
    """What the sensors recorded, what of, the true motion at the drive's ticks - (ticks, 1) - and what the drive
    followed.
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


@dataclass(frozen=True)
class Truth:
    """What a trace was simulated from; `friction` is `mechanics`, or `drive` where the drive's software makes it."""

    rig: str
    parameters: AxisParameters
    friction: str
    sensors: Sensors
    profile: str
    seed: int
    effects: tuple[Present, ...] = ()

    def as_json(self) -> str:
        """Truth as text, quantities under the names that `bench identify --json` gives them."""
        kind = self.parameters.kind
        units = {
            "sample_period": "s",
            "encoder_resolution": kind.length_unit,
            "velocity_noise": kind.speed_unit,
            "current_noise": "A" if self.sensors.torque_constant else kind.effort_unit,
        }
        sensors = {name: (getattr(self.sensors, name), unit) for name, unit in units.items()}
        content = {
            "schema": SCHEMA,
            "rig": self.rig,
            "kind": kind.name,
            "profile": self.profile,
            "seed": self.seed,
            "friction": self.friction,
            "parameters": _with_units(self.parameters.values),
            "sensors": _with_units(sensors),
            "effects": [{"name": p.name, "parameters": _with_units(effect_values(p, kind))} for p in self.effects],
        }
        return json_text(content) + "\n"


def _with_units(values: dict[str, tuple[float, str]]) -> dict[str, dict[str, float | str]]:
    return {name: {"value": value, "unit": unit} for name, (value, unit) in values.items()}


def truth_path(trace: str | Path) -> Path:
    """Where the truth of a trace lies: `run.csv.gz` has `run.csv.gz.truth.json`."""
    return Path(f"{trace}.truth.json")


def write_truth(trace: str | Path, truth: Truth) -> Path:
    """Write the truth beside a trace, whole or not at all, and return its path; InputError where that cannot be."""
    path = truth_path(trace)
    write_text(path, truth.as_json())
    return path
