"""Diagnosis in five steps: fit, where, name, add, show."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, known_rms, rms
from bench.axis_kind import COULOMB, OFFSET, AxisKind
from bench.comparison.spread import Between
from bench.diagnosis.add import Added, add
from bench.diagnosis.name import NamedEffect, Suspects, name
from bench.diagnosis.next_experiment import NextExperiment, propose
from bench.diagnosis.policy import POLICY, Policy
from bench.diagnosis.probability import Probabilities
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.same_axis import SameAxis, apart
from bench.diagnosis.search import Round
from bench.diagnosis.tabulated import UnknownEffect, with_tables
from bench.diagnosis.verdict import Gap, Objection, verdict
from bench.diagnosis.where import Where, where
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.effects.present import named
from bench.errors import InputError
from bench.fit.estimate import Alone
from bench.fit.fit import Fit
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.gate.check import Check
from bench.gate.gate import joined, passed
from bench.gate.signals import clipped
from bench.names import nearest, words
from bench.packed import unpack
from bench.parameter import Parameter
from bench.plant.model_file import StoredModel, model_xml
from bench.presented import Presented
from bench.rig.given import Given, GivenRig, Units, recordings_of, trace_of
from bench.rig.rig import Rig
from bench.trace.motion import measured_velocity
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: File of a saved diagnosis that holds all of it.
PACKED = "diagnosis.npz"
#: Speed gap of a model that matches: in noise floors, and as share of the RMS speed, which filters and the steps of the
#: integration resolve.
MATCH, RESOLVED = 3.5, 1e-3


@dataclass(frozen=True)
class Shrunk:
    """Gaps after one addition to the model.

    Attributes:
        effect: added last; empty for the bare axis.
        torque: of the recording, and of the holdout where there is one - N*m (N).
        velocity: the same - rad/s (m/s); nan if not available.
    """

    effect: str
    torque: tuple[float, ...]
    velocity: tuple[float, ...]


@dataclass(frozen=True)
class Course:
    """One recording over time, with the residuals of the model after each addition.

    Attributes:
        name: `recording` or `holdout`.
        origin: of it.
        time: s - (n,).
        velocity: as measured - rad/s (m/s) - (n,).
        velocity_left: measured less simulated, for each step (n,), nan outside the model; None without a model, or
            if it diverged.
        rows: index into the samples of each row of the torque balance (m,).
        torque: as measured, filtered - N*m (N) - (m,).
        torque_left: measured less modelled, for each step (m,).
    """

    name: str
    origin: str
    time: Array
    velocity: Array
    velocity_left: tuple[NDArray[np.float32] | None, ...]
    rows: NDArray[np.int64]
    torque: Array
    torque_left: tuple[Array, ...]


@dataclass(frozen=True)
class Considered:
    """An effect of the catalogue, and why it was accepted or not.

    Attributes:
        effect: of the catalogue.
        taken: whether it is in the model.
        probability: that the axis has it.
        alone: share of the squared gap that it explains alone; None if it was not tried.
        beside: share of the squared residual that it explains in addition to the others; None if it was not tried.
        reason: for or against it.
    """

    effect: Effect
    taken: bool
    probability: float
    alone: float | None
    beside: float | None
    reason: str


@dataclass(frozen=True, repr=False)
class Diagnosis(Presented):
    """What is missing from the model of an axis, and the model with it; goes through its effects, or gives one by name.

    Attributes:
        verdict, effects, parameters: as the contract has them.
        objections: what speaks against its being all; () unless something remains.
        probabilities: of sets of names, and that none of the catalogue's is right.
        where: shares of the gap before any effect; unexplained_share, unexplained_where: of the residual.
        torque, velocity: gaps before and after.
        steps: the bare axis, then the model after each addition.
        holdout: whether it is of the same axis, and in what it differs.
        next_experiment: that tells apart what this recording does not.
        rejected: names that held-out motion contradicts, or whose size is not determined, each with the reason.
        refused: why a parameter is not determined beside the effects, by its name; the model is the last that has all.
        stopped: what ended the search before it was done; None if nothing did.
        unknown_effect: what remains, as tables of the model; None where held-out motion confirms none.
        model, balance: with all effects; no model where MuJoCo cannot have them. Only the model has the tables.
        courses: the recordings over time beside the model as it grew.
        considered: every effect of the catalogue, and why it was taken or not.
        recordings, between: J, K_w and K_0 of each of several recordings alone, and their spread; () and {} of one.
        warnings: what a user should know.
        checks: what the gate found before the fit.
    """

    verdict: str
    objections: tuple[Objection, ...]
    effects: list[NamedEffect]
    probabilities: Probabilities
    where: list[Where]
    unexplained_share: float
    unexplained_where: list[Where]
    parameters: dict[str, Parameter]
    torque: Gap
    velocity: Gap
    steps: list[Shrunk]
    rejected: tuple[tuple[str, str], ...]
    refused: Mapping[str, str]
    holdout: SameAxis
    next_experiment: NextExperiment | None
    stopped: str | None
    unknown_effect: UnknownEffect | None
    model: StoredModel | None
    balance: Balance
    courses: tuple[Course, ...]
    considered: tuple[Considered, ...]
    recordings: tuple[Alone, ...] = ()
    between: Mapping[str, Between] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    checks: tuple[Check, ...] = ()

    def __iter__(self) -> Iterator[NamedEffect]:
        return iter(self.effects)

    def __contains__(self, name: object) -> bool:
        return name in {effect.name for effect in self}

    def __getitem__(self, name: str) -> NamedEffect:
        found = {effect.name: effect for effect in self}
        if name not in found:
            raise KeyError(f"{name}: found none{nearest(name, [*found])}; allowed: {', '.join(found) or 'none'}")
        return found[name]

    @classmethod
    def load(cls, folder: str | Path) -> Diagnosis:
        """The diagnosis of a folder that `save` or `bench diagnose --out` wrote, with all that it draws.

        Raises:
            InputError: no such folder, or one of another version of the bench.
        """
        path = Path(folder)
        return unpack((path.parent if path.is_file() else path) / PACKED, cls)

    @property
    def mjspec(self) -> mujoco.MjSpec:
        """The model as MuJoCo has it natively, to edit, attach or compile; InputError where MuJoCo cannot have it."""
        if self.model is None:
            raise InputError("mjspec", "MuJoCo cannot have this model", "its torque balance is in model.toml")
        return mujoco.MjSpec.from_string(model_xml(self.model))


def diagnose(
    trace: Given | Sequence[Given],
    rig: GivenRig | None = None,
    holdout: Given | None = None,
    excluded: Collection[str] = (),
    progress: Callable[[float], None] = lambda share: None,
    policy: Policy = POLICY,
    units: Units | None = None,
) -> Diagnosis:
    """Find what is missing, name it, add it, and show the gap shrink.

    Args:
        trace: the recording, or its file, arrays by their names or a data frame; or a list of several of one axis,
            which are joined (`bench.trace.trace.join`).
        rig: of the axis, as `identify` takes it.
        holdout: another recording of it, not used to fit.
        excluded: names of effects that are not tried, or of one.
        progress: called with the share done.
        policy: numbers that decide on names.
        units: of columns by their names, which replace those of the file or data frame.

    Raises:
        UndeterminedError: the recording is too short, too slow or too quiet to decide.
        InputError: rig and recording do not fit together, or a check of a recording fails.
    """
    rig, traces = recordings_of(trace, rig, units)
    left_out = frozenset(named(one, "excluded").name for one in ([excluded] if isinstance(excluded, str) else excluded))
    gated = [passed(each, rig) for each in traces]
    unseen = passed(trace_of(holdout, rig, units), rig).trace if holdout is not None else None
    recordings = Recordings.of([each.trace for each in gated], rig, unseen, policy)
    recordings, bare, suspects = decided(recordings, left_out, policy)
    recordings, moves = recordings.steady(suspects.searched.last)
    if recordings.rows is not bare.rows:
        bare = fit_bare(recordings.rows)
        suspects = replace(suspects, searched=suspects.searched.through(recordings.rows))
    progress(0.6)
    added = add(recordings, suspects)
    progress(0.9)
    shown, checks = show(bare, added), joined([each.checks for each in gated])
    return replace(shown, checks=checks, warnings=[*shown.warnings, *recordings.warnings, *moves])


def decided(recordings: Recordings, excluded: frozenset[str], policy: Policy) -> tuple[Recordings, Fit, Suspects]:
    """Names at the highest cut-off at which they are decided, with the fit without them.

    Noise of the acceleration grows with the cut-off, and may hide an effect that a lower one shows. If none shows one,
    the highest counts.
    """
    tried = []
    for each in chain([recordings], recordings.lower()):
        bare = fit_bare(each.rows)
        suspects = name(each, bare, excluded, policy)
        tried.append((each, bare, suspects))
        if suspects.probabilities.chosen.names:
            return tried[-1]
        if suspects.probabilities.nothing > 0.5 or not policy.noise_hides(bare):
            break
    return tried[0]


def show(bare: Fit, added: Added) -> Diagnosis:
    """The diagnosis of what was named and kept."""
    recordings, whole = added.recordings, added.extension.fitted
    unit, kind, current = recordings.unit, recordings.rig.axis_kind, recordings.current
    parameters, alone, spread, differing = apart(recordings, whole, added.parameters)
    shown = courses(added)
    steps = shrinking(added, shown)
    torque, velocity = gaps(added, steps)
    likely = added.suspects.probabilities.without(frozenset(name for name, _ in added.rejected))
    comes_to, objections = verdict(added, likely, torque, velocity)
    return Diagnosis(
        verdict=comes_to,
        objections=objections,
        effects=added.effects,
        probabilities=likely,
        where=where(bare, kind, unit, current, whole),
        unexplained_share=whole.excess / max(bare.squares, 1e-300),
        unexplained_where=where(whole, kind, unit, current)[:3] if objections else [],
        parameters=parameters,
        recordings=alone,
        between=spread,
        torque=torque,
        velocity=velocity,
        steps=steps,
        rejected=added.rejected,
        refused=added.refused,
        holdout=added.compared,
        next_experiment=propose(added),
        stopped=added.suspects.searched.stopped,
        unknown_effect=added.unknown,
        model=added.model and with_tables(added.model, added.unknown.tables if added.unknown else ()),
        balance=Balance.of(whole).repeating(added.repeats),
        courses=shown,
        considered=considered(added, likely),
        warnings=[
            *suspicions(recordings.trace, recordings.rig, added.parameters),
            *delayed(whole),
            *left_open(recordings.rows, kind),
            *impacts(whole, unit),
            *out_of_phase(added),
            *differing,
            *added.compared.warnings,
            *([f"not added to the MuJoCo model: {problem}"] if (problem := added.stages[-1].problem) else []),
        ],
    )


def courses(added: Added) -> tuple[Course, ...]:
    """The recording, and the holdout where there is one, beside the bare axis and the model after each addition."""
    laid_out = [rows for rows in (added.recordings.rows, added.recordings.holdout_rows) if rows is not None]
    balances = [Balance.of(stage.fitted).repeating(added.repeats) for stage in added.stages]
    found = []
    for rows, recorded in zip(laid_out, added.recorded, strict=True):
        trace = recorded.trace
        models = [stage.model for stage in added.stages]
        if added.refined is not None:
            models[-1] = added.model
        left = [added.gaps.residual(model, recorded) for model in models]
        along = recorded.name, trace.origin, trace.time, measured_velocity(trace), tuple(left), rows.samples()
        found.append(Course(*along, rows.effort, tuple(balance.left(rows) for balance in balances)))
    return tuple(found)


def shrinking(added: Added, shown: Sequence[Course]) -> list[Shrunk]:
    """Gaps of the bare axis and after each addition, the last one as it was kept."""
    return [
        Shrunk(
            stage.names[-1] if stage.names else "",
            tuple(rms(course.torque_left[k]) for course in shown),
            tuple(math.nan if (left := course.velocity_left[k]) is None else known_rms(left) for course in shown),
        )
        for k, stage in enumerate(added.stages)
    ]


def gaps(added: Added, steps: Sequence[Shrunk]) -> tuple[Gap, Gap]:
    """Torque and velocity gap of all effects together.

    Of the torque over all rows; beside it what is left on those that judge the fit, where not all do. Of the velocity
    None where MuJoCo cannot have the model or a simulation diverged.
    """
    whole, recordings = added.extension.fitted, added.recordings
    torque = zip(steps[0].torque, steps[-1].torque, strict=True)
    velocity = zip(steps[0].velocity, steps[-1].velocity, strict=True)
    simulated = [pair if all(map(math.isfinite, pair)) else None for pair in velocity]
    judged = None if whole.determined.all() else (float(whole.determined.mean()), whole.rms)
    velocity = measured_velocity(recordings.trace)
    floor = math.hypot(white_noise(velocity), shaken(whole, added.gaps.bandwidth))
    limit = max(MATCH * floor, RESOLVED * rms(velocity))
    remainder = added.suspects.policy.remainder * whole.floor
    return (
        Gap(recordings.unit, whole.floor, *torque, judged=judged, limit=remainder),
        Gap(
            recordings.rig.axis_kind.speed_unit,
            floor,
            *simulated,
            limit=limit,
            bandwidth=added.gaps.bandwidth,
            closed_loop=added.closed_loop,
            refined=added.refined,
        ),
    )


def shaken(fitted: Fit, bandwidth: float) -> float:
    """RMS speed of a model that is held at a bandwidth w - rad/s -, as noise of the recorded torque shakes it.

    White noise of a deviation s at a period T through the held axis (`bench.plant.tracking.holding_cascade`),

        s**2/J**2*0.55*T/w

    the integral of |1/(J*i*omega + K_v + ...)|**2 (G. C. Newton, L. A. Gould, J. F. Kaiser, Analytical Design of Linear
    Feedback Controls, 1957, appendix E).
    """
    noise, period = fitted.rows.conditioning.effort_noise, fitted.scope.sample_period
    return noise / abs(fitted.base.inertia) * math.sqrt(0.55 * period / bandwidth)


def considered(added: Added, probabilities: Probabilities) -> tuple[Considered, ...]:
    """All effects: those accepted in the order of addition, then the others by the share they explain."""
    rounds = [each for each in added.suspects.searched.rounds if each.candidates]
    kept = {one.effect: one for one in added.effects}
    alike = {name: one for one in kept.values() for name in one.ambiguous_with}
    found: dict[Effect, Considered] = {}
    for effect in catalogue().values():
        shares = [share for tried in rounds if (share := _share(tried, effect)) is not None]
        likely, same = probabilities.names.get(effect.name, 0.0), kept.get(effect) or alike.get(effect.name)
        if effect in kept:
            figures = (f"{key.replace('_', ' ')} {value:.3g}" for key, value in kept[effect].evidence.items())
            reason = ", ".join(figures) or "named"
        elif same is not None:
            reason = f"this recording does not distinguish it from {words(same.name)}"
        else:
            reason = _against(effect, added, rounds)
        if same is not None:
            likely = probabilities.of_any((same.name, *same.ambiguous_with))
        last = _share(rounds[-1], effect) if len(rounds) > 1 and effect not in kept else None
        found[effect] = Considered(effect, effect in kept, likely, shares[0] if shares else None, last, reason)
    taken = [found.pop(effect) for effect in kept]
    return (*taken, *sorted(found.values(), key=lambda one: -(one.alone or 0.0)))


def _share(tried: Round, effect: Effect) -> float | None:
    """Share of the squared residual that an effect explains beside a fit; None if it was not tried."""
    return max((each.share for each in tried.candidates if each.term.effect is effect), default=None)


def _against(effect: Effect, added: Added, rounds: Sequence[Round]) -> str:
    """Why an effect is not in the model: the first of these reasons that holds."""
    suspects = added.suspects
    rejected = dict(added.rejected)
    share = _share(rounds[-1], effect) if rounds else None
    reasons = {
        "excluded": effect.name in suspects.excluded,
        rejected.get(effect.name, ""): effect.name in rejected,
        "added and removed again: the others explain it too, or another set is more likely": any(
            effect is term.effect for tried in rounds for term in tried.fitted.terms
        ),
        "this recording cannot show it": not effect.sought(added.recordings.rows.scope),
        "no more than chance": share is not None
        and share * rounds[-1].fitted.squares < suspects.policy.by_chance(rounds[-1].fitted, 1),
        suspects.searched.refused.get(effect.name, "others explain more"): share is not None,
        "the recording does not distinguish it from an added effect": not suspects.searched.last.hypothesis.admits(
            effect
        ),
    }
    return next((reason for reason, holds in reasons.items() if holds), "nothing in the recording points to it")


def suspicions(trace: Trace, rig: Rig, parameters: Mapping[str, Parameter]) -> list[str]:
    """Warnings: less inertia than the rotor alone has, or a signal that stands at the end of its range."""
    inertia, rotor = parameters.get("moment_of_inertia"), rig.motor.rotor_inertia
    if inertia is None or rotor is None or inertia.unit != "kg*m**2" or inertia.ci95[1] >= rotor:
        return clipped(trace, rig)
    return [
        f"the moment of inertia, {inertia.value:.3g} kg*m**2, is less than the rotor's alone, {rotor:.3g} kg*m**2: "
        "check the units of current and speed and the torque constant",
        *clipped(trace, rig),
    ]


def delayed(fitted: Fit) -> Iterator[str]:
    """That torque and speed are further apart than they were taken."""
    shift = fitted.shift
    if fitted.hypothesis.shift:
        way = "after" if shift < 0.0 else "before"
        yield (
            f"the torque acts {abs(shift) * 1e3:.3g} ms {way} it is reported, which is more than a sample "
            f"({fitted.scope.sample_period * 1e3:.3g} ms): a delay of the drive or of its log; the model contains it"
        )


def left_open(rows: Rows, kind: AxisKind) -> list[str]:
    """A warning of what motion in one direction does not determine."""
    if not rows.scope.one_way:
        return []
    offset, friction = kind.parameter(OFFSET), kind.parameter(COULOMB)
    forward = float(np.mean(rows.values(lambda s: s.sign))) > 0.0
    return [
        f"the axis moves {'forward' if forward else 'backward'} only: {friction} holds any "
        f"{offset} too, and no effect on friction was sought; record both directions for that"
    ]


def impacts(fitted: Fit, unit: str) -> list[str]:
    """A warning if rows that depend on the instants of impacts were excluded from the verdict."""
    share = 1.0 - float(fitted.determined.mean())
    if share == 0.0:
        return []
    return [
        f"{100.0 * share:.0f} % of the rows follow impacts so closely that their torque hangs on instants which the "
        f"recording does not tell: the verdict is by the others, on which {fitted.rms:.3g} {unit} are left; the torque "
        "gap counts all"
    ]


def out_of_phase(added: Added) -> list[str]:
    """A warning of recordings along which simulated waves, or impacts, lose the phase of the measured motion."""
    lost = [each.name for each in added.recorded if not added.gaps.in_phase(added.extension, each)]
    return [
        f"the simulated position leaves the {name}'s by more than waves or impacts allow: they are judged by their "
        "torque at the measured position, and by the velocity gap where its squares double"
        for name in lost
    ]
