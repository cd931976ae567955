"""Why a recording cannot be of the lab's axis: known mistakes are undone on it until nothing contradicts it any more.

The fewest mistakes that do are the cause; where several would, all are named, and where none does, none is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import combinations, permutations, product

import numpy as np

from bench.course.mistakes import MISTAKES, Mistake, scaled
from bench.course.plausible import (
    DISK,
    FASTEST,
    FULL_CURRENT,
    LARGEST_CURRENT,
    between,
    fault,
    holes,
    inertia_of,
)
from bench.course.run import LabRun
from bench.rig.rig import Rig

#: Causes that are named of one recording; more are none.
NAMED = 3
#: Between this and its inverse a factor on the current is no unit, and below √2.
SCALE = 1.38
#: Share of samples that two recordings of one motion never have in common.
SAME = 0.9
#: What is tried, until it explains: mistakes in a recording at most, whether files are exchanged, and whether more than
#: the least that a recording asks for are tried, as the others may ask for them.
TRIED = ((1, False, False), (1, True, False), (2, False, False), (2, True, False), (2, False, True), (3, False, False))
UNEXPLAINED = "no known mistake explains it: look at its signals"
OTHER_DISK = (
    "no known mistake explains it: if another disk turns, give it in a rig.toml next to the recordings, "
    '[load] and below it moment_of_inertia = "30 kg*cm**2", or outer_diameter, inner_diameter, thickness and density'
)


#: Recordings by name, and what was undone in each.
Undone = dict[str, tuple[Mistake, ...]]


def refusals(runs: Mapping[str, LabRun], rig: Rig) -> dict[str, str]:
    """Recordings that cannot be of the rig's axis, each with what contradicts it and, where it is known, why."""
    own = {name: words for name, run in runs.items() if (words := fault(name, run, rig))}
    contradicted = own or between({name: inertia_of(run) for name, run in runs.items()})
    if not contradicted:
        return {}
    twins = next((pair for pair in combinations(runs, 2) if _alike(*(runs[name] for name in pair))), ())
    cut = frozenset(name for name, run in runs.items() if holes(name, run))
    longest = {name: replace(run, missing=(0.0, 0.0)) for name, run in runs.items()}
    left_out = [{left, *without} for without in dict.fromkeys((frozenset(), cut)) for left in twins or ("",)]
    causes = _causes(longest, [tuple(name for name in runs if name not in left) for left in left_out], rig)
    faults = {}
    for name in {**contradicted, **{name: "" for cause in causes for name in cause}}:
        same = twins if name in twins else (name,)
        undone = dict.fromkeys(cause[one] for cause in causes for one in same if cause.get(one))
        words = list(dict.fromkeys(", and ".join(mistake.words for mistake in made) for made in undone))
        why = [f"{' and '.join(twins)} are one and the same recording"] if name in twins else []
        why += [" - or ".join(words)] if 0 < len(words) <= NAMED else []
        found = contradicted.get(name) or f"its J contradicts that of {', '.join(contradicted)}"
        known = "record it again" if name in cut else OTHER_DISK if DISK in found else UNEXPLAINED
        faults[name] = f"{found}; {', and '.join(why) or known}"
    return faults


def _alike(one: LabRun, other: LabRun) -> bool:
    """Whether most samples are the same: one file that was changed in places is no other recording."""
    if one.time.size != other.time.size:
        return False
    same = (one.velocity == other.velocity) | (one.current == other.current)  # one of them may be in another unit
    return float(np.mean(same)) > SAME


def _causes(runs: Mapping[str, LabRun], choices: Sequence[Sequence[str]], rig: Rig) -> list[Undone]:
    """The smallest sets of mistakes without which nothing contradicts the first choice of recordings that has any."""
    mistakes = (*(mistake for mistake in MISTAKES if mistake.undo), *_scale(runs, rig))
    outcome = cache(lambda name, other, made: _outcome(name, runs[other], rig, made))
    possible = cache(
        lambda name, other, most, more: [*_options(partial(outcome, name, other), most, more, mistakes)],
    )
    for (most, mixed, more), names in product(TRIED, choices):
        found: list[tuple[int, Undone]] = []
        for order in permutations(names) if mixed else [names]:
            exchanged = {
                other: (Mistake(kind="files", words=f"the files look exchanged: it looks like {name}"),)
                for name, other in zip(names, order, strict=True)
                if name != other
            }
            options = [possible(name, other, most, more) for name, other in zip(names, order, strict=True)]
            for chosen in product(*options):
                if between({name: inertia for name, (_, inertia) in zip(names, chosen, strict=True)}):
                    continue
                undone = {
                    other: (*exchanged.get(other, ()), *made)
                    for other, (made, _) in zip(order, chosen, strict=True)
                    if made or other in exchanged
                }
                found.append((len({one.words for made in undone.values() for one in made}), undone))
        if found:
            fewest = min(count for count, _ in found)
            return [undone for count, undone in found if count == fewest]
    return []


def _scale(runs: Mapping[str, LabRun], rig: Rig) -> Iterator[Mistake]:
    """A scale of the current of its own, which the run-up's largest current determines, whatever power of 1000 it is
    in."""
    peak = rig.motor.peak_current
    if FASTEST in runs and peak is not None and (largest := float(runs[FASTEST].current.max())) > 0.0:
        factor = largest / peak / 1e3 ** round(math.log10(largest / peak) / 3.0)
        if 1.0 / SCALE < factor < SCALE and not FULL_CURRENT < factor < LARGEST_CURRENT:
            words = f"the current is {factor:.3g} times the drive's limit: correct its scale"
            yield Mistake(kind="amplitude", words=words, undo=scaled(current=1.0 / factor))


def _outcome(name: str, run: LabRun, rig: Rig, made: Sequence[Mistake]) -> tuple[bool, float | None]:
    """Whether a recording is sound by itself without these mistakes, and its J then - kg*m**2."""
    undone: LabRun | None = run
    for mistake in made:
        undone = mistake.undo(undone, rig) if undone is not None and mistake.undo else None
    sound = undone is not None and not fault(name, undone, rig)
    return sound, inertia_of(undone) if sound and undone is not None else None


def _options(
    outcome: Callable[[Sequence[Mistake]], tuple[bool, float | None]],
    most: int,
    more: bool,
    mistakes: Sequence[Mistake],
) -> Iterator[tuple[tuple[Mistake, ...], float | None]]:
    """Mistakes, at most so many, without which a recording is sound by itself, and its J without them - kg*m**2.

    No more than it asks for, or `more`.
    """
    found = False
    for count in range(most + 1):
        for chosen in combinations(mistakes, count):
            kinds = {mistake.kind for mistake in chosen}
            if len(kinds) < count:
                continue
            # which was made first makes a difference to exchanged columns alone
            for made in (chosen, chosen[::-1])[: 1 + (count > 1 and "columns" in kinds)]:
                sound, inertia = outcome(made)
                if sound:
                    found = True
                    yield made, inertia
                    break
        if found and count and not more:
            return
