"""Diagnosis in five steps: gap, where, name, add, show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from bench.diagnose.add import Added, add
from bench.diagnose.balance import Balance
from bench.diagnose.decidable import impacts, require_positive, untold
from bench.diagnose.fit import Fit, fit
from bench.diagnose.found import Gap, NamedEffect, Rejected, Shrunk
from bench.diagnose.hypothesis import Hypothesis
from bench.diagnose.name import Suspects, name
from bench.diagnose.next_experiment import NextExperiment, propose
from bench.diagnose.quantities import base_parameters, uncertain
from bench.diagnose.recordings import Recordings
from bench.diagnose.search import REMAINDER
from bench.diagnose.show import shrinking, torque_gap, velocity_gap
from bench.diagnose.suspicious import suspicions
from bench.diagnose.where import Where, where
from bench.identify.determined import require_significant
from bench.identify.estimate import Parameter
from bench.identify.regressors import INERTIA
from bench.plant.model_file import StoredModel
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Diagnosis:
    """What is missing from the model of an axis, and the model with it.

    Attributes:
        verdict, effects, parameters: as the contract has them.
        where: shares of the gap before any effect; unexplained_share, unexplained_where: of what is left.
        torque, velocity: gaps before and after.
        bandwidth: of the cascade that held the models to the recordings - rad/s.
        closed_loop: velocity gap under the rig's drive without and with what shows only there - rad/s (m/s).
        refined: velocity gap of unseen motion before and after values were refined by simulation; None if not kept.
        steps: the bare axis, then the model after each addition.
        next_experiment: that tells apart what this recording does not.
        rejected: names that unseen motion spoke against.
        model, balance: with all effects; no model where MuJoCo cannot have them.
        warnings: what a user should know.
    """

    verdict: str
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
    next_experiment: NextExperiment | None
    model: StoredModel | None
    balance: Balance
    warnings: list[str] = field(default_factory=list)


def diagnose(
    trace: Trace,
    rig: Rig,
    holdout: Trace | None = None,
    excluded: frozenset[str] = frozenset(),
    progress: Progress = lambda share: None,
) -> Diagnosis:
    """Find what is missing, name it, add it, and show the gap shrink.

    Args:
        trace: the recording.
        rig: of the axis.
        holdout: another recording of it, not used to fit.
        excluded: effects that are not tried.
        progress: called with the share done.

    Raises:
        UndeterminedError: the recording is too short, too slow or too quiet to decide.
        InputError: rig and recording do not fit together.
    """
    recordings = Recordings.of(trace, rig, holdout)
    gap = fit(recordings.bench, Hypothesis())
    located = where(recordings.bench, gap, rig.linear, recordings.unit)
    suspects = name(recordings, excluded)
    require_weight(recordings, suspects.steps[-1].fitted)
    progress(0.6)
    added = add(recordings, suspects)
    progress(0.9)
    return show(recordings, gap, located, suspects, added)


def require_weight(recordings: Recordings, fitted: Fit) -> None:
    """Refuse effects that leave no inertia which the recording tells, before a model is made of them.

    Raises:
        UndeterminedError: its interval holds zero.
        InputError: it is negative.
    """
    kind = recordings.rig.axis_kind
    units = {kind.parameter(INERTIA): kind.parameter_unit(INERTIA, recordings.unit)}
    (inertia,) = base_parameters(fitted, uncertain(recordings.bench, fitted), units).values()
    require_significant(inertia, kind)
    require_positive(inertia, recordings.trace.origin)


def show(recordings: Recordings, gap: Fit, located: list[Where], suspects: Suspects, added: Added) -> Diagnosis:
    """What was found, with the gaps that every addition closed."""
    bench, rig, unit = recordings.bench, recordings.rig, recordings.unit
    whole, kept = added.chain.whole.fitted, added.refined
    steps = shrinking(recordings, added)
    remains = whole.chi > REMAINDER or suspects.withheld
    return Diagnosis(
        verdict="unexplained_remainder" if remains else "explained" if kept.effects else "nothing_missing",
        effects=kept.effects,
        where=located,
        unexplained_share=whole.excess / max(float(np.sum(gap.residual**2)), 1e-300),
        unexplained_where=where(bench, whole, rig.linear, unit)[:3] if remains else [],
        parameters=kept.parameters,
        torque=torque_gap(steps, whole, unit),
        velocity=velocity_gap(recordings, steps),
        bandwidth=added.gaps.bandwidth,
        closed_loop=added.closed_loop,
        refined=kept.gap,
        steps=steps,
        rejected=added.rejected,
        next_experiment=propose(recordings, suspects, added),
        model=kept.model,
        balance=Balance.of(bench, whole).repeating(added.repeats),
        warnings=[
            *suspicions(recordings.trace, rig, kept.parameters),
            *untold(bench, rig.axis_kind),
            *impacts(whole, unit),
            *added.warnings,
        ],
    )
