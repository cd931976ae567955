"""Work on the parts of a recording side by side, in order, without holding more of them than are being worked on."""

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
    """Results of `work` on each part, in order, on one thread a core: NumPy lets them run while it computes.

    At most two parts a core wait at a time, so a recording may be longer than memory. A lone part needs no thread: to
    start some takes milliseconds.
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
