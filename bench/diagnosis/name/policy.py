"""The policy: all that decides on a name. What its rules are and why: `rules` and `doubts`, one object each."""

from __future__ import annotations

from dataclasses import dataclass

from bench.diagnosis.name.doubts import DOUBTS, Doubt
from bench.diagnosis.name.rules import Rules


@dataclass(frozen=True)
class Policy(Rules):
    """The rules of the search, then the doubts of what it found.

    Attributes:
        doubts: in the order in which they are raised.
    """

    doubts: tuple[Doubt, ...] = DOUBTS
