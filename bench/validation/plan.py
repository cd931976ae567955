"""What is to be run, and the case of each index."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bench.validation.case import AnyAxis, Case, Population, hide
from bench.validation.hiding import Hiding


@dataclass(frozen=True)
class Plan:
    """A Monte Carlo; run k depends on the seed, k and what is drawn from, and on nothing else.

    Attributes:
        seed: of all that is random.
        hiding: effects of the runs.
        diagnose: whether `diagnose` is asked too, and not `identify` alone.
        population: that cases are drawn from.
    """

    seed: int = 0
    hiding: Hiding = field(default_factory=Hiding)
    diagnose: bool = False
    population: Population = field(default_factory=AnyAxis)

    def case(self, index: int) -> Case:
        """The case of an index."""
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(index,)))
        plain = self.population.plain(index, rng)
        return hide(plain, self.hiding.drawn(index, rng, plain.axis), rng)
