"""Ways to do the same, timed in turn: whatever else the machine does, it does to all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

Way = Callable[[], object]


@dataclass(frozen=True)
class Timed:
    """Seconds of each way in each round.

    Attributes:
        seconds: by name of the way - s - (rounds,) each.
    """

    seconds: Mapping[str, tuple[float, ...]]

    def median(self, way: str) -> float:
        """Of a way over the rounds - s."""
        return statistics.median(self.seconds[way])

    def ratio(self, way: str, beside: str) -> float:
        """How many times as long one way takes as another: the median of the rounds' ratios."""
        rounds = zip(self.seconds[way], self.seconds[beside], strict=True)
        return statistics.median(one / other for one, other in rounds)


def in_turn(ways: Mapping[str, Way], rounds: int) -> Timed:
    """Every way once before any counts, so that all find their files and code loaded; then `rounds` rounds of all."""
    for way in ways.values():
        way()
    seconds: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(rounds):
        for name, way in ways.items():
            began = time.perf_counter()
            way()
            seconds[name].append(time.perf_counter() - began)
    return Timed({name: tuple(taken) for name, taken in seconds.items()})
