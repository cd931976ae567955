"""Show what was found, with the gaps that every addition closed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, known_rms, rms
from bench.comparison.spread import Between
from bench.diagnosis.add import Added, Rejected
from bench.diagnosis.name import NamedEffect, Suspects
from bench.diagnosis.next_experiment import NextExperiment, propose
from bench.diagnosis.probability import Probabilities
from bench.diagnosis.recordings import Recordings
from bench.diagnosis.same_axis import SameAxis, apart
from bench.diagnosis.search import Searched, Step
from bench.diagnosis.verdict import Gap, Shown, impacts, left_open, out_of_phase, suspicions, verdict
from bench.diagnosis.where import Profile, Where, profiles, where
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.errors import InputError
from bench.fit.estimate import Alone
from bench.fit.fit import Fit
from bench.fit.stored import Balance
from bench.gate.check import Check
from bench.names import nearest
from bench.packed import unpack
from bench.parameter import Parameter
from bench.plant.model_file import StoredModel, model_xml
from bench.presented import Presented
from bench.trace.motion import measured_velocity
from bench.trace.noise import white_noise

#: File of a saved diagnosis that holds all of it.
PACKED = "diagnosis.npz"


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
        because: what speaks against its being all; empty unless something remains.
        probabilities: of sets of names, and that none of the catalogue's is right.
        where: shares of the gap before any effect; unexplained_share, unexplained_where: of what is left.
        torque, velocity: gaps before and after.
        bandwidth: of the cascade that held the models to the recordings - rad/s.
        closed_loop: velocity gap under the rig's drive without and with what shows only there - rad/s (m/s).
        refined: velocity gap of held-out motion before and after values were refined by simulation; None if not kept.
        steps: the bare axis, then the model after each addition.
        holdout: whether it is of the same axis, and in what it differs.
        next_experiment: that tells apart what this recording does not.
        rejected: names that held-out motion spoke against.
        refused: why a parameter is not determined beside the effects, by its name; the model is the last that has all.
        stopped: what ended the search before it was done; None if nothing did.
        model, balance: with all effects; no model where MuJoCo cannot have them.
        courses: the recordings over time beside the model as it grew.
        profiles: the gap over each coordinate before and after, what accounts for most first.
        considered: every effect of the catalogue, and why it was taken or not.
        recordings, between: J, K_w and K_0 of each of several recordings alone, and their spread; () and {} of one.
        warnings: what a user should know.
        checks: what the gate found before the fit.
    """

    verdict: str
    because: list[str]
    effects: list[NamedEffect]
    probabilities: Probabilities
    where: list[Where]
    unexplained_share: float
    unexplained_where: list[Where]
    parameters: dict[str, Parameter]
    torque: Gap
    velocity: Gap
    bandwidth: float
    closed_loop: tuple[float, float] | None
    refined: tuple[float, float] | None
    steps: list[Shrunk]
    rejected: tuple[Rejected, ...]
    refused: Mapping[str, str]
    holdout: SameAxis
    next_experiment: NextExperiment | None
    stopped: str | None
    model: StoredModel | None
    balance: Balance
    courses: tuple[Course, ...]
    profiles: tuple[Profile, ...]
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
        """The diagnosis of a folder that `save` wrote, with all that it draws.

        Raises:
            InputError: no such folder, or one of another version of the bench.
        """
        return unpack(Path(folder) / PACKED, cls)

    @property
    def mjspec(self) -> mujoco.MjSpec:
        """The model as MuJoCo has it natively, to edit, attach or compile; InputError where MuJoCo cannot have it."""
        if self.model is None:
            raise InputError("mjspec", "MuJoCo cannot have this model", "its torque balance is in model.toml")
        return mujoco.MjSpec.from_string(model_xml(self.model))


def show(recordings: Recordings, bare: Fit, located: list[Where], suspects: Suspects, added: Added) -> Diagnosis:
    """The diagnosis of what was named and kept; `located`: where the gap of the bare fit sits."""
    rig, unit, kind = recordings.rig, recordings.unit, recordings.rig.axis_kind
    whole, kept, searched = added.extension.whole.fitted, added.refined, suspects.searched
    shown, several = courses(recordings, added), apart(recordings, whole, kept.parameters)
    steps, current = shrinking(added, shown), recordings.current
    torque, velocity = torque_gap(steps, whole, unit), velocity_gap(recordings, steps)
    likely = suspects.probabilities.without(frozenset(one.name for one in added.rejected))
    comes_to, because = verdict(Shown(recordings, suspects, added, torque, velocity))
    return Diagnosis(
        verdict=comes_to,
        because=because,
        effects=kept.effects,
        probabilities=likely,
        where=located,
        unexplained_share=whole.excess / max(bare.squares, 1e-300),
        unexplained_where=where(whole, kind, unit, current)[:3] if because else [],
        parameters=several.parameters,
        recordings=several.recordings,
        between=several.between,
        torque=torque,
        velocity=velocity,
        bandwidth=added.gaps.bandwidth,
        closed_loop=added.closed_loop,
        refined=kept.gap,
        steps=steps,
        rejected=added.rejected,
        refused=added.refused,
        holdout=added.compared,
        next_experiment=propose(recordings, suspects, added),
        stopped=searched.stopped,
        model=kept.model,
        balance=Balance.of(whole).repeating(added.repeats),
        courses=shown,
        profiles=profiles(bare, whole, located, kind, unit, current),
        considered=considered(recordings, suspects, added, likely),
        warnings=[
            *suspicions(recordings.trace, rig, kept.parameters),
            *left_open(recordings.rows, kind),
            *impacts(whole, unit),
            *out_of_phase(added),
            *several.warnings,
            *added.warnings,
        ],
    )


