"""Add the named effects to the MuJoCo model, keep those that held-out motion confirms, and refine their model.

An effect is accepted if it increases neither the torque gap nor the velocity gap of held-out motion. Changes below the
simulation's own floor are ignored, such as an offset that integral action compensates. So is a simulation that is worse
than the mean speed, such as a motor that slips from cog to cog: then the torque gap alone decides. An effect of drive
or sensor that changes neither torque nor tracked velocity is judged where it is visible: a voltage limit under the
drive of the rig.

Values are refined by simulation error, and kept so only if that reduces the gap of held-out motion. One Gauss-Newton
step is a bounded linear least-squares problem over the derivatives of the simulated velocity, which are simulated in
parallel: within the intervals of a regression the simulation is nearly linear. Regression first, simulation second, as
in `bench.fit.refine`, which has the figures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bench.arrays import Array, rms
from bench.diagnosis.model import (
    BANDWIDTH,
    HOLDOUT,
    RECORDING,
    Extension,
    HeldOut,
    Placed,
    Recorded,
    VelocityGaps,
    holding_bandwidth,
    present_of,
)
from bench.diagnosis.name import NamedEffect, Suspects, named
from bench.diagnosis.policy import ERRS_TWICE, Policy, Reason
from bench.diagnosis.recordings import Recordings
from bench.diagnosis.same_axis import SameAxis, same_axis
from bench.diagnosis.tabulated import UnknownEffect, unknown_effect, with_tables
from bench.effects.effect import DriveLimit, Occasional
from bench.errors import BenchError, InputError, UndeterminedError
from bench.fit.determined import refused_masses
from bench.fit.estimate import load_inertia
from bench.fit.fit import Fit
from bench.fit.quantities import uncertain
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.gate.signals import clipped
from bench.parameter import Parameter
from bench.plant.model_file import StoredModel
from bench.plant.tracking import follow_references
from bench.trace.motion import measured_velocity
from bench.trace.noise import white_noise

#: Velocity gap over the white noise of the recorded speed below which a change is insignificant (docs/diagnose.md).
NULL = 3.5
#: Least relative reduction of the gap of held-out motion by a refined model; less is chance.
WON = 0.02
#: Step of a derivative, in standard errors; moves are bounded by the interval of 95 %.
STEP = 0.5
BASE = ("inertia", "viscous_friction_coefficient", "coulomb_friction")


@dataclass(frozen=True)
class Added:
    """The accepted effects.

    Attributes:
        recordings, suspects: in which they were found, and among what.
        extension: the effects accepted, fitted to the whole recording.
        stages: the model after none, one, ... all of them.
        gaps: velocity gaps, simulated for every addition.
        recorded: the recording, and the holdout where there is one.
        rejected: names of the others, also of those whose size is not determined, each with the reason.
        model: with these effects, refined by simulation where that helps; None if MuJoCo cannot simulate it.
        effects, parameters: with the values of the model.
        refined: velocity gap of held-out motion before and after refinement - rad/s (m/s); None if not refined.
        repeats: whether the recording's events occur in the holdout too.
        compared: whether the holdout is of this axis.
        closed_loop: velocity gap under the drive of the rig, without and with the effect that is visible only there -
            rad/s (m/s); None without such an effect.
        refused: why a parameter is not determined with the effects, by its name; the model is then the last that is.
        unknown: the effect that remains, tabulated; None where none does, or held-out motion does not confirm it.
    """

    recordings: Recordings
    suspects: Suspects
    extension: Extension
    stages: tuple[Extension, ...]
    gaps: VelocityGaps
    recorded: tuple[Recorded, ...]
    rejected: tuple[tuple[str, Reason], ...]
    model: StoredModel | None
    effects: list[NamedEffect]
    parameters: dict[str, Parameter]
    refined: tuple[float, float] | None
    repeats: bool
    compared: SameAxis
    closed_loop: tuple[float, float] | None
    refused: Mapping[str, str]
    unknown: UnknownEffect | None

    @property
    def tabulated(self) -> StoredModel | None:
        """The model with the tables of an unknown effect in addition, where there is one."""
        return self.model and with_tables(self.model, self.unknown.tables if self.unknown else ())


def add(recordings: Recordings, suspects: Suspects) -> Added:
    """Keep the effects that held-out motion confirms, and refine their model; raises as `last_determined`."""
    found = suspects.fitted
    compared = same_axis(found, recordings.holdout_rows, recordings.base_units)
    repeats = everywhere(Balance.of(found), recordings.holdout_rows)
    held_out = HeldOut.of(recordings, compared.same is not False, repeats, found)
    extension = Extension(recordings.rows, found.hypothesis, suspects.detected, recordings.rig, found)
    recorded = [Recorded(RECORDING, recordings.trace, recordings.rig)]
    if recordings.holdout is not None:  # in which the recording's events occur too or not
        recorded.append(Recorded(HOLDOUT, recordings.holdout, recordings.rig, events=repeats))
    closed_loop, rejected = closed_loop_gap(recordings, extension), [*suspects.rejected.items()]
    while True:
        refused = refusals(recordings, extension.fitted)
        modelled = last_determined(recordings, extension, suspects.policy) if refused else extension
        gaps = holding(extension, modelled, recordings)
        stages, reason = extension.stages, str(next(iter(refused.values()), ""))
        count = next((index for index, stage in enumerate(stages) if stage is modelled), -1) + 1
        stages = (*stages[:count], *(replace(stage, refused=reason) for stage in stages[count:]))
        shown = [(stage, each) for stage in stages for each in recorded]
        by_motion = rejection(recordings, held_out, extension, gaps, shown, suspects.policy)
        against = by_motion or unlimited(extension, closed_loop)
        if against is None:
            break
        rejected.append((extension.names[against[0]], against[1]))
        extension = extension.less(against[0])
    gaps.simulate(shown)
    model, effects, parameters, gap = refined(recordings, stages[-1], suspects, held_out, gaps)
    if refused:
        parameters = {name: found for name, found in parameters.items() if name not in refused}
        model = model or (modelled and modelled.model)
    return Added(
        recordings=recordings,
        suspects=suspects,
        extension=extension,
        stages=stages,
        gaps=gaps,
        recorded=tuple(recorded),
        rejected=tuple(rejected),
        model=model,
        effects=effects,
        parameters=parameters,
        refined=gap,
        repeats=repeats,
        compared=compared,
        closed_loop=closed_loop,
        refused={name: refusal.reason for name, refusal in refused.items()},
        unknown=unknown_effect(stages[-1], held_out) if suspects.policy.remains(extension.fitted) else None,
    )


def everywhere(balance: Balance, other: Rows | None) -> bool:
    """Whether events repeat in every recording: the holdout shows them at the same time after its start."""
    if other is None or not any(isinstance(term.effect, Occasional) for term in balance.hypothesis.terms):
        return False
    return balance.repeating(True).gap(other) < balance.gap(other)


def refusals(recordings: Recordings, fitted: Fit) -> dict[str, UndeterminedError]:
    """Why the inertia, and with it the load's, is not determined together with the effects of a fit, by name."""
    found, rig = recordings.base(uncertain(fitted)), recordings.rig
    masses = found | load_inertia(found, rig)
    return refused_masses(masses, rig, clipped(recordings.trace, rig))


