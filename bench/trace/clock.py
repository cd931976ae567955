"""Sample times as recorded: shared by signals, rounded by the recorder, some duplicate or decreasing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.errors import InputError

#: Largest share of samples with a time that another sample already has, and other values.
MOST_DUPLICATES = 0.01


@dataclass(frozen=True, eq=False)
class Clock:
    """Sample times shared by signals.

    Attributes:
        time: s - (n,).
        recorded: the same times in the file's unit, as its digits show them - (n,).
        tick: seconds per file unit.
        place: where sample i stands in the file, for messages.
    """

    time: Array
    recorded: Array
    tick: float
    place: Callable[[int | None], str]

    @cached_property
    def quantum(self) -> float:
        """Step of the decimal grid that all recorded times lie on - s; 0 if there is none.

        Times printed with k decimals stand on the grid 10**-k.
        """
        for decimals in range(7):
            scaled = self.recorded * 10.0**decimals
            rounding = max(1e-6, 4.0 * float(np.spacing(np.abs(scaled).max())))
            if np.abs(scaled - np.rint(scaled)).max() <= rounding:
                return self.tick * 10.0**-decimals
        return 0.0


@dataclass(frozen=True, eq=False)
class Sampled:
    """Values of a signal with the clock they were sampled by.

    Attributes:
        clock: its sample times.
        values: SI - (n,).
        unknown: where the file has no value and neighbours were used - (n,); None: nowhere.
    """

    clock: Clock
    values: Array
    unknown: NDArray[np.bool_] | None = None


def without_duplicates(clock: Clock, values: Mapping[str, Array]) -> tuple[Clock, Mapping[str, Array], int]:
    """The clock and its signals without samples at a time already taken, and how many those were.

    Raises:
        InputError: time runs backwards, or more than 1 % of samples repeat a time with other values.
    """
    time = clock.time
    if time.size < 2:
        raise InputError(clock.place(None), f"found {time.size} samples", "allowed: at least two")
    if (time[1:] > time[:-1]).all():
        return clock, values, 0
    step = np.diff(time)
    if (step < 0).any():
        first = int(np.argmax(step < 0)) + 1
        raise InputError(
            clock.place(first),
            f"time runs backwards ({time[first - 1]:g} s, then {time[first]:g} s)",
            "allowed: increasing times",
        )
    again = np.concatenate([[False], step == 0])
    other = again & np.logical_or.reduce([np.concatenate([[False], np.diff(v) != 0]) for v in values.values()])
    if other.sum() > MOST_DUPLICATES * time.size:
        raise InputError(
            clock.place(int(np.argmax(other))),
            f"{int(other.sum())} of {time.size} samples stand at a time already taken, with other values",
            "allowed: at most 1 %; record with finer time stamps, or give sample_period in the rig's [trace]",
        )
    keep = ~again
    kept = {name: array[keep] for name, array in values.items()}
    return Clock(time[keep], clock.recorded[keep], clock.tick, clock.place), kept, int(again.sum())
