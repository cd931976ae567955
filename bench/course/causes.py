"""Why a recording cannot be of the lab's axis: known mistakes are undone on it until nothing contradicts it any more.

The fewest mistakes that do are the cause; where several would, all are named, and where none does, none is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations, permutations, product

import numpy as np

from bench.course.axis import RPM
from bench.course.plausible import (
    DISK,
    FASTEST,
    FULL_CURRENT,
    LARGEST_CURRENT,
    LATE,
    balance,
    between,
    fault,
    glitches,
    holes,
    inertia_of,
)
from bench.course.run import LabRun, made_run
from bench.rig.rig import Rig

DEG = math.pi / 180.0
#: Causes that are named of one recording; more are none.
NAMED = 3
#: Between this and its inverse a factor on the current is no unit, and below √2.
SCALE = 1.38
#: Share of samples that two recordings of one motion never have in common.
SAME = 0.9
#: What is tried, until it explains: mistakes in a recording at most, whether files are exchanged, and whether more than
#: the least that a recording asks for are tried, as the others may ask for them.
TRIED = ((1, False, False), (1, True, False), (2, False, False), (2, True, False), (2, False, True), (3, False, False))
#: Rounds in which a delay is searched, as a long one is not linear.
ROUNDS = 6
TURN = 'turn one of them by a rig.toml beside it with [trace.columns] current = "-name of its column [unit]"'
UNEXPLAINED = "no known mistake explains it: look at its signals"
OTHER_DISK = (
    "no known mistake explains it: if another disk turns, give it in a rig.toml next to the recordings, "
    '[load] and below it moment_of_inertia = "30 kg*cm**2", or outer_diameter, inner_diameter, thickness and density'
)
TOGETHER = "record both in one task of the drive"


@dataclass(frozen=True)
class KnownMistake:
    """A mistake in a recording.

    Attributes:
        kind: of two of a kind only one can have been made.
        words: what is wrong, and what to do.
        undo: gives the recording without it; None where it cannot have been made.
    """

    kind: str
    words: str
    undo: Callable[[LabRun, Rig], LabRun | None]


#: Recordings by name, and what was undone in each.
Undone = dict[str, tuple[KnownMistake, ...]]


def _scaled(velocity: float = 1.0, current: float = 1.0, period: float = 1.0) -> Callable[[LabRun, Rig], LabRun]:
    def undo(run: LabRun, rig: Rig) -> LabRun:
        return made_run(run.velocity * velocity, run.current * current, run.sample_period * period, rig)

    return undo


def _speed(is_in: str, labelled: str, factor: float) -> KnownMistake:
    words = f"the speed looks like {is_in} that is labelled {labelled}: correct its unit"
    return KnownMistake("speed", words, _scaled(velocity=factor))


def _in_time(run: LabRun, rig: Rig) -> LabRun | None:
    """With the current set back by as many samples as it is late."""
    late = 0
    for _ in range(ROUNDS):
        size = run.time.size - abs(late)
        velocity, current = run.velocity[max(-late, 0) :][:size], run.current[max(late, 0) :][:size]
        shifted = made_run(velocity, current, run.sample_period, rig)
        found = balance(shifted)
        if found is None or abs(found.late) <= LATE:
            return shifted if late and found is not None else None
        late += round(found.late) or int(math.copysign(1, found.late))
        if abs(late) > run.time.size // 4:
            return None
    return None


def _without_glitches(run: LabRun, rig: Rig) -> LabRun | None:
    """With samples that stand alone replaced by the line through their neighbours."""
    alone = (run.velocity, glitches(run.velocity, smooth=True)), (run.current, glitches(run.current, smooth=False))
    if not any(places.size for _, places in alone):
        return None
    velocity, current = (
        np.interp(run.time, np.delete(run.time, places), np.delete(values, places)) for values, places in alone
    )
    return made_run(velocity, current, run.sample_period, rig)


def _columns_swapped(run: LabRun, rig: Rig, speed: float = 1.0, ampere: float = 1.0) -> LabRun:
    """With the numbers of speed and current exchanged, as both were written in units worth so much in SI."""
    return made_run(run.current / ampere * speed, run.velocity / speed * ampere, run.sample_period, rig)


MISTAKES = (
    KnownMistake("columns", "the columns of speed and current look exchanged", _columns_swapped),
    KnownMistake(
        "columns",
        "the columns of speed (deg/s) and current (mA) look exchanged",
        lambda run, rig: _columns_swapped(run, rig, DEG, 1e-3),
    ),
    _speed("deg/s", "rad/s", DEG),
    _speed("rad/s", "deg/s", 1.0 / DEG),
    _speed("rpm", "rad/s", 1.0 / RPM),
    _speed("rad/s", "rpm", RPM),
    _speed("deg/s", "rpm", DEG * RPM),
    _speed("rpm", "deg/s", 1.0 / DEG / RPM),
    _speed("turns/s", "rad/s", 2.0 * math.pi),
    _speed("rad/s", "turns/s", 0.5 / math.pi),
    KnownMistake("current", "the current looks like mA that is labelled A: correct its unit", _scaled(current=1e-3)),
    KnownMistake("current", "the current looks like A that is labelled mA: correct its unit", _scaled(current=1e3)),
    KnownMistake(
        "amplitude",
        "the current looks like a peak value where kT takes the RMS value, √2 times too large: divide it by √2",
        _scaled(current=math.sqrt(0.5)),
    ),
    KnownMistake("amplitude", "the current looks √2 times too small: multiply it by √2", _scaled(current=math.sqrt(2))),
    KnownMistake("sign", f"current and speed are counted in opposite directions: {TURN}", _scaled(current=-1.0)),
    KnownMistake("time", "the times look like ms that are labelled s: correct their unit", _scaled(period=1e-3)),
    KnownMistake("time", "the times look like s that are labelled ms: correct their unit", _scaled(period=1e3)),
    KnownMistake("delay", f"current and speed are not of the same instants: {TOGETHER}", _in_time),
    KnownMistake("glitch", "a glitch: take these samples out, or record again", _without_glitches),
)


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
    mistakes = (*MISTAKES, *_scale(runs, rig))
    possible = cache(lambda name, other, most, more: [*_options(name, runs[other], rig, most, more, mistakes)])
    for (most, mixed, more), names in product(TRIED, choices):
        found: list[tuple[int, Undone]] = []
        for order in permutations(names) if mixed else [names]:
            exchanged = {
                other: (KnownMistake("files", f"the files look exchanged: it looks like {name}", lambda run, rig: run),)
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


def _scale(runs: Mapping[str, LabRun], rig: Rig) -> Iterator[KnownMistake]:
    """A scale of the current of its own, which the run-up's largest current tells, whatever power of 1000 it is in."""
    peak = rig.motor.peak_current
    if FASTEST in runs and peak is not None and (largest := float(runs[FASTEST].current.max())) > 0.0:
        factor = largest / peak / 1e3 ** round(math.log10(largest / peak) / 3.0)
        if 1.0 / SCALE < factor < SCALE and not FULL_CURRENT < factor < LARGEST_CURRENT:
            words = f"the current is {factor:.3g} times what the drive's limit says: correct its scale"
            yield KnownMistake("amplitude", words, _scaled(current=1.0 / factor))


def _options(
    name: str, run: LabRun, rig: Rig, most: int, more: bool, mistakes: Sequence[KnownMistake]
) -> Iterator[tuple[tuple[KnownMistake, ...], float | None]]:
    """Mistakes, at most so many, without which a recording is sound by itself, and its J without them - kg*m**2.

    No more than it asks for, or `more`.
    """
    sound = False
    for count in range(most + 1):
        for chosen in combinations(mistakes, count):
            kinds = {mistake.kind for mistake in chosen}
            if len(kinds) < count:
                continue
            # which was made first makes a difference to exchanged columns alone
            for made in (chosen, chosen[::-1])[: 1 + (count > 1 and "columns" in kinds)]:
                undone: LabRun | None = run
                for mistake in made:
                    undone = mistake.undo(undone, rig) if undone is not None else None
                if undone is not None and not fault(name, undone, rig):
                    sound = True
                    yield made, inertia_of(undone)
                    break
        if sound and count and not more:
            return