def last_determined(recordings: Recordings, extension: Extension, policy: Policy) -> Extension | None:
    """The last stage that determines the inertia; None where none does because of what is missing from the model.

    UndeterminedError where no missing effect was found, and a mass is not determined.
    """
    for stage in reversed(extension.stages):
        refused = refusals(recordings, stage.fitted)
        if recordings.rig.axis_kind.inertia not in refused:
            break
    else:
        stage, refused = None, refusals(recordings, extension.stages[0].fitted)
    if refused and not policy.remains(extension.stages[0].fitted):
        raise next(iter(refused.values()))
    return stage


def holding(extension: Extension, modelled: Extension | None, recordings: Recordings) -> VelocityGaps:
    """Velocity gaps under a cascade that keeps every model of an extension to the recording, `modelled` the last."""
    if modelled is None or modelled.model is None:
        return VelocityGaps(BANDWIDTH, extension.stages[0].fitted.base.inertia if modelled else None)
    top = float(np.abs(measured_velocity(recordings.trace)).max())
    return VelocityGaps(holding_bandwidth(modelled.model.model, top), modelled.fitted.base.inertia)


def rejection(
    recordings: Recordings,
    held_out: HeldOut,
    extension: Extension,
    gaps: VelocityGaps,
    shown: Sequence[tuple[Extension, Recorded]],
    policy: Policy,
) -> tuple[int, Reason] | None:
    """Index of the last effect that held-out motion contradicts, with the reason; None if it contradicts none.

    The torque gaps come first, as they cost no simulation. Where they contradict none, what is shown in the end is
    simulated together with the judged model: side by side that costs hardly more.
    """
    judged, judge = replace(extension, recording=held_out.fitted), held_out.recorded
    floor = NULL * white_noise(measured_velocity(recordings.trace))
    asked: list[tuple[int, Extension]] = []
    by_torque: tuple[int, Reason] | None = None
    for index in reversed(range(len(judged.names))):
        if judged.a(Occasional, index) and (not judge.events or held_out.fitted is not recordings.rows):
            continue
        if not held_out.determines(judged.fitted, extension.fitted, index):
            continue
        less = judged.less(index)
        balances = (Balance.of(each.fitted).repeating(judge.events) for each in (less, judged))
        before, after = (balance.gap(held_out.judge) for balance in balances)
        if after > before:
            by_torque = index, grows("torque", before, after, judged.rig.effort_unit, judge.name)
            break
        asked.append((index, less))
    if not asked:
        return by_torque
    gaps.simulate([(judged, judge), *(() if by_torque else shown)])
    if not gaps.of(judged, judge) > floor:  # less than which never counts as worse
        return by_torque
    gaps.simulate((less, judge) for _, less in asked)
    for index, less in asked:
        in_phase = gaps.in_phase(judged, judge)
        in_phase = in_phase or (not judged.a(Placed, index) and gaps.in_phase(less, judge))
        before, after = (gaps.of(each, judge) for each in (less, judged))
        allowed = float(np.hypot(before, floor) * (1.0 if in_phase else np.sqrt(ERRS_TWICE)))
        worse = min(before, after) < judge.varies and after > allowed
        if worse and not _comes_closer(recordings, judged, held_out, gaps, allowed, policy):
            return index, grows("velocity", before, after, judged.rig.axis_kind.speed_unit, judge.name)
    return by_torque


