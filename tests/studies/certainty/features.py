"""What speaks for each hypothesis about cases whose truth is known, and which of the hypotheses are right."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.diagnosis.policy import POLICY
from bench.diagnosis.probability import standing, weighed
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.search import search
from bench.effects.catalogue import catalogue
from bench.errors import BenchError
from bench.rig.rig import load_rig
from bench.trace.read import read
from tests.studies.blind.score import same, twins


@dataclass(frozen=True)
class Hypothesis:
    """A set of names and what `bench.diagnosis.probability` says of it.

    Attributes:
        standing: of the names beside an effect from outside the catalogue those that it cannot make up for.
    """

    names: tuple[str, ...]
    remaining: float
    over: float
    below: float
    numbers: int
    outside: bool
    standing: tuple[str, ...] = ()

    @property
    def there(self) -> tuple[str, ...]:
        """Names that are there if it is right."""
        return self.standing if self.outside else self.names


@dataclass(frozen=True)
class Known:
    """A case with its hypotheses.

    Attributes:
        name, group: of the case.
        truth: what is hidden and has to be found in the torque balance; None: it is not in the catalogue.
        own: names that the recording had before anything was put into it, right or wrong.
        detected: names that the signals show directly.
        hypotheses: the first one is the bare axis.
    """

    name: str
    group: str
    truth: tuple[str, ...] | None
    own: tuple[str, ...]
    detected: tuple[str, ...]
    hypotheses: tuple[Hypothesis, ...]

    def right(self, one: Hypothesis) -> bool:
        """Whether a hypothesis has the names that are true, and no other."""
        if self.truth is None or one.outside:
            return False
        found, hidden = same(one.names), same(self.truth)
        return hidden <= found and found - hidden <= same(self.own)

    def true(self, name: str) -> bool:
        """Whether a name is."""
        return twins(name) in same((*(self.truth or ()), *self.own))

    @property
    def reachable(self) -> bool:
        """Whether the right answer is among those that are weighed."""
        return self.truth is None or any(map(self.right, self.hypotheses))


def known(folder: Path, withheld: bool) -> Known | None:
    """A case's hypotheses, by its first recording; None if it is refused.

    Args:
        folder: with run1, rig.toml and truth.json.
        withheld: whether what is hidden is taken out of the catalogue.
    """
    of_case = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    excluded = frozenset().union(*(twins(name) for name in of_case["effects"])) if withheld else frozenset()
    rig = load_rig(folder / "rig.toml")
    try:
        recordings = Recordings.of(read(folder / "run1.csv.gz", rig.trace), rig, None)
    except BenchError:
        return None
    effects = [effect for name, effect in catalogue().items() if name not in excluded]
    searched = search(fit_bare(recordings.rows), effects, POLICY)
    hypotheses = [
        Hypothesis(
            one.fitted.hypothesis.names,
            one.remaining,
            one.over,
            one.below,
            one.numbers,
            one.outside,
            tuple(effect.name for effect in standing(one.fitted, POLICY)) if one.outside else (),
        )
        for one in weighed(searched.visited, None, POLICY)
    ]
    detected = {effect.name for effect in recordings.detected}
    truth = tuple(name for name in of_case["effects"] if name not in detected and name != "voltage_limit")
    lacking = withheld or of_case["group"] == "outside"
    group = f"{of_case['group']}, truth withheld" if withheld else of_case["group"]
    # what is detected is not looked for in the balance, and is right where it is hidden
    own = (*of_case.get("own", ()), *detected.intersection(of_case["effects"]))
    return Known(folder.name, group, None if lacking else truth, own, (*sorted(detected),), tuple(hypotheses))


def kept(path: Path) -> list[Known]:
    """Cases of a file."""

    def case(content: dict[str, Any]) -> Known:
        every = tuple(
            Hypothesis(**each | {key: tuple(each[key]) for key in ("names", "standing")})
            for each in content.pop("hypotheses")
        )
        truth, own, detected = content.pop("truth"), tuple(content.pop("own")), tuple(content.pop("detected"))
        truth = None if truth is None else tuple(truth)
        return Known(**content, truth=truth, own=own, detected=detected, hypotheses=every)

    return [case(content) for content in json.loads(path.read_text(encoding="utf-8"))]


def folders(sets: Sequence[Path]) -> list[Path]:
    """Cases of sets, in order."""
    return [path.parent for home in sets for path in sorted(home.glob("*/truth.json"))]
