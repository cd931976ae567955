"""Do the same work on many items: in worker processes, or on the workers of a Dask cluster."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from queue import Empty, SimpleQueue
from statistics import median
from threading import Thread

from bench.errors import InputError
from bench.jobs.process import LOOK, Failure, Item, Limits, Result, WorkerProcess

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
    starts: float = STARTS,
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
        starts: time that a process takes to start - s; one more starts where it saves more.

    Raises:
        InputError: no Dask scheduler answers at the address, or Dask is not installed.
    """
    limits = limits or Limits()
    numbered = deque(enumerate(items))
    if scheduler is not None and numbered:
        try:
            from bench.jobs.on_dask import on_dask  # Dask: a second
        except ModuleNotFoundError as error:
            found = "found, but Dask is not installed"
            raise InputError("--scheduler", found, "install it: pip install 'servobench[cluster]'") from error
        yield from on_dask(work, numbered, limits, scheduler)
    else:
        yield from _on_this_machine(work, numbered, limits, workers or os.cpu_count() or 1, starts)


def _on_this_machine(
    work: Callable[[Item], Result], waiting: deque[tuple[int, Item]], limits: Limits, most: int, starts: float
) -> Iterator[tuple[int, Result | Failure]]:
    """The same by threads, each with a worker process, that take from what is waiting; all end with the iterator."""
    done: SimpleQueue[tuple[int, Result | Failure, float] | Exception] = SimpleQueue()
    threads: dict[Thread, WorkerProcess[Item, Result]] = {}
    seconds: deque[float] = deque(maxlen=RECENT)

    def another_pays() -> bool:
        """Whether one worker more saves more time than it takes to start, judged by the last pieces."""
        return not threads or (bool(seconds) and len(waiting) * median(seconds) / len(threads) > starts)

    def serve(process: WorkerProcess[Item, Result]) -> None:
        with process, suppress(IndexError):  # nothing waits any more
            while True:
                place, item = waiting.popleft()
                try:
                    done.put((place, process.do(item), process.took))
                except Exception as error:  # of the item, which cannot be sent
                    done.put(error)

    left = len(waiting)
    try:
        while left:
            while waiting and len(threads) < most and another_pays():
                process = WorkerProcess(work, limits)
                thread = Thread(target=serve, args=(process,), daemon=True)
                threads[thread] = process
                thread.start()
            try:
                outcome = done.get(timeout=starts)
            except Empty:  # a piece takes longer than a start
                seconds.append(starts)
                continue
            if isinstance(outcome, Exception):
                raise outcome
            place, result, took = outcome
            seconds.append(took)
            left -= 1
            yield place, result
    finally:
        waiting.clear()
        for thread, process in threads.items():
            while thread.is_alive():  # it may be about to start its process
                process.stop()
                thread.join(LOOK)
