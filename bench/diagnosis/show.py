"""Show what was found, with the gaps that every addition closed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from bench.comparison.spread import Between
from bench.diagnosis.add import Added, Rejected
from bench.diagnosis.apart import apart
from bench.diagnosis.considered import Considered, considered
from bench.diagnosis.gaps import Course, Gap, Profile, Shrunk, courses, profiles, shrinking, torque_gap, velocity_gap
from bench.diagnosis.name import NamedEffect, Suspects
from bench.diagnosis.next_experiment import NextExperiment, propose
from bench.diagnosis.recordings import Recordings
from bench.diagnosis.same_axis import SameAxis
from bench.diagnosis.verdict import Shown, verdict
from bench.diagnosis.warnings import impacts, left_open, suspicions
from bench.diagnosis.where import Where, where
from bench.fit.estimate import Alone
from bench.fit.fit import Fit
from bench.fit.parameter import Parameter
from bench.fit.stored import Balance
from bench.gate.check import Check
from bench.plant.model_file import StoredModel


@dataclass(frozen=True)
class Diagnosis:
    """What is missing from the model of an axis, and the model with it.

    Attributes:
        verdict, effects, parameters: as the contract has them.
        because: what speaks against its being all; empty unless something remains.
        where: shares of the gap before any effect; unexplained_share, unexplained_where: of what is left.
        torque, velocity: gaps before and after.
        bandwidth: of the cascade that held the models to the recordings - rad/s.
        closed_loop: velocity gap under the rig's drive without and with what shows only there - rad/s (m/s).
        refined: velocity gap of held-out motion before and after values were refined by simulation; None if not kept.
        steps: the bare axis, then the model after each addition.
        holdout: whether it is of the same axis, and in what it differs.
        next_experiment: that tells apart what this recording does not.
        rejected: names that held-out motion spoke against.
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


def show(recordings: Recordings, bare: Fit, located: list[Where], suspects: Suspects, added: Added) -> Diagnosis:
    """The diagnosis of what was found.

    Args:
        recordings: laid out.
        bare: the fit without an effect.
        located: where the gap sits.
        suspects: what was named.
        added: what was kept.
    """
    rig, unit, kind = recordings.rig, recordings.unit, recordings.rig.axis_kind
    whole, kept, searched = added.extension.whole.fitted, added.refined, suspects.searched
    shown, several = courses(recordings, added), apart(recordings, whole, kept.parameters)
    steps, current = shrinking(added, shown), recordings.current
    torque, velocity = torque_gap(steps, whole, unit), velocity_gap(recordings, steps)
    comes_to, because = verdict(Shown(recordings, suspects, added, torque, velocity))
    return Diagnosis(
        verdict=comes_to,
        because=because,
        effects=kept.effects,
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
        holdout=added.compared,
        next_experiment=propose(recordings, suspects, added),
        stopped=searched.stopped,
        model=kept.model,
        balance=Balance.of(whole).repeating(added.repeats),
        courses=shown,
        profiles=profiles(bare, whole, kind, unit, current),
        considered=considered(recordings, suspects, added),
        warnings=[
            *suspicions(recordings.trace, rig, kept.parameters),
            *left_open(recordings.rows, kind),
            *impacts(whole, unit),
            *several.warnings,
            *added.warnings,
        ],
    )
