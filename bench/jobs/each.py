"""Do the same work on many items: in one worker process if that is faster, else on Dask."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from statistics import median
from typing import TypeVar

from bench.jobs.process import Failure, Limits, WorkerProcess

Item = TypeVar("Item")
Result = TypeVar("Result")

#: Time that Dask takes to load, start and stop - s (7 s measured on two busy cores).
DASK_STARTS = 7.0


def each(
    work: Callable[[Item], Result],
    items: Iterable[Item],
    limits: Limits | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
) -> Iterator[tuple[int, Result | Failure]]:
    """Index of each item with its result or failure, in order of completion.

    An item that raises, hangs or ends its process is a `Failure` and nothing else: the others go on. What is returned
    for an item depends on neither the number of workers nor where they are.

    Args:
        work: a picklable function of one item.
        items: picklable.
        limits: of one item.
        workers: processes on this machine; None: one a core.
        scheduler: address of a Dask cluster that does the work instead.

    Raises:
        InputError: no Dask scheduler answers at the address.
    """
    limits = limits or Limits()
    waiting = deque(enumerate(items))
    workers = workers or os.cpu_count() or 1
    if scheduler is None:
        seconds: list[float] = []
        with WorkerProcess(work, limits) as process:
            while waiting and not _worth_dask(seconds, len(waiting), workers):
                place, item = waiting.popleft()
                outcome = process.do(item)
                seconds.append(process.took)  # without its start, which Dask's workers need too
                yield place, outcome
    if waiting:
        from bench.jobs.on_dask import on_dask  # Dask: a second

        yield from on_dask(work, waiting, limits, workers, scheduler)


def _worth_dask(seconds: list[float], left: int, workers: int) -> bool:
    """Whether several workers save more time than Dask takes to start, judged by the items so far."""
    return bool(seconds) and left * median(seconds) * (1.0 - 1.0 / workers) > DASK_STARTS
