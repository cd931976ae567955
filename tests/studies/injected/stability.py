"""Whether names stay: under fresh noise, in each half of a recording, in other rounds of an axis."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bench.diagnosis.diagnosis import diagnose
from bench.errors import BenchError
from bench.trace.noise import white_noise
from bench.trace.trace import Trace
from tests.studies.frame import table
from tests.studies.injected.sources import Source

#: Signals that carry noise of their own.
NOISY = ("position", "velocity", "current", "torque", "force", "voltage")
WHOLE, NOISE, HALVES = "whole", "fresh noise", ("first half", "second half")
#: Probability from which on a name is sure, and, less than one by as much, ruled out.
SURE = 0.95


@dataclass(frozen=True)
class Answer:
    """Names of a recording, and the probability of each that was considered, by name."""

    names: tuple[str, ...]
    probabilities: Mapping[str, float]

    def __str__(self) -> str:
        likely = {name: share for name, share in self.probabilities.items() if share > 1.0 - SURE or name in self.names}
        return ", ".join(f"{name} {share:.2f}" for name, share in likely.items()) or "none"

    def beside(self, other: Answer) -> str:
        """AGREE, OPEN where the probabilities leave each name that differs open, or CONTRADICT."""
        differing = {*self.names} ^ {*other.names}
        shares = [sorted(each.probabilities.get(name, 0.0) for each in (self, other)) for name in differing]
        if any(less < 1.0 - SURE and more > SURE for less, more in shares):
            return CONTRADICT
        return OPEN if differing else AGREE


AGREE, OPEN, CONTRADICT, REFUSED = FATES = ("agree", "left open by their probabilities", "contradict", "refused")
#: What is compared, of which recordings, and the answers of both; None where it is refused.
Compared = tuple[str, str, Answer | None, Answer | None]


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


def answers(item: tuple[Source, int]) -> dict[str, Answer | None]:
    """Answers by variant; None where it is refused."""
    source, seed = item
    trace, rig = source.read()
    found: dict[str, Answer | None] = {}
    for variant, made in variants(trace, seed):
        try:
            diagnosis = diagnose(made, rig)
        except BenchError:
            found[variant] = None
        else:
            names = tuple(sorted(effect.name for effect in diagnosis.effects))
            found[variant] = Answer(names, dict(diagnosis.probabilities.names))
    return found


def compared(sources: Sequence[Source], said: Mapping[str, Mapping[str, Answer | None]]) -> Iterator[Compared]:
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


def markdown(sources: Sequence[Source], said: Mapping[str, Mapping[str, Answer | None]], command: str) -> str:
    """How often names agree, and each comparison in which they do not."""
    found = [(_fate(one, other), what, which, one, other) for what, which, one, other in compared(sources, said)]
    counted = Counter((what, fate) for fate, what, *_ in found)
    totals = [(what, *(counted[what, fate] for fate in FATES)) for what in (NOISE, *HALVES, "rounds")]
    differing = [
        (fate, *(REFUSED if cell is None else cell for cell in cells))
        for fate, *cells in sorted(found, key=lambda each: (-FATES.index(each[0]), *each[1:3]))
        if fate != AGREE
    ]
    heads = ("fate", "what", "recordings", "names and probabilities", "there")
    parts = ["# Whether names stay", f"`{command}`", table(("what", *FATES), totals), table(heads, differing)]
    return "\n\n".join(parts) + "\n"


def _fate(one: Answer | None, other: Answer | None) -> str:
    return REFUSED if one is None or other is None else one.beside(other)
