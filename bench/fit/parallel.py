"""Work on the parts of a recording in parallel and in order, with only a few of them in memory."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain, islice
from typing import TypeVar

Part = TypeVar("Part")
Result = TypeVar("Result")


def in_parallel(work: Callable[[Part], Result], parts: Iterable[Part]) -> Iterator[Result]:
    """Results of `work` on each part, in order, on one thread a core; NumPy releases the interpreter lock.

    At most two parts a core are in memory, so a recording may be larger than it. A single part is done without threads,
    whose start takes milliseconds.
    """
    cores, parts = os.cpu_count() or 1, iter(parts)
    ahead = list(islice(parts, 2))
    if len(ahead) < 2:
        yield from map(work, ahead)
        return
    waiting: deque[Future[Result]] = deque()
    with ThreadPoolExecutor(cores) as pool:
        for part in chain(ahead, parts):
            waiting.append(pool.submit(work, part))
            if len(waiting) >= 2 * cores:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
