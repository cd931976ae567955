"""Diagnosis in five steps: fit, where, name, add, show."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, known_rms, rms
from bench.axis_kind import COULOMB, OFFSET, AxisKind
from bench.comparison.spread import Between
from bench.diagnosis.add import Added, add
from bench.diagnosis.name import NamedEffect, NamedEffects, Suspects, name
from bench.diagnosis.next_experiment import NextExperiment, propose
from bench.diagnosis.policy import POLICY, Policy, Reason
from bench.diagnosis.probability import Probabilities
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.same_axis import SameAxis, between_recordings
from bench.diagnosis.tabulated import UNKNOWN, UnknownEffect, remaining
from bench.diagnosis.verdict import Gap, verdict
from bench.diagnosis.where import Where, filtered_away, where
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.effects.present import named
from bench.errors import InputError
from bench.fit.dead_time import DeadTime, dead_time_of
from bench.fit.estimate import Alone
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import LINKS
from bench.fit.identify import require_diagnosable
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.gate.check import Check
from bench.gate.gate import joined, passed
from bench.gate.signals import clipped
from bench.names import meant, with_known_arguments
from bench.packed import unpack
from bench.parameter import Parameter
from bench.plant.model_file import StoredModel, model_xml
from bench.presented import ByKey, Presented
from bench.rig.given import Given, GivenRig, Units, recordings_of, trace_of
from bench.rig.rig import Rig
from bench.trace.motion import measured_velocity
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: File of a saved diagnosis that contains all of it.
PACKED = "diagnosis.npz"
#: Speed gap of a model that matches: in noise floors, and as share of the RMS speed, which filters and steps resolve.
MATCH, RESOLVED = 3.5, 1e-3


@dataclass(frozen=True)
class Step:
    """Gaps after one addition to the model.

    Attributes:
        effect: added last; empty for the bare axis, UNKNOWN for the tables of an unknown effect.
        torque: of the recording, and of the holdout where there is one - N*m (N).
        velocity: the same - rad/s (m/s); nan if not available.
    """

    effect: str
    torque: tuple[float, ...]
    velocity: tuple[float, ...]


@dataclass(frozen=True)
class TimeSeries:
    """One recording over time, with the residuals of the model after each step.

    Attributes:
        name: `recording` or `holdout`.
        origin: of it.
        time: s - (n,).
        velocity: as measured - rad/s (m/s) - (n,).
        velocity_residuals: measured less simulated, for each step (n,), nan outside the model; None without a model, or
            if it diverged.
        rows: index into the samples of each row of the torque balance (m,).
        torque: as measured, filtered - N*m (N) - (m,).
        torque_residuals: measured less modelled, for each step (m,).
    """

    name: str
    origin: str
    time: Array
    velocity: Array
    velocity_residuals: tuple[NDArray[np.float32] | None, ...]
    rows: NDArray[np.int64]
    torque: Array
    torque_residuals: tuple[Array, ...]


@dataclass(frozen=True)
class Considered:
    """An effect of the catalogue, and why it is in the model or is not.

    Attributes:
        effect: of the catalogue.
        accepted: whether it is in the model.
        probability: that the axis has it.
        of_gap: share of the squared gap that it explains as the only effect; None if it was not tried.
        of_residual: share of the squared residual that it explains in addition to the others; None if it was not tried.
        reason: for or against it.
    """

    effect: Effect
    accepted: bool
    probability: float
    of_gap: float | None
    of_residual: float | None
    reason: Reason


@dataclass(frozen=True, repr=False)
class Diagnosis(Presented):
    """What is missing from the model of an axis, and the model with it.

    It iterates over its effects. It gives an effect, or a parameter of the axis, by its name, which is an attribute,
    too.

    Attributes:
        verdict, effects, parameters: as the contract has them.
        objections: the criteria by which the model is incomplete; () unless something remains.
        probabilities: of sets of names, and that that the effect is unknown.
        where: shares of the gap before any effect; unexplained_share, unexplained_where: of the residual.
        torque, velocity: gaps before and after.
        steps: the bare axis, then the model after each addition, the tables of an unknown effect last.
        holdout: whether it is of the same axis, and in what it differs.
        next_experiment: that distinguishes what this recording does not.
        rejected: names that held-out motion contradicts, or whose size is not determined, each with the reason.
        refused: why a parameter is not determined with the effects, by its name; the model is the last that has all.
        stopped: what ended the search before it was done; None if nothing did.
        unknown_effect: what remains, as tables of the model; None where held-out motion confirms none.
        model, balance: with all effects; no model where MuJoCo cannot have them. Only the model has the tables.
        time_series: the recordings, with the residuals of the model after each step.
        considered: every effect of the catalogue, and why it was accepted or not.
        recordings, between: J, K_w and K_0 of each of several recordings alone, and their spread; () and {} of one.
        warnings: what a user should know.
        checks: what the gate found before the fit.
        dead_time: by how much torque is later than motion, if that is more than a sample; None if it is not.
    """

    verdict: str
    objections: tuple[Reason, ...]
    effects: NamedEffects
    probabilities: Probabilities
    where: list[Where]
    unexplained_share: float
    unexplained_where: list[Where]
    parameters: dict[str, Parameter]
    torque: Gap
    velocity: Gap
    steps: list[Step]
    rejected: tuple[tuple[str, Reason], ...]
    refused: Mapping[str, str]
    holdout: SameAxis
    next_experiment: NextExperiment | None
    stopped: str | None
    unknown_effect: UnknownEffect | None
    model: StoredModel | None
    balance: Balance
    time_series: tuple[TimeSeries, ...]
    considered: tuple[Considered, ...]
    recordings: tuple[Alone, ...] = ()
    between: Mapping[str, Between] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    checks: tuple[Check, ...] = ()
    dead_time: DeadTime | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "effects", NamedEffects(self.effects))

    def __iter__(self) -> Iterator[NamedEffect]:
        return iter(self.effects)

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __len__(self) -> int:
        return len(self.effects)

    def __bool__(self) -> bool:
        return True  # without an effect it is a result, too

    def __getitem__(self, name: str) -> Any:  # noqa: ANN401 - an effect, or a parameter of the axis
        return meant(name, {**self.parameters, **{effect.name: effect for effect in self.effects}})

    @property
    def names(self) -> list[str]:
        """Of its effects."""
        return [effect.name for effect in self.effects]

    @property
    def gap(self) -> dict[str, Gap]:
        """Gaps of torque and of velocity, as the contract's JSON has them."""
        return ByKey(torque=self.torque, velocity=self.velocity)

    @property
    def residuals(self) -> Array:
        """Measured less modelled torque of the recording, with all that was found - N*m (N) - (m,)."""
        return self.time_series[0].torque_residuals[-1]

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


