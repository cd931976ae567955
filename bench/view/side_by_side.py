"""A simulated axis, and a ghost: the measured one, or the demanded motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from bench.arrays import Array
from bench.axis_kind import KINDS, AxisKind
from bench.diagnosis.replay import Replay
from bench.errors import InputError
from bench.plant.drive import Cascade
from bench.plant.model_file import load_model
from bench.plant.plant import Plant
from bench.plant.profiles import MotionLimits, plan
from bench.plant.run import run
from bench.plant.sensing import reported_states
from bench.rig.rig import Rig


@dataclass(frozen=True)
class SideBySide:
    """Motion of both at the same times, (n,) each; nan where one is not known.

    Attributes:
        kind: of the axis.
        ghost_is: what the ghost is, in words.
        simulated_is: how the model was run, in a sentence.
        time: s.
        ghost, position: of ghost and model - rad (m).
        ghost_velocity, velocity: of both - rad/s (m/s).
        others: positions of the model where it was run otherwise, by how - rad (m).
    """

    kind: AxisKind
    ghost_is: str
    simulated_is: str
    time: Array
    ghost: Array
    position: Array
    ghost_velocity: Array
    velocity: Array
    others: Mapping[str, Array] = field(default_factory=dict)

    @property
    def apart(self) -> Array:
        """Model less ghost - rad (m) - (n,)."""
        return self.position - self.ghost

    def between(self, start: float | None, stop: float | None) -> SideBySide:
        """The part from one time to another - s.

        Raises:
            InputError: fewer than two samples lie between them.
        """
        first, last = float(self.time[0]), float(self.time[-1])
        kept = (self.time >= (first if start is None else start)) & (self.time <= (last if stop is None else stop))
        if np.count_nonzero(kept) < 2:
            found = f"found {first if start is None else start:g} s to {last if stop is None else stop:g} s"
            raise InputError("--from, --to", found, f"allowed: a part of {first:g} s to {last:g} s")
        signals = ("time", "ghost", "position", "ghost_velocity", "velocity")
        others = {how: position[kept] for how, position in self.others.items()}
        return replace(self, others=others, **{name: getattr(self, name)[kept] for name in signals})


@dataclass(frozen=True)
class RobotAlong:
    """A robot along a log.

    Attributes:
        mjcf: of the robot.
        joint: that the motion is of, whose motor turns `ratio` times as far.
        ratio: of its gear.
        times: when its joints were somewhere - s (n,).
        poses: where they were then, by name - rad (m) - (n,).
    """

    mjcf: Path
    joint: str
    ratio: float
    times: Array
    poses: Mapping[str, Array]


def along_recording(model: str | Path, replayed: Replay) -> SideBySide:
    """A model that was replayed along a recording, with the measured axis.

    Raises:
        InputError: the model is only a torque balance, so that nothing moves.
    """
    if not np.isfinite(replayed.position_simulated).any():
        allowed = "allowed: a model with [parameters], as diagnose writes it where MuJoCo can have the model"
        raise InputError(f"{model}: parameters", "missing, so that nothing can move", allowed)
    effort = {kind.effort_unit: kind.effort for kind in KINDS}.get(replayed.effort_unit, "effort")
    return SideBySide(
        kind=next(kind for kind in KINDS if kind.speed_unit == replayed.speed_unit),
        ghost_is="measured",
        simulated_is=f"The recorded {effort} drives the model, which is weakly coupled to the recording.",
        time=replayed.time,
        ghost=replayed.position,
        position=replayed.position_simulated,
        ghost_velocity=replayed.velocity,
        velocity=replayed.velocity_simulated,
    )


def along_profile(path: str | Path, rig: Rig, profile: str) -> SideBySide:
    """A model under the drive of a rig along a profile, with the demanded motion.

    Raises:
        InputError: no model, one of another kind of axis, or a rig without drive.
        SimulationError: the simulation diverged.
    """
    stored, cascade = load_model(path, scaled=True), Cascade.from_rig(rig)
    kind = stored.model.parameters.kind
    if kind is not rig.axis_kind:
        raise InputError(f"{path}: kind", f"found '{kind.name}'", f"allowed: '{rig.kind}', as in {rig.source}")
    asked = plan(profile, MotionLimits.from_rig(rig, stored.model.parameters, cascade.control_period))
    plant = Plant(stored.model, cascade, cascade.control_period)
    states = reported_states(plant.model, run(plant, asked))
    return SideBySide(
        kind=kind,
        ghost_is="demanded",
        simulated_is=f"The drive of {rig.name} makes the model follow {profile.replace('_', ' ')}.",
        time=asked.time,
        ghost=asked.position,
        position=states.position,
        ghost_velocity=asked.velocity,
        velocity=states.velocity,
    )
