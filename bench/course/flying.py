"""Whether a catapult's experiments are flights of one throw: each falls, its points lie on a path, the paths are alike.

What does not is named with the mistake without which it would: axes exchanged, another unit, mirrored, one point off.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

import numpy as np

from bench.arrays import Array, rms

#: A point is off by so many times the usual distance from its path, a flight's path by so many from the others'. Of
#: 200,000 tens of simulated flights, each with its scatter of the launch, the furthest were 6.9 and 15.3 times.
POINT, PATH = 7.0, 16.0
#: However much paths scatter, those of one throw are not further from their middle than this share of their height.
APART = 0.5
#: A flight has at least so many points more than its parabola has coefficients.
SPARE = 3
MISTAKES: dict[str, Callable[[Array], Array]] = {
    "its y and z are exchanged": lambda flight: flight[:, ::-1],
    "it is in mm where the others are in m": lambda flight: flight * 1e-3,
    "it is in cm where the others are in m": lambda flight: flight * 1e-2,
    "it is in m where the others are in mm": lambda flight: flight * 1e3,
    "it is in m where the others are in cm": lambda flight: flight * 1e2,
    "its y is counted the other way": lambda flight: flight * [-1.0, 1.0],
    "its z is counted the other way": lambda flight: flight * [1.0, -1.0],
}


def contradiction(flights: Sequence[Array]) -> str:
    """What no flights of one throw - (n, 2) y, z in m - can show, and why; empty where all can be."""
    if any(len(flight) < 3 + SPARE for flight in flights):
        return ""
    for (j, one), (k, other) in combinations(enumerate(flights, 1), 2):
        if np.array_equal(one, other):
            return f"flights {j} and {k} are one and the same"
    wrong = list(_wrong(flights))
    if not wrong:
        return ""
    faults = [f"flight {k + 1} {found}: {_why(flights, k)}" for k, found in wrong]
    turned = [flight[:, ::-1] for flight in flights]
    if len(wrong) > len(flights) // 2:
        return "y and z of all flights look exchanged" if not [*_wrong(turned)] else f"most flights: {faults[0]}"
    return "; ".join(faults)


def _wrong(flights: Sequence[Array]) -> Iterator[tuple[int, str]]:
    """Flights that are no such, and what is wrong with them."""
    paths = [np.polyfit(flight[:, 0], flight[:, 1], 2) for flight in flights]
    off = [flight[:, 1] - np.polyval(path, flight[:, 0]) for flight, path in zip(flights, paths, strict=True)]
    usual = float(np.median([rms(one) for one in off]))
    middle = np.median(paths, axis=0)
    beside = [np.polyval(path - middle, flight[:, 0]) for flight, path in zip(flights, paths, strict=True)]
    apart = [float(np.sqrt(np.mean(one**2))) for one in beside]
    alike = max(float(np.median(apart)), usual)
    for k, path in enumerate(paths):
        if path[0] >= 0.0:
            yield k, f"does not fall, its a is {path[0]:+.3g} 1/m"
        elif np.abs(off[k]).max() > POINT * usual:
            yield k, f"has a point {np.abs(off[k]).max():.2g} m off its path, {usual:.2g} m are usual"
        elif apart[k] > min(PATH * alike, APART * np.ptp(flights[k][:, 1])):
            yield k, f"is {apart[k]:.2g} m off the path of the others, {alike:.2g} m are usual"
        elif usual > 0.1 * np.ptp(flights[k][:, 1]):
            yield k, f"has points {usual:.2g} m off its path, which itself spans {np.ptp(flights[k][:, 1]):.2g} m"


def _why(flights: Sequence[Array], k: int) -> str:
    """The mistake without which flight k is like the others."""
    flight, others = flights[k], [one for j, one in enumerate(flights) if j != k]
    for words, undo in MISTAKES.items():
        if not [found for found in _wrong([*others, undo(flight)]) if found[0] == len(others)]:
            return words
    for j in range(len(flight)):
        rest = np.delete(flight, j, axis=0)
        if not [found for found in _wrong([*others, rest]) if found[0] == len(others)]:
            y, z = flight[j].tolist()
            return f"its point {j + 1}, ({y:.4g}, {z:.4g}) m, is an outlier"
    return "no known mistake explains it"