def _comes_closer(
    recordings: Recordings, whole: Extension, held_out: HeldOut, gaps: VelocityGaps, allowed: float, policy: Policy
) -> bool:
    """Whether refinement by simulation brings the velocity gap of all effects below what is allowed."""
    if whole.model is None:
        return True
    numbers = Numbers(*named(recordings, whole.fitted, whole.outside, policy))
    found = refined_model(whole.model, numbers, held_out, gaps)
    return found is not None and found[2] <= allowed


def closed_loop_gap(recordings: Recordings, extension: Extension) -> tuple[float, float] | None:
    """Velocity gap under the drive of the rig, without and with the effect that is visible only there - rad/s (m/s).

    A prediction from the references of a recording, without tracking. Feedback hides most effects here - the drive
    makes good what the model lacks - but for what happens in the drive itself it is the only place to look: a voltage
    limit acts before the recorded current, with which the held model is fed.

    None where there is no such effect, the rig describes no drive, the recording has no references, or the simulation
    diverges.
    """
    index = under_drive(extension)
    if index is None or "velocity_reference" not in recordings.trace:
        return None
    without = extension.less(index)
    if without.model is None or extension.model is None:
        return None
    ((limit, shown),) = ((one, found) for one, found in extension.outside.items() if isinstance(one, DriveLimit))
    trace = limit.shown_in(recordings.trace, recordings.rig, shown.values)
    velocity = measured_velocity(trace)
    try:
        before, after = (
            rms(follow_references(stored.model, trace, recordings.rig).velocity - velocity)
            for stored in (without.model, extension.model)
        )
    except BenchError:
        return None
    return before, after


def under_drive(extension: Extension) -> int | None:
    """Index of the effect that is visible only under the drive of the rig; None without one."""
    own = len(extension.hypothesis.terms)
    shown = [own + k for k, effect in enumerate(extension.outside) if isinstance(effect, DriveLimit)]
    return shown[0] if shown else None


def unlimited(extension: Extension, closed_loop: tuple[float, float] | None) -> tuple[int, Reason] | None:
    """The effect visible only under the drive, if it does not reduce the velocity gap there; with the reason."""
    index = under_drive(extension)
    if closed_loop is None or closed_loop[1] < closed_loop[0] or index is None:
        return None
    return index, grows("velocity", *closed_loop)


def grows(gap: str, before: float, after: float, unit: str = "", recording: str = "") -> Reason:
    """That an effect increases a gap of a recording, or of a simulation under the rig's drive."""
    figures: dict[str, str | float] = {"gap": gap, "before": before, "after": after, "unit": unit}
    return Reason("grows", figures | ({"recording": recording} if recording else {}))


