"""Which effects a run hides: none, so many of the catalogue, or each of some names in turn."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.names import nearest
from bench.validation.independent.draw import any_effects
from bench.validation.independent.effects import KINDS
from bench.validation.independent.rig import Axis

#: Names that can be hidden: those that the independent axis has too.
HIDEABLE = tuple(name for name in KINDS if name in catalogue())
#: Effects at most in one axis.
MOST = 6
COUNTS = re.compile(r"(\d+)(?:-(\d+))?")


@dataclass(frozen=True)
class Hiding:
    """What is hidden.

    Attributes:
        least, most: how many of the catalogue, drawn at random.
        names: instead, each alone in turn, and after the last of them a run with nothing hidden.
    """

    least: int = 0
    most: int = 0
    names: tuple[str, ...] = ()

    @classmethod
    def parse(cls, text: str) -> Hiding:
        """`2`, `0-3`, `all`, or names separated by commas.

        Raises:
            InputError: none of these.
        """
        counts = COUNTS.fullmatch(text.strip())
        if counts:
            least = int(counts[1])
            most = int(counts[2] or least)
            if not least <= most <= MOST:
                raise InputError("--effects", f"found {text}", f"allowed: 0 to {MOST}, the smaller number first")
            return cls(least, most)
        names = HIDEABLE if text.strip() == "all" else tuple(name.strip() for name in text.split(","))
        for name in names:
            if name not in HIDEABLE:
                found = f"found '{name}'{nearest(name, list(HIDEABLE))}"
                raise InputError("--effects", found, f"allowed: a count as 0-3, all, or some of {', '.join(HIDEABLE)}")
        return cls(names=names)

    @property
    def anything(self) -> bool:
        """Whether any run hides an effect."""
        return self.most > 0 or bool(self.names)

    def drawn(self, index: int, rng: np.random.Generator, axis: Axis) -> tuple[str, ...]:
        """Names hidden in a run, of those that the axis can have.

        Args:
            index: of the run.
            rng: of the run.
            axis: of the run.
        """
        impossible = frozenset(name for name in HIDEABLE if not KINDS[name].possible(axis))
        if self.names:
            place = index % (len(self.names) + 1)
            return tuple(name for name in self.names[place : place + 1] if name not in impossible)
        return any_effects(int(rng.integers(self.least, self.most + 1)), rng, without=impossible)
