"""A recording gathered into normal equations: its first part decides on filter and hum, all parts are summed up."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, islice
from typing import TypeVar

from bench.axis_kind import OFFSET
from bench.fit.cutoffs import TERMS, choose
from bench.fit.determined import only_direction
from bench.fit.layout import lay_out
from bench.fit.normal_equations import BLOCKS, Name, NormalEquations, join
from bench.fit.rows import Rows
from bench.fit.solution import Solution, equations_of, solve
from bench.fit.systematic import by_hint, by_tolerance
from bench.gate.check import Check
from bench.gate.gate import PARTS, gate, joined, passed, require
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Part = TypeVar("Part")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class Gathered:
    """Normal equations of a recording.

    Attributes:
        first: solution of its first part, at whose filter the others are taken; of all of it where it is one part.
        equations: of every column and, last, a constant.
        effort_unit: N*m, N, or what the rig allows.
        samples_read: of all parts.
        doubt: possible bias of J, K_w and K_0, as they move with the filter's cut-off.
        hinted: by how much an effect that the recording hints at would move them.
        tolerance: half widths of coefficients from the rig's tolerances.
        warnings: about the cut-off.
        checks: of all parts.
        in_parts: whether there are parts beside the first.
    """

    first: Solution
    equations: NormalEquations
    effort_unit: str
    samples_read: int
    doubt: Mapping[str, float]
    hinted: Mapping[str, float]
    tolerance: Mapping[Name, float]
    warnings: tuple[str, ...]
    checks: tuple[Check, ...]
    in_parts: bool

    @property
    def rows(self) -> Rows:
        """Of its first part, which determines filter and noise floor."""
        return self.first.rows

    @cached_property
    def one_way(self) -> str | None:
        """The one direction in which it moves, if it does so."""
        return only_direction(self.equations)

    def solved(self, offset: bool) -> Solution:
        """Its solution with or without a constant, each solved for once."""
        if not self.in_parts and offset == (OFFSET in self.first.names):
            return self.first
        return self._with_offset if offset else self._plain

    @cached_property
    def _plain(self) -> Solution:
        return solve(self.rows, self.first.hypothesis, self.first.laid, self.equations, offset=False)

    @cached_property
    def _with_offset(self) -> Solution:
        return solve(self.rows, self.first.hypothesis, self.first.laid, self.equations, offset=True)


def gather(trace: Trace | Iterable[Trace], rig: Rig, cutoff: float | None) -> Gathered:
    """Normal equations of a recording, or of its consecutive parts.

    Args:
        trace: the recording, or an iterator over its parts.
        rig: of the axis.
        cutoff: half-power frequency of the filter instead of the one chosen from the data - Hz.

    Raises:
        UndeterminedError: the recording is too short, or never moves clearly.
        InputError: a signal is missing, rig and recording do not fit together, or a check of the recording fails.
    """
    parts = iter([trace] if isinstance(trace, Trace) else trace)
    gated = passed(next(parts), rig)
    first = gated.trace
    found, chosen = choose(first, rig, cutoff)

    def gathered(part: Trace) -> tuple[NormalEquations, int, tuple[Check, ...]]:
        if part is first:
            return found.whole, len(part), gated.checks
        sound = gate(part, rig, PARTS)
        rows = Rows.of(sound.trace, rig, conditioning=found.rows.conditioning, begins=float(first.time[0]))
        return equations_of(rows, lay_out(rows, found.hypothesis)), len(sound.trace), sound.checks

    equations, read, checks = zip(*in_parallel(gathered, chain([first], parts)), strict=True)
    together = joined(checks)
    require(together, first)
    return Gathered(
        first=found,
        equations=join(equations).coarsened(BLOCKS),
        effort_unit=rig.net_effort(first)[1],
        samples_read=sum(read),
        doubt=dict(zip(TERMS, chosen.doubt.tolist(), strict=True)),
        hinted=by_hint(found),
        tolerance=by_tolerance(first, rig, found, OFFSET in found.names),
        warnings=chosen.warnings,
        checks=together,
        in_parts=len(equations) > 1,
    )


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
