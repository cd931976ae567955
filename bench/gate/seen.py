"""A recording as the checks see it: what several of them ask for is computed once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from bench.arrays import Array
from bench.gate.balance import Balanced, Sums, balanced
from bench.gate.check import Check
from bench.rig.rig import Rig
from bench.trace.motion import raw_speed
from bench.trace.trace import Trace, less_known

#: Samples of a stretch, and stretches of a recording, evenly spaced where there are more: they stand for all of it, so
#: that a check costs the same for an hour as for a minute.
LONGEST, MOST = 2**13, 4
#: Lengths of windows of a torque balance - samples -; the one that explains most is taken.
LENGTHS = (4, 16, 64, 256)
EFFORTS = ("torque", "force", "current", "voltage")


@dataclass(frozen=True, eq=False)
class Seen:
    """A recording and, if known, the rig of its axis."""

    trace: Trace
    rig: Rig | None = None
    _balances: dict[int, Balanced | None] = field(default_factory=dict, init=False, repr=False)

    def stretches(self, least: int) -> list[slice]:
        """Stretches without a hole of at least `least` samples: all, or evenly spaced ones of a long recording."""
        pieces = [
            slice(start, min(start + LONGEST, part.stop))
            for part in self.trace.segments
            for start in range(part.start, part.stop, LONGEST)
        ]
        if len(self.trace) > MOST * LONGEST:
            long = [piece for piece in pieces if 2 * (piece.stop - piece.start) > LONGEST] or pieces
            pieces = [long[k] for k in np.unique(np.linspace(0, len(long) - 1, MOST).astype(int))]
        return [piece for piece in pieces if piece.stop - piece.start >= least]

    @property
    def tells_motion(self) -> bool:
        """Whether position or speed is recorded."""
        return "position" in self.trace or "velocity" in self.trace

    def speed(self, part: slice) -> Array:
        """Speed over a stretch (n,) - rad/s (m/s): the reported one, else the position's."""
        trace = self.trace
        if "velocity" in trace:
            return trace["velocity"][part]
        return raw_speed(trace["position"][part], "position", trace.sample_period)

    @cached_property
    def effort(self) -> tuple[Array, str] | None:
        """Effort and its name: by the rig, else the first signal of EFFORTS; None without one."""
        trace, rig = self.trace, self.rig
        names = [name for name in EFFORTS if name in trace]
        if not names:
            return None
        if rig is None:
            return trace[names[0]], names[0]
        effort = less_known(trace, rig.effort(trace)[0])
        direct = rig.axis_kind.effort
        return effort, direct if direct in trace else next(name for name in names if name not in ("torque", "force"))

    def balance(self, lengths: Iterable[int] = LENGTHS) -> Balanced | None:
        """The torque balance over windows of the length that explains most; None without effort, or if too short.

        Args:
            lengths: of windows to try, LENGTHS or some of them - samples.
        """
        for length in lengths:
            if length not in self._balances:
                self._balances[length] = balanced(self._sums, length)
        found = [one for length in lengths if (one := self._balances[length]) is not None]
        return max(found, key=lambda one: one.by_position) if found else None

    @cached_property
    def _sums(self) -> list[Sums]:
        if self.effort is None or not self.tells_motion:
            return []
        effort, _ = self.effort
        return [Sums.of(self.trace, self.speed(part), effort, part) for part in self.stretches(3 * min(LENGTHS))]


@dataclass(frozen=True)
class Repaired:
    """The result of a check that could put right what it found.

    Attributes:
        check: the result.
        trace: as it was meant.
    """

    check: Check
    trace: Trace


#: What each check is: a question to a recording.
Look = Callable[[Seen], Check | Repaired]


def resolution_of(values: Array) -> float:
    """Smallest step between successive values (n,) that differ, in their unit; 0 where none do."""
    steps = np.abs(np.diff(values))
    return float(steps.min(where=steps > 0.0, initial=np.inf)) if steps.any() else 0.0
