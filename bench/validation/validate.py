"""Validation: draw cases, carry them out wherever there are workers, and see how often results hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from bench.jobs.each import each
from bench.jobs.process import Failure, Limits
from bench.validation.coverage import Coverage, Naming, coverage, naming
from bench.validation.plan import Plan
from bench.validation.run import Run, carried_out, failed, pieces

Progress = Callable[[float], None]
#: For one piece of work: ten times of what it takes where it is slowest, several effects in each run - s.
DEADLINE = 3600.0


@dataclass(frozen=True)
class Validation:
    """What a Monte Carlo comes to.

    Attributes:
        runs: by their index.
        coverage: of every quantity by groups of runs.
        naming: None where nothing was diagnosed.
    """

    runs: tuple[Run, ...]
    coverage: tuple[Coverage, ...]
    naming: Naming | None


def validate(
    plan: Plan,
    count: int,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = lambda share: None,
) -> Validation:
    """Carry out the first runs of a plan; the same for any number of workers.

    Args:
        plan: that says what each run is.
        count: of runs.
        workers: processes on this machine; None: one a core.
        scheduler: address of a Dask cluster that does the work instead.
        progress: called with the share done.

    Raises:
        InputError: no Dask scheduler answers at the address.
    """
    work = pieces(plan, count)
    runs: dict[int, Run] = {}
    for place, outcome in each(carried_out, work, Limits(deadline=DEADLINE), workers, scheduler):
        found = failed(work[place], outcome.reason) if isinstance(outcome, Failure) else outcome
        runs |= {run.index: run for run in found}
        progress(len(runs) / count)
    ordered = tuple(runs[index] for index in range(count))
    return Validation(ordered, tuple(coverage(ordered)), naming(ordered))
