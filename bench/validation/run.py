"""One run: a case is recorded, identified and, if wanted, diagnosed; results are compared with the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from bench.diagnosis.diagnosis import diagnose
from bench.errors import BenchError
from bench.fit.estimate import RefusedEstimateError
from bench.fit.identify import identify
from bench.trace.trace import Trace
from bench.validation.case import Case
from bench.validation.plan import Plan
from bench.validation.record import record
from bench.validation.score import Named, Scored, base, of_effects

#: Runs simulated side by side in one piece of work: more cost no less each.
TOGETHER = 64
Status = Literal["done", "refused", "failed"]


@dataclass(frozen=True)
class Run:
    """One run.

    Attributes:
        index, plant, motion, kind, hidden, severity: as drawn.
        noise: of speed and current, as white/hum.
        sample_period, duration: of the recording - s.
        status: done; refused by `identify`, which tells what it knows all the same; failed where there is no recording.
        reason: why it is not done.
        told: quantities, by `identify` and by `diagnose`.
        named: by `diagnose`, if it was asked.
    """

    index: int
    plant: str
    motion: str
    kind: str
    noise: str
    sample_period: float
    duration: float
    hidden: tuple[str, ...]
    severity: float
    status: Status = "done"
    reason: str = ""
    scored: tuple[Scored, ...] = ()
    named: Named | None = None


@dataclass(frozen=True)
class Piece:
    """Consecutive runs of a plan, from `first` up to and without `stop`."""

    plan: Plan
    first: int
    stop: int

    @property
    def cases(self) -> list[Case]:
        """Of its runs."""
        return [self.plan.case(index) for index in range(self.first, self.stop)]


def pieces(plan: Plan, count: int) -> list[Piece]:
    """The runs of a plan, cut for the work; a run is the same in any piece."""
    return [Piece(plan, first, min(first + TOGETHER, count)) for first in range(0, count, TOGETHER)]


def carried_out(piece: Piece) -> list[Run]:
    """The runs of a piece."""
    cases, plan = piece.cases, piece.plan
    return [judged(case, made, plan) for case, made in zip(cases, record(cases, plan.seed), strict=True)]


def judged(case: Case, made: Trace | BenchError, plan: Plan) -> Run:
    """Results on a recording, compared with its case."""
    run = drawn(case)
    if isinstance(made, BenchError):
        return replace(run, status="failed", reason=str(made))
    run = identified(run, case, made)
    return diagnosed(run, case, made) if plan.diagnose else run


def identified(run: Run, case: Case, trace: Trace) -> Run:
    """With the result of `identify`, or its refusal."""
    try:
        estimate, status, reason = identify(trace, case.rig), "done", ""
    except RefusedEstimateError as refused:
        estimate, status, reason = refused.estimate, "refused", str(refused)
    except BenchError as refused:
        return replace(run, status="refused", reason=str(refused))
    return replace(run, status=status, reason=reason, scored=tuple(base("identify", case, estimate.parameters)))


def diagnosed(run: Run, case: Case, trace: Trace) -> Run:
    """With the result of `diagnose`, or its refusal."""
    try:
        found = diagnose(trace, case.rig)
    except BenchError as refused:
        return replace(run, named=Named(missed=case.hidden, reason=str(refused)))
    scored = (*run.scored, *base("diagnose", case, found.parameters), *of_effects(case, found))
    return replace(run, scored=scored, named=Named.of(found.verdict, found.effects, case.hidden))


def drawn(case: Case) -> Run:
    """A run before anything is made of it."""
    sensors = case.sensors
    return Run(
        index=case.index,
        plant=case.plant,
        motion=case.motion_name,
        kind=case.rig.kind,
        noise=f"{sensors.velocity.kind}/{sensors.current.kind}",
        sample_period=sensors.sample_period,
        duration=case.motion.duration,
        hidden=case.hidden,
        severity=case.severity,
    )


def failed(piece: Piece, reason: str) -> Sequence[Run]:
    """The runs of a piece whose work gave no result."""
    return [replace(drawn(case), status="failed", reason=reason) for case in piece.cases]
