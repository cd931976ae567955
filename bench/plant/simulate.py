"""Simulate a rig: its axis under its drive along a motion as its sensors record it, and its truth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from bench.arrays import Array, rms
from bench.effects.present import GivenEffects, Present, given_effects
from bench.errors import InputError
from bench.files import write_text
from bench.names import percent, with_known_arguments
from bench.plant.axis_model import AxisParameters, effect_values
from bench.plant.drive import References
from bench.plant.plant import OF_MECHANICS, Plant, States
from bench.plant.profile_names import DEFAULT
from bench.plant.profiles import MOST_TICKS, MotionLimits, plan
from bench.plant.run import Progress, run
from bench.plant.sensing import Sensors, reported_states
from bench.presented import ByName, Shown
from bench.rig.given import GivenRig, rig_of
from bench.rig.rig import Rig
from bench.structured import json_text
from bench.trace.trace import Trace

SCHEMA = "bench.truth/1"
#: A torque that turns back by this share, in this share of the ticks, chatters: rigid axes 0.0005, unstable ones 0.03.
TURNS_BACK, CHATTERS = 0.05, 0.01
#: RMS deviation from the profile's speed, over its RMS, from which an axis does not follow: 0.1 of sound drives.
ASTRAY = 0.5


@dataclass(frozen=True, repr=False)
class Simulated(Shown):
    """What the sensors recorded, what of, the true motion at the drive's ticks, what the drive followed, and what the
    user should know of the simulation; `[name]` gives a recorded signal.
    """

    trace: Trace
    truth: Truth
    states: States
    references: References
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        hidden = ", ".join(present.name for present in self.truth.effects) or "no effect"
        return f"Simulated({self.trace!r}, with {hidden})"

    def __getitem__(self, name: str) -> Array:
        return self.trace[name]


@with_known_arguments
def simulate(
    rig: GivenRig,
    profile: str | Trace | ArrayLike = DEFAULT,
    seed: int = 0,
    references: References | None = None,
    progress: Progress | None = None,
    effects: GivenEffects = (),
    duration: float | None = None,
) -> Simulated:
    """Simulate the axis of a rig.

    Args:
        rig: with `[drive]` and `[simulation]`, as `identify` takes it.
        profile: name of the motion, see `bench.plant.profiles`; or a recording whose motion is followed; or speeds
            - rad/s (m/s) - (n,), one each sample period of `[simulation]`.
        seed: of the sensors' noise.
        references: a motion of one's own, signals of shape (ticks,); `profile` then only names it.
        progress: called with the share done.
        effects: added to it, in any order; as texts, `unbalance:amplitude=0.1`, or by their names in a dictionary,
            `{"unbalance": {"amplitude": 0.1}}`, with numbers in SI or texts with a unit.
        duration: of the beginning of the motion that is simulated - s; all of it by default.

    Raises:
        InputError: the rig lacks what the simulation needs, or the profile is unknown.
        SimulationError: the simulation diverged.
    """
    rig = rig_of(rig)
    plant, sensors = Plant.from_rig(rig, given_effects(effects, rig.axis_kind)), Sensors.from_rig(rig)
    _require_possible(plant)
    period = plant.cascade.control_period
    if references is None and not isinstance(profile, str):
        references = followed(profile, sensors.sample_period, period)
        profile = f"motion of {profile.origin}" if isinstance(profile, Trace) else "given speeds"
    profile = str(profile)
    if references is None:
        references = plan(profile, MotionLimits.from_rig(rig, plant.axis.parameters, period))
    if duration is not None:
        references = references.until(duration)
    steps = float(references.time[-1]) / plant.timestep
    if steps > MOST_TICKS:
        allowed = f"allowed: up to {MOST_TICKS:g} for this motion"
        raise InputError(f"{rig.source}: simulation.timestep", f"takes {steps:.3g} steps", allowed)
    states = run(plant, references, progress)
    origin = f"simulation of {rig.name}, {profile}, seed {seed}"
    trace = sensors.record(reported_states(plant.model, states), references, np.random.default_rng(seed), origin)
    friction = "drive" if plant.emulated else "mechanics"
    truth = Truth(rig.name, plant.axis.parameters, friction, sensors, profile, seed, plant.model.effects)
    return Simulated(trace, truth, states, references, tuple(_warnings(rig, plant, states, references)))


def _warnings(rig: Rig, plant: Plant, states: States, references: References) -> Iterator[str]:
    """Where friction acts, if not as the rig has it; whether the drive chatters or does not follow its profile."""
    if rig.simulated.friction == "drive" and not plant.emulated:
        names = ", ".join(present.name for present in plant.axis.of_kind(OF_MECHANICS))
        yield f"all friction acts in the mechanics, as {names} needs; in the rig the drive makes it"
    loop, cascade = plant.velocity_loop, plant.cascade
    change, largest = np.diff(states.motor_torque), float(np.abs(states.motor_torque).max())
    back = (change[1:] * change[:-1] < 0.0) & (np.abs(change[1:]) > TURNS_BACK * largest)
    if (share := float(np.mean(back))) > CHATTERS:
        why = "its velocity loop is not the reason: lower the other gains"
        if loop >= 1.0:
            inertia = "of the motor without its load" if plant.axis.coupled else "of the axis"
            why = (
                f"in each it removes {loop:.2g} times the speed error (velocity_gain*control_period over the inertia "
                f"{inertia}), which alternates above 1 and grows above 2; set [drive] control_period to "
                f'"{1e6 * cascade.control_period / (1 + int(loop)):.3g} us"'
            )
        yield f"the simulated drive chatters: its torque alternates in {percent(share)} of the control periods; {why}"
    missed, planned = rms(states.velocity - references.velocity), rms(references.velocity)
    if missed > ASTRAY * planned:
        full = float(np.mean(np.abs(states.torque) >= (1.0 - 1e-6) * cascade.torque_limit))
        yield (
            f"the simulated axis does not follow its profile: the speed is off by {missed / planned:.2g} times the "
            f"profile's RMS speed, with the torque at its limit for {percent(full)} of the time"
        )


def _require_possible(plant: Plant) -> None:
    """InputError where an effect has a value that it cannot have on this axis."""
    axis, kind = plant.model.axis, plant.axis.parameters.kind
    for present in plant.axis.effects:
        for name, least in present.effect.least(axis).items():
            value, unit = effect_values(present, kind).get(name, (math.inf, ""))
            if value < least:
                allowed = f"allowed: from {least:g} {unit} on this axis"
                raise InputError(f"effect {present.name}.{name}", f"found {value:g} {unit}", allowed)


@dataclass(frozen=True)
class Truth(ByName):
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
    """Write the truth next to a trace, whole or not at all, and return its path; InputError where that cannot be."""
    path = truth_path(trace)
    write_text(path, truth.as_json())
    return path


#: Width by which a measured speed is smoothed before a drive is commanded to follow it - s.
SMOOTHED = 5e-3
#: In which a motion comes from rest, or to it, where its recording does not - s.
RAMP = 0.1


class Sampled:
    """A motion by its speed - rad/s (m/s) - at rising times - s - (n,) each, from rest to rest without overshoot."""

    def __init__(self, time: Array, speed: Array) -> None:
        time = np.concatenate([[time[0] - RAMP], time, [time[-1] + RAMP]]) - (time[0] - RAMP)
        from scipy.interpolate import PchipInterpolator  # 0.5 s, which only a drawn motion has to pay

        self._speed = PchipInterpolator(time, np.concatenate([[0.0], speed, [0.0]]))
        self._position, self._acceleration = self._speed.antiderivative(), self._speed.derivative()
        self.duration = float(time[-1])
        self.distance = float(self._position(self.duration))
        self.top = float(np.abs(speed).max())

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """Position, speed, acceleration at times within the duration - rad, rad/s, rad/s**2."""
        return self._position(time), self._speed(time), self._acceleration(time)


def motion_of(recording: Trace) -> Sampled:
    """The motion that a recording's drive was commanded to make; where that is not recorded, the one that it made."""
    time = recording.time
    if "velocity_reference" in recording:
        speed = recording["velocity_reference"]
    elif "position_reference" in recording:
        speed = np.gradient(recording["position_reference"], time)
    else:
        from scipy.ndimage import gaussian_filter1d  # 0.1 s, which only a motion without references has to pay

        measured = recording["velocity"] if "velocity" in recording else np.gradient(recording["position"], time)
        known = np.isfinite(measured)
        every = np.interp(time, time[known], measured[known])
        speed = gaussian_filter1d(every, SMOOTHED / recording.sample_period)
    known = np.isfinite(speed)
    return Sampled(time[known], speed[known])


def followed(motion: Trace | ArrayLike, step: float, period: float) -> References:
    """What a drive of a period - s - follows along a recording, or speeds (n,) at a step - s - rad/s (m/s).

    InputError where speeds are not some numbers in a row.
    """
    if isinstance(motion, Trace):
        sampled = motion_of(motion)
    else:
        speed = np.asarray(motion, dtype=np.float64)
        if speed.ndim != 1 or speed.size < 2 or not np.isfinite(speed).all():
            found = f"found an array of shape {speed.shape}"
            raise InputError("profile", found, "allowed: two or more finite speeds, (n,)")
        sampled = Sampled(step * np.arange(speed.size, dtype=np.float64), speed)
    time = period * np.arange(int(sampled.duration / period + 1e-9) + 1, dtype=np.float64)
    return References(time, *sampled.at(time))