def refined(
    recordings: Recordings, stage: Extension, suspects: Suspects, held_out: HeldOut, gaps: VelocityGaps
) -> tuple[StoredModel | None, list[NamedEffect], dict[str, Parameter], tuple[float, float] | None]:
    """A model, its effects and parameters with their intervals, and the velocity gap before and after refinement.

    It is refined, if that helps, where effects were added, no unexplained remainder would bias the values, and the gap
    exceeds that of a complete model.
    """
    effects, parameters = named(recordings, stage.fitted, stage.outside, suspects.policy)
    plain = stage.model, effects, parameters, None
    if stage.model is None or not effects or suspects.policy.remains(stage.fitted):
        return plain
    before = gaps.of(stage, held_out.recorded)
    if not before > NULL * white_noise(measured_velocity(recordings.trace)):
        return plain
    numbers = Numbers(effects, parameters)
    found = refined_model(stage.model, numbers, held_out, gaps)
    if found is None or not found[2] < (1.0 - WON) * before:
        return plain
    model, values, after = found
    return model, *numbers.named(values), (before, after)


def refined_model(
    stored: StoredModel, numbers: Numbers, held_out: HeldOut, gaps: VelocityGaps
) -> tuple[StoredModel, Array, float] | None:
    """The model refined on the motion that is not held out; None if that fails.

    With its values (p,), and its velocity gap in the motion held out - rad/s (m/s).
    """
    try:
        values = stepped(stored, numbers, held_out.seen, gaps)
        if values is None:
            return None
        model = numbers.model(stored, values)
    except InputError:
        return None
    (velocity,) = gaps.velocities([model], held_out.recorded)
    return model, values, held_out.recorded.gap(velocity)


@dataclass(frozen=True)
class Numbers:
    """The free values of a model.

    Attributes:
        effects, parameters: as named, with intervals; of the parameters the first three.
    """

    effects: Sequence[NamedEffect]
    parameters: Mapping[str, Parameter]

    @cached_property
    def free(self) -> list[tuple[tuple[int, str], Parameter]]:
        """(Effect's index, quantity) of each, (-1, name) of J, K_w and K_0, with its interval."""
        free = [((-1, name), self.parameters[name]) for name in list(self.parameters)[:3]]
        for index, effect in enumerate(self.effects):
            fixed = {slot.quantity.name for slot in effect.effect.shapes if slot.whole or slot.quantity.instant}
            known = dict(present_of(effect.effect, effect.values).values)
            free += [((index, key), p) for key, p in effect.parameters.items() if key in known and key not in fixed]
        return [(place, p) for place, p in free if np.isfinite(p.std_error) and p.std_error > 0.0]

    @property
    def values(self) -> Array:
        """(p,)."""
        return np.array([p.value for _, p in self.free])

    def model(self, stored: StoredModel, values: Array) -> StoredModel:
        """The model with other values; InputError if they are not allowed."""
        moved = self.named(values)
        base = [max(p.value, 0.0) for p in list(moved[1].values())[:3]]
        if not base[0]:
            raise InputError(stored.name, "found no inertia", "allowed: above zero")
        parameters = replace(stored.model.parameters, **dict(zip(BASE, base, strict=True)))
        present = tuple(present_of(effect.effect, effect.values) for effect in moved[0])
        return replace(stored, model=replace(stored.model, parameters=parameters, effects=present))

    def named(self, values: Array) -> tuple[list[NamedEffect], dict[str, Parameter]]:
        """Effects and parameters with other values; their intervals stay as wide, as the noise is the same."""
        parameters = dict(self.parameters)
        effects = [dict(effect.parameters) for effect in self.effects]
        for ((index, key), _), value in zip(self.free, values.tolist(), strict=True):
            table = parameters if index < 0 else effects[index]
            table[key] = table[key].at(value, index >= 0 and key in self.effects[index].effect.positive)
        found = [replace(e, parameters=table) for e, table in zip(self.effects, effects, strict=True)]
        return found, parameters


def stepped(stored: StoredModel, numbers: Numbers, recorded: Recorded, gaps: VelocityGaps) -> Array | None:
    """Values (p,) with the least simulation error on a recording, from a regression's model; None if one fails.

    InputError where a step of a derivative is not allowed.
    """
    values, errors = numbers.values, np.array([p.std_error for _, p in numbers.free])
    models = [stored, *(numbers.model(stored, row) for row in values + np.diag(STEP * errors))]
    simulated = gaps.velocities(models, recorded)
    differences = [recorded.difference(velocity) for velocity in simulated if velocity is not None]
    if len(differences) < len(models):
        return None
    jacobian = np.stack([other - differences[0] for other in differences[1:]], axis=1) / STEP
    from scipy.optimize import lsq_linear  # 0.2 s, which only a named effect has to pay

    within = (np.array([p.ci95 for _, p in numbers.free]) - values[:, None]) / errors[:, None]
    found = lsq_linear(jacobian, -differences[0], bounds=(within[:, 0], within[:, 1]))
    return values + errors * found.x