@with_known_arguments
def diagnose(
    trace: Given | Sequence[Given],
    rig: GivenRig | None = None,
    holdout: Given | None = None,
    excluded: Collection[str] = (),
    progress: Callable[[float], None] | None = None,
    policy: Policy | None = None,
    units: Units | None = None,
    effects: Collection[str] | None = None,
) -> Diagnosis:
    """Find what is missing, name it, add it, and show the gap shrink.

    Args:
        trace: the recording, or its file, arrays by their names or a data frame; or a list of several of one axis,
            which are joined (`bench.trace.trace.join`).
        rig: of the axis, as `identify` takes it.
        holdout: another recording of it, not used to fit.
        excluded: names of effects that are not tried, or of one.
        progress: called with the share done.
        policy: numbers that decide on names, instead of POLICY.
        units: of columns by their names, which replace those of the file or data frame.
        effects: names of the only effects that are tried, or of one; all of the catalogue by default.

    Raises:
        UndeterminedError: the recording is too short, too slow or too quiet to decide.
        InputError: rig and recording do not fit together, or a check of a recording fails.
    """
    policy, report = policy or POLICY, progress or (lambda share: None)
    rig, traces = recordings_of(trace, rig, units)
    left_out = _named(excluded, "excluded")
    if effects is not None:
        left_out |= catalogue().keys() - _named(effects, "effects")
    gated = [passed(each, rig) for each in traces]
    unseen = passed(trace_of(holdout, rig, units), rig).trace if holdout is not None else None
    for each in gated:
        require_diagnosable(each.trace, rig)
    recordings = Recordings.of([each.trace for each in gated], rig, unseen, policy)
    recordings, bare, suspects = decided(recordings, left_out, policy)
    recordings, moves = recordings.steady(suspects.fitted, policy)
    if recordings.rows is not bare.rows:
        bare = fit_bare(recordings.rows)
        suspects = replace(suspects, fitted=fit(recordings.rows, suspects.fitted.hypothesis, suspects.fitted))
    report(0.6)
    added = add(recordings, suspects)
    report(0.9)
    shown, checks = show(bare, added), joined([each.checks for each in gated])
    return replace(shown, checks=checks, warnings=[*shown.warnings, *recordings.warnings, *moves])


def _named(names: Collection[str], argument: str) -> frozenset[str]:
    """Names of effects of the catalogue, of one or of several; InputError for another one."""
    return frozenset(named(one, argument).name for one in ([names] if isinstance(names, str) else names))


