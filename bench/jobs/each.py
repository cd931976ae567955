"""Do the same work on many items: in worker processes beside this one, or on the workers of a Dask cluster."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from queue import Empty, SimpleQueue
from statistics import median
from threading import Thread
from typing import Generic, TypeVar

from bench.jobs.process import LOOK, Failure, Limits, WorkerProcess

Item = TypeVar("Item")
Result = TypeVar("Result")

#: Time that a process takes to start and to load the bench - s (1 to 2 s measured).
STARTS = 1.5
#: Pieces by which it is judged how long one takes.
RECENT = 20


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
        workers: most processes on this machine; None: one a core. There are as many as pay.
        scheduler: address of a Dask cluster that does the work instead.

    Raises:
        InputError: no Dask scheduler answers at the address.
    """
    limits = limits or Limits()
    numbered = deque(enumerate(items))
    if scheduler is not None and numbered:
        from bench.jobs.on_dask import on_dask  # Dask: a second

        yield from on_dask(work, numbered, limits, scheduler)
    else:
        pool = _Workers(work, limits, numbered)
        try:
            yield from pool.outcomes(workers or os.cpu_count() or 1)
        finally:
            pool.end()


class _Workers(Generic[Item, Result]):
    """Threads, each with a worker process, that take from what is waiting."""

    def __init__(self, work: Callable[[Item], Result], limits: Limits, waiting: deque[tuple[int, Item]]) -> None:
        self._work, self._limits, self._waiting = work, limits, waiting
        self._done: SimpleQueue[tuple[int, Result | Failure, float] | Exception] = SimpleQueue()
        self._threads: list[Thread] = []
        self._processes: list[WorkerProcess[Item, Result]] = []

    def outcomes(self, most: int) -> Iterator[tuple[int, Result | Failure]]:
        """As `each` has them; a process more is started where what waits takes longer than its start."""
        seconds: deque[float] = deque(maxlen=RECENT)
        left = len(self._waiting)
        while left:
            while self._waiting and len(self._threads) < most and self._worth_one_more(seconds):
                self._start()
            try:
                outcome = self._done.get(timeout=STARTS)
            except Empty:  # a piece takes longer than a start
                seconds.append(STARTS)
                continue
            if isinstance(outcome, Exception):
                raise outcome
            place, result, took = outcome
            seconds.append(took)
            left -= 1
            yield place, result

    def _worth_one_more(self, seconds: Sequence[float]) -> bool:
        """Whether one worker more saves more time than it takes to start, judged by the last pieces."""
        workers = len(self._threads)
        return not workers or (bool(seconds) and len(self._waiting) * median(seconds) / workers > STARTS)

    def _start(self) -> None:
        self._processes.append(WorkerProcess(self._work, self._limits))
        self._threads.append(Thread(target=self._serve, args=(self._processes[-1],), daemon=True))
        self._threads[-1].start()

    def _serve(self, process: WorkerProcess[Item, Result]) -> None:
        with process:
            while self._waiting:
                try:
                    place, item = self._waiting.popleft()
                except IndexError:  # another was faster
                    return
                try:
                    self._done.put((place, process.do(item), process.took))
                except Exception as error:  # of the item, which cannot be sent
                    self._done.put(error)

    def end(self) -> None:
        """Stop what is still done, and end all processes."""
        self._waiting.clear()
        for process, thread in zip(self._processes, self._threads, strict=True):
            while thread.is_alive():  # it may be about to start its process
                process.stop()
                thread.join(LOOK)
