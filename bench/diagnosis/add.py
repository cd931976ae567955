"""Add the named effects to the MuJoCo model and keep those that held-out motion confirms.

An effect is accepted if it increases neither the torque gap nor the velocity gap of held-out motion. Changes below the
simulation's own floor are ignored, such as an offset that integral action compensates. So is a simulation that is worse
than the mean speed, such as a motor that slips from cog to cog: then the torque gap alone decides. An effect of drive
or sensor that changes neither torque nor tracked velocity is judged where it is visible: a voltage limit under the
drive of the rig.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import rms
from bench.diagnosis.model import BANDWIDTH, Extension, Stage, holding_bandwidth
from bench.diagnosis.name import Suspects, named
from bench.diagnosis.recordings import Recordings
from bench.diagnosis.refine import NULL, Numbers, Refined, refined, refined_model
from bench.diagnosis.same_axis import SameAxis, same_axis
from bench.diagnosis.tracking import HOLDOUT, RECORDING, HeldOut, Recorded, VelocityGaps
from bench.effects.acting import DriveLimit
from bench.effects.effect import Occasional
from bench.errors import BenchError
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.plant.measured_motion import measured_velocity
from bench.plant.tracking import follow_references
from bench.trace.noise import white_noise


@dataclass(frozen=True)
class Rejected:
    """A name that was not kept.

    Attributes:
        name: of the effect.
        reason: why.
    """

    name: str
    reason: str


@dataclass(frozen=True)
class Added:
    """The accepted effects.

    Attributes:
        extension: the effects accepted, fitted to the whole recording.
        held_out: the motion that they were judged by.
        gaps: velocity gaps, simulated for every addition.
        recorded: the recording, and the holdout where there is one.
        rejected: the others, with the reason.
        refined: the final model, its quantities refined by simulation where that helps.
        repeats: whether the recording's events occur in the holdout too.
        compared: whether the holdout is of this axis.
        warnings: about a holdout of another axis, or a model that MuJoCo cannot simulate.
        closed_loop: velocity gap under the drive of the rig, without and with the effect that is visible only there -
            rad/s (m/s); None without such an effect.
    """

    extension: Extension
    held_out: HeldOut
    gaps: VelocityGaps
    recorded: tuple[Recorded, ...]
    rejected: tuple[Rejected, ...]
    refined: Refined
    repeats: bool
    compared: SameAxis
    warnings: tuple[str, ...]
    closed_loop: tuple[float, float] | None


def add(recordings: Recordings, suspects: Suspects) -> Added:
    """Try every effect, keep those that held-out motion confirms, and refine their model."""
    found = suspects.searched.last
    compared = same_axis(found, recordings.holdout_rows, recordings.base_units)
    repeats = everywhere(Balance.of(found), recordings.holdout_rows)
    held_out = HeldOut.of(recordings, compared.same is not False, repeats)
    recorded = [Recorded.of(RECORDING, recordings.trace, recordings.rig)]
    if recordings.holdout is not None:
        recorded.append(Recorded.of(HOLDOUT, recordings.holdout, recordings.rig, events=repeats))
    extension = Extension(recordings.rows, RECORDING, found.hypothesis, suspects.outside, recordings.rig)
    closed_loop = closed_loop_gap(recordings, extension)
    rejected: list[Rejected] = []
    while True:
        trial = Trial.of(recordings, suspects, held_out, extension)
        trial.gaps.simulate([*trial.pairs, *((stage, each) for stage in extension.stages for each in recorded)])
        against = rejection(trial) or unlimited(extension, closed_loop)
        if against is None:
            break
        rejected.append(Rejected(extension.names[against[0]], against[1]))
        extension = extension.less(against[0])
    kept = refined(recordings, extension.whole, suspects, held_out, trial.gaps)
    problem = [f"not added to the MuJoCo model: {extension.whole.problem}"] if extension.whole.problem else []
    notes = (*compared.warnings, *problem)
    gone = tuple(rejected)
    return Added(extension, held_out, trial.gaps, tuple(recorded), gone, kept, repeats, compared, notes, closed_loop)


def everywhere(balance: Balance, other: Rows | None) -> bool:
    """Whether events repeat in every recording: the holdout shows them at the same time after its start."""
    if other is None or not any(isinstance(term.effect, Occasional) for term in balance.hypothesis.terms):
        return False
    return balance.repeating(True).gap(other) < balance.gap(other)


def bandwidth(extension: Extension, recordings: Recordings) -> float:
    """Bandwidth of the tracking loop for every model of an extension - rad/s."""
    stored = extension.whole.model
    top = float(np.abs(measured_velocity(recordings.trace)).max())
    return BANDWIDTH if stored is None else holding_bandwidth(stored.model, top)


@dataclass(frozen=True)
class Trial:
    """Judgement of effects by held-out motion.

    Attributes:
        recordings, suspects: as of `add`.
        held_out: the motion.
        gaps: of velocity.
        judged: all effects, fitted to the motion that is not held out.
        without: the same without each one of them.
    """

    recordings: Recordings
    suspects: Suspects
    held_out: HeldOut
    gaps: VelocityGaps
    judged: Extension
    without: tuple[Extension, ...]

    @classmethod
    def of(cls, recordings: Recordings, suspects: Suspects, held_out: HeldOut, extension: Extension) -> Trial:
        """The effects of an extension, refitted without the held-out motion."""
        judged = replace(extension, recording=held_out.fitted, rows=held_out.rows)
        laid_out_for = extension.whole if extension.whole.model is not None else extension.stages[0]
        gaps = VelocityGaps(bandwidth(extension, recordings), laid_out_for.fitted.base.inertia)
        without = tuple(judged.less(index) for index in range(len(extension.names)))
        return cls(recordings, suspects, held_out, gaps, judged, without)

    @property
    def pairs(self) -> list[tuple[Stage, Recorded]]:
        """Models and motions to simulate."""
        tried = (self.judged, *self.without) if self.without else ()
        return [(extension.whole, self.held_out.recorded) for extension in tried]


def rejection(trial: Trial) -> tuple[int, str] | None:
    """Index of the last effect that held-out motion contradicts, with the reason; None if it contradicts none."""
    held_out, judged = trial.held_out, trial.judged
    floor = NULL * white_noise(measured_velocity(trial.recordings.trace))
    for index in reversed(range(len(judged.names))):
        less = trial.without[index]
        if judged.occasional(index) and (not held_out.recorded.events or held_out.rows != RECORDING):
            continue
        if held_out.judge.effort.size:  # empty if the axis never moves
            torque = tuple(each.balance(held_out.recorded.events).gap(held_out.judge) for each in (less, judged))
            if torque[1] > torque[0]:
                return index, _grows("torque", torque, judged.rig.effort_unit, held_out)
        velocity = trial.gaps.of(less.whole, held_out.recorded), trial.gaps.of(judged.whole, held_out.recorded)
        allowed = float(np.hypot(velocity[0], floor))
        follows = min(velocity) < held_out.recorded.varies
        if follows and velocity[1] > allowed and not _comes_closer(trial, allowed):
            return index, _grows("velocity", velocity, judged.rig.axis_kind.speed_unit, held_out)
    return None


def _comes_closer(trial: Trial, allowed: float) -> bool:
    """Whether refinement by simulation brings the velocity gap of all effects below what is allowed."""
    whole = trial.judged.whole
    if whole.model is None:
        return True
    numbers = Numbers.of(*named(trial.recordings, whole.fitted, whole.detected(trial.suspects)))
    found = refined_model(whole.model, numbers, trial.held_out, trial.gaps)
    return found is not None and found[2] <= allowed


def closed_loop_gap(recordings: Recordings, extension: Extension) -> tuple[float, float] | None:
    """Velocity gap under the drive of the rig, without and with the effect that is visible only there - rad/s (m/s).

    A prediction from the references of a recording, without tracking. Feedback hides most effects here - the drive
    makes good what the model lacks - but for what happens in the drive itself it is the only place to look: a voltage
    limit acts before the recorded current, with which the held model is fed.

    None where there is no such effect, the rig describes no drive, the recording holds no references, or the simulation
    diverges.
    """
    index = under_drive(extension)
    if index is None or "velocity_reference" not in recordings.trace:
        return None
    without, whole = extension.less(index).whole, extension.whole
    if without.model is None or whole.model is None:
        return None
    ((shown, limit),) = ((one, one.effect) for one in whole.outside if isinstance(one.effect, DriveLimit))
    trace = limit.shown_in(recordings.trace, recordings.rig, dict(shown.values))
    velocity = measured_velocity(trace)
    try:
        followed = [
            follow_references(stored.model, trace, recordings.rig).velocity for stored in (without.model, whole.model)
        ]
    except BenchError:
        return None
    before, after = (rms(simulated - velocity) for simulated in followed)
    return before, after


def under_drive(extension: Extension) -> int | None:
    """Index of the effect that is visible only under the drive of the rig; None without one."""
    own = len(extension.hypothesis.terms)
    shown = [own + k for k, present in enumerate(extension.outside) if isinstance(present.effect, DriveLimit)]
    return shown[0] if shown else None


def unlimited(extension: Extension, closed_loop: tuple[float, float] | None) -> tuple[int, str] | None:
    """The effect visible only under the drive, if it does not reduce the velocity gap there; with the reason."""
    index = under_drive(extension)
    if closed_loop is None or closed_loop[1] < closed_loop[0] or index is None:
        return None
    return index, f"the velocity gap under the rig's drive grows with it: {closed_loop[0]:.3g} -> {closed_loop[1]:.3g}"


def _grows(what: str, gap: tuple[float, ...], unit: str, held_out: HeldOut) -> str:
    return f"the {what} gap of the {held_out.recorded.name} grows with it: {gap[0]:.3g} -> {gap[1]:.3g} {unit}"