def decided(recordings: Recordings, excluded: frozenset[str], policy: Policy) -> tuple[Recordings, Fit, Suspects]:
    """Names at the highest cut-off at which they are decided, with the fit without them.

    Noise of the acceleration grows with the cut-off, and may hide an effect that a lower one shows. A lower one at
    which no more than noise remains is not searched where no effect was likely above it. If none shows an effect, the
    highest counts: low ones have too few rows to know the colour of the noise.
    """
    tried = list[tuple[Recordings, Fit, Suspects]]()
    for each in chain([recordings], recordings.lower()):
        bare = fit_bare(each.rows)
        if not tried or tried[-1][2].probabilities.nothing <= 0.5 or policy.remains(bare):
            tried.append((each, bare, name(each, bare, excluded, policy)))
            if tried[-1][2].probabilities.chosen:
                return tried[-1]
        if not policy.noise_hides(bare):
            break
    return tried[0]


def show(bare: Fit, added: Added) -> Diagnosis:
    """The diagnosis of what was named and kept."""
    recordings, whole = added.recordings, added.extension.fitted
    unit, kind, current = recordings.unit, recordings.rig.axis_kind, recordings.current
    parameters, alone, spread, differing = between_recordings(recordings, whole, added.parameters)
    series = time_series(added)
    steps = gaps_of_steps(added, series)
    torque, velocity = gaps(added, steps)
    residuals = [whole.left, *series[0].torque_residuals[len(added.stages) :]]
    likely = added.suspects.probabilities.without(frozenset(name for name, _ in added.rejected))
    late = dead_time_of(whole)
    comes_to, objections = verdict(added, likely, torque, velocity)
    return Diagnosis(
        verdict=comes_to,
        objections=objections,
        effects=NamedEffects(added.effects),
        probabilities=likely,
        where=where(bare, kind, unit, current, residuals, filtered_away(whole)),
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
        stopped=added.suspects.stopped,
        unknown_effect=added.unknown,
        model=added.tabulated and replace(added.tabulated, effort_unit="" if unit == kind.effort_unit else unit),
        balance=Balance.of(whole).repeating(added.repeats),
        time_series=series,
        considered=considered(added, likely),
        dead_time=late,
        warnings=[
            *suspicions(recordings.trace, recordings.rig, added.parameters),
            *delayed(late, whole),
            *off_their_encoder(whole),
            *left_open(recordings.rows, kind),
            *impacts(whole, unit),
            *out_of_phase(added),
            *differing,
            *added.compared.warnings,
            *([f"not added to the MuJoCo model: {problem}"] if (problem := added.stages[-1].problem) else []),
        ],
    )


def time_series(added: Added) -> tuple[TimeSeries, ...]:
    """The recording, and the holdout where there is one, with the residuals after each step."""
    laid_out = [rows for rows in (added.recordings.rows, added.recordings.holdout_rows) if rows is not None]
    balances = [Balance.of(stage.fitted).repeating(added.repeats) for stage in added.stages]
    models = [stage.model for stage in added.stages]
    if added.refined is not None:
        models[-1] = added.model
    tables = [] if added.unknown is None else [added.unknown.tables]
    models += [added.tabulated for _ in tables]
    found = []
    for rows, recorded in zip(laid_out, added.recorded, strict=True):
        trace = recorded.trace
        velocity = tuple(added.gaps.residual(model, recorded) for model in models)
        torque = [
            *(balance.left(rows) for balance in balances),
            *(remaining(balances[-1], rows, one) for one in tables),
        ]
        along = recorded.name, trace.origin, trace.time, measured_velocity(trace)
        found.append(TimeSeries(*along, velocity, rows.samples(), rows.effort, tuple(torque)))
    return tuple(found)


def gaps_of_steps(added: Added, series: Sequence[TimeSeries]) -> list[Step]:
    """Gaps of the bare axis and after each step, that of the last effect as it was kept."""
    names = [stage.names[-1] if stage.names else "" for stage in added.stages]
    return [
        Step(
            effect,
            tuple(rms(one.torque_residuals[k]) for one in series),
            tuple(math.nan if (left := one.velocity_residuals[k]) is None else known_rms(left) for one in series),
        )
        for k, effect in enumerate([*names, UNKNOWN] if added.unknown else names)
    ]