def courses(recordings: Recordings, added: Added) -> tuple[Course, ...]:
    """The recording, and the holdout where there is one, beside the bare axis and the model after each addition."""
    laid_out = [rows for rows in (recordings.rows, recordings.holdout_rows) if rows is not None]
    balances = [Balance.of(stage.fitted).repeating(added.repeats) for stage in added.stages]
    found = []
    for rows, recorded in zip(laid_out, added.recorded, strict=True):
        trace = recorded.trace
        models = [stage.model for stage in added.stages]
        if added.refined.gap is not None and added.refined.model is not None:
            models[-1] = added.refined.model
        left = [added.gaps.residual(model, recorded) for model in models]
        along = recorded.name, trace.origin, trace.time, measured_velocity(trace), tuple(left), rows.samples()
        found.append(Course(*along, rows.effort, tuple(balance.left(rows) for balance in balances)))
    return tuple(found)


def shrinking(added: Added, shown: Sequence[Course]) -> list[Shrunk]:
    """Gaps of the bare axis and after each addition, the last one as it was kept."""
    return [
        Shrunk(
            stage.effect,
            tuple(rms(course.torque_left[k]) for course in shown),
            tuple(math.nan if (left := course.velocity_left[k]) is None else known_rms(left) for course in shown),
        )
        for k, stage in enumerate(added.stages)
    ]


def torque_gap(steps: list[Shrunk], whole: Fit, unit: str) -> Gap:
    """Of all effects together, over all rows; beside it what is left on those that judge the fit, where not all do."""
    pairs = list(zip(steps[0].torque, steps[-1].torque, strict=True))
    judged = None if whole.determined.all() else (float(whole.determined.mean()), whole.rms)
    return Gap(unit, whole.floor, pairs[0], pairs[1] if len(pairs) > 1 else None, judged)


def velocity_gap(recordings: Recordings, steps: list[Shrunk]) -> Gap:
    """Of all effects together; None where MuJoCo cannot have the model or a simulation diverged."""
    both = zip(steps[0].velocity, steps[-1].velocity, strict=True)
    pairs = [pair if all(map(math.isfinite, pair)) else None for pair in both]
    floor = white_noise(measured_velocity(recordings.trace))
    return Gap(recordings.rig.axis_kind.speed_unit, floor, pairs[0], pairs[1] if len(pairs) > 1 else None)


def considered(
    recordings: Recordings, suspects: Suspects, added: Added, probabilities: Probabilities
) -> tuple[Considered, ...]:
    """All effects: those accepted in the order of addition, then the others by the share they explain."""
    rounds = rounds_of(suspects.searched)
    named = {one.effect: one for one in added.refined.effects}
    found: dict[Effect, Considered] = {}
    for effect in catalogue().values():
        shares = [share for tried in rounds if (share := _share(tried, effect)) is not None]
        reason = _for(named[effect]) if effect in named else _against(effect, recordings, suspects, added, rounds)
        last = _share(rounds[-1], effect) if len(rounds) > 1 and effect not in named else None
        likely = probabilities.names.get(effect.name, 0.0)
        found[effect] = Considered(effect, effect in named, likely, shares[0] if shares else None, last, reason)
    taken = [found.pop(effect) for effect in named]
    return (*taken, *sorted(found.values(), key=lambda one: -(one.alone or 0.0)))


def rounds_of(searched: Searched) -> list[Step]:
    """Rounds of a search: each fit with what was tried beside it; beside the last nothing was accepted."""
    pairs = zip(searched.steps, searched.steps[1:], strict=False)
    rounds = [Step(before.fitted, after.rivals) for before, after in pairs]
    return rounds if searched.ended is None else [*rounds, searched.ended]


def _share(tried: Step, effect: Effect) -> float | None:
    """Share of the squared residual that an effect explains beside a fit; None if it was not tried."""
    gains = [candidate.gain for candidate in tried.rivals if candidate.term.effect is effect]
    return max(0.0, *gains) / max(tried.fitted.squares, 1e-300) if gains else None


def _for(named: NamedEffect) -> str:
    """The figures that support an effect."""
    return ", ".join(f"{key.replace('_', ' ')} {value:.3g}" for key, value in named.evidence.items()) or "named"


def _against(effect: Effect, recordings: Recordings, suspects: Suspects, added: Added, rounds: Sequence[Step]) -> str:
    """Why an effect is not in the model: the first of these reasons that holds."""
    rejected = {one.name: one.reason for one in added.rejected}
    share = _share(rounds[-1], effect) if rounds else None
    reasons = {
        "was not to be tried": effect.name in suspects.excluded,
        rejected.get(effect.name, ""): effect.name in rejected,
        "was taken up and let go: the others explain it too, or another set of names is likelier": any(
            effect is term.effect for tried in rounds for term in tried.fitted.terms
        ),
        "such a recording cannot show it": not effect.sought(recordings.rows.scope),
        "no more than chance": share is not None
        and share * rounds[-1].fitted.squares < suspects.policy.by_chance(rounds[-1].fitted, 1),
        "too little, or with values that physics forbids": share is not None,
        "the recording tells but one of it and what was taken": not suspects.searched.last.hypothesis.admits(effect),
    }
    return next((reason for reason, holds in reasons.items() if holds), "nothing in the recording points to it")
