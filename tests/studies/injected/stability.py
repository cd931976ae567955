"""Whether names stay: under fresh noise, in each half of a recording, in other rounds of an axis."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from bench.diagnosis.diagnosis import diagnose
from bench.errors import BenchError
from bench.trace.noise import white_noise
from bench.trace.trace import Trace
from tests.studies.injected.sources import Source

#: Signals that carry noise of their own.
NOISY = ("position", "velocity", "current", "torque", "force", "voltage")
WHOLE, NOISE, HALVES = "whole", "fresh noise", ("first half", "second half")
Names = tuple[str, ...] | None
#: What is compared, of which recordings, and the names of both.
Compared = tuple[str, str, Names, Names]


def variants(trace: Trace, seed: int) -> Iterator[tuple[str, Trace]]:
    """The recording as it is, with its own white noise once more, and its halves."""
    rng = np.random.default_rng(seed)
    noisy = {
        name: trace[name] + white_noise(*(trace[name][part] for part in trace.segments)) * rng.normal(size=len(trace))
        for name in NOISY
        if name in trace
    }
    middle, end = 0.5 * (trace.time[0] + trace.time[-1]), trace.time[-1] + trace.sample_period
    yield WHOLE, trace
    yield NOISE, trace.with_signals(noisy, {})
    yield HALVES[0], trace.between(trace.time[0], middle)
    yield HALVES[1], trace.between(middle, end)


def names(item: tuple[Source, int]) -> dict[str, Names]:
    """Names by variant; None where it is refused."""
    source, seed = item
    trace, rig = source.read()
    found: dict[str, Names] = {}
    for variant, made in variants(trace, seed):
        try:
            found[variant] = tuple(sorted(effect.name for effect in diagnose(made, rig).effects))
        except BenchError:
            found[variant] = None
    return found


def compared(sources: Sequence[Source], said: Mapping[str, Mapping[str, Names]]) -> Iterator[Compared]:
    """Variants of a recording with it, and rounds of an axis with each other."""
    for name, found in said.items():
        for variant in (NOISE, *HALVES):
            yield variant, name, found[WHOLE], found[variant]
    rounds: dict[str, list[str]] = {}
    for source in sources:
        rounds.setdefault(source.axis, []).extend([source.name] if source.name in said else [])
    for those in rounds.values():
        for one, other in combinations(those, 2):
            yield "rounds", f"{one}, {other}", said[one][WHOLE], said[other][WHOLE]


def markdown(sources: Sequence[Source], said: Mapping[str, Mapping[str, Names]], command: str) -> str:
    """How often names agree, and each comparison in which they do not."""
    found = list(compared(sources, said))
    counted = Counter((what, _agrees(one, other)) for what, _, one, other in found)
    lines = ["# Whether names stay", "", f"`{command}`", "", "| what | agree | differ | refused |", "|---|---|---|---|"]
    for what in (NOISE, *HALVES, "rounds"):
        lines += [f"| {what} | {counted[what, True]} | {counted[what, False]} | {counted[what, None]} |"]
    lines += ["", "| what | recordings | names | names there |", "|---|---|---|---|"]
    differing = [each for each in found if _agrees(*each[2:]) is not True]
    lines += [f"| {what} | {which} | {_told(one)} | {_told(other)} |" for what, which, one, other in differing]
    return "\n".join(lines) + "\n"


def _agrees(one: Names, other: Names) -> bool | None:
    return None if one is None or other is None else one == other


def _told(those: Names) -> str:
    return "refused" if those is None else ", ".join(those) or "none"