def gaps(added: Added, steps: Sequence[Step]) -> tuple[Gap, Gap]:
    """Torque and velocity gap of all effects together.

    Of the torque over all rows, and the residual of those that judge the fit, where not all do. Of the velocity None
    where MuJoCo cannot have the model or a simulation diverged.
    """
    whole, recordings, last = added.extension.fitted, added.recordings, steps[len(added.stages) - 1]
    torque = zip(steps[0].torque, last.torque, strict=True)
    velocity = zip(steps[0].velocity, last.velocity, strict=True)
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
    suspects, found = added.suspects, dict[Effect, Considered]()
    kept = {one.effect: one for one in added.effects}
    alike = {name: one for one in kept.values() for name in one.ambiguous_with}
    for effect in catalogue().values():
        accepted, same = effect in kept, kept.get(effect) or alike.get(effect.name)
        likely = probabilities.names.get(effect.name, 0.0)
        if same is not None:
            likely = probabilities.of_any((same.name, *same.ambiguous_with))
        if accepted:
            reason = Reason("accepted", kept[effect].evidence)
        else:
            reason = Reason("alike", {"effect": same.name}) if same is not None else against(effect, added)
        every = suspects.of_gap.get(effect), None if accepted else suspects.of_residual.get(effect)
        gap, left = (None if one is None else min(one, 1.0) for one in every)  # rescaled torque has no bound
        found[effect] = Considered(effect, accepted, likely, gap, left, reason)
    first = [found.pop(effect) for effect in kept]
    return (*first, *sorted(found.values(), key=lambda one: -(one.of_gap or 0.0)))


def against(effect: Effect, added: Added) -> Reason:
    """Why an effect is not in the model: the first of these criteria that applies."""
    suspects, rejected = added.suspects, dict(added.rejected)
    if effect.name not in suspects.excluded and effect.name in rejected:
        return rejected[effect.name]
    criteria = {
        "excluded": effect.name in suspects.excluded,
        suspects.against.get(effect, ""): effect in suspects.against,
        "invisible": not effect.sought(added.recordings.rows.scope),
        "same_as_added": not suspects.fitted.hypothesis.admits(effect),
    }
    return Reason(next((criterion for criterion, holds in criteria.items() if holds), "no_sign"))


def suspicions(trace: Trace, rig: Rig, parameters: Mapping[str, Parameter]) -> list[str]:
    """Warnings: less inertia than the rotor alone has, or a signal that stays at the end of its range."""
    inertia, rotor = parameters.get("moment_of_inertia"), rig.motor.rotor_inertia
    if inertia is None or rotor is None or inertia.unit != "kg*m**2" or inertia.ci95[1] >= rotor:
        return clipped(trace, rig)
    return [
        f"the moment of inertia, {inertia.value:.3g} kg*m**2, is less than the rotor's, {rotor:.3g} kg*m**2: "
        "check the units of current and speed and the torque constant",
        *clipped(trace, rig),
    ]


def delayed(late: DeadTime | None, fitted: Fit) -> Iterator[str]:
    """That torque and motion differ by more than a sample, unless the model has it as the lag that it is."""
    if late is not None and fitted.hypothesis.shift:
        yield f"{late}; the model contains it"
    elif late is not None and late.kind != "first_order_lag":
        yield f"the model contains a lag, but {late}"


def off_their_encoder(fitted: Fit) -> Iterator[str]:
    """That links of a robot are elsewhere than their encoder, which a small constant torque looks like."""
    if fitted.hypothesis.misplaced:
        angle = f"{fitted.value(LINKS):.3g} {fitted.scope.kind.length_unit}"
        yield (
            f"links that are {angle} ahead of their encoder explain a part of the torque: its zero or that of a joint "
            "before it, or a loose gear on one flank. An effect as small as their weight makes then is not sought"
        )


def left_open(rows: Rows, kind: AxisKind) -> list[str]:
    """A warning of what motion in one direction does not determine."""
    if not rows.scope.one_way:
        return []
    offset, friction = kind.parameter(OFFSET), kind.parameter(COULOMB)
    forward = float(np.mean(rows.values(lambda s: s.sign))) > 0.0
    return [
        f"the axis moves {'forward' if forward else 'backward'} only: {friction} contains any "
        f"{offset} too, and no effect on friction was sought; record both directions for that"
    ]


def impacts(fitted: Fit, unit: str) -> list[str]:
    """A warning if rows that depend on the instants of impacts were excluded from the verdict."""
    share = 1.0 - float(fitted.determined.mean())
    if share == 0.0:
        return []
    return [
        f"{100.0 * share:.0f} % of the rows follow impacts so closely that their torque depends on instants which "
        f"the recording does not determine. The verdict uses the other rows, whose residual is {fitted.rms:.3g} "
        f"{unit}; the torque gap covers all"
    ]


def out_of_phase(added: Added) -> list[str]:
    """A warning of recordings along which simulated waves, or impacts, lose the phase of the measured motion."""
    lost = [each.name for each in added.recorded if not added.gaps.in_phase(added.extension, each)]
    return [
        f"the simulated position differs from the {name}'s by more than waves or impacts allow: they are judged by "
        "their torque at the measured position, and by the velocity gap where its squares double"
        for name in lost
    ]
