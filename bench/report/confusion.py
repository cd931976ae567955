"""Which names are given for what is hidden, as a matrix."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.names import words
from bench.validation.naming import NOTHING, NOTHING_MISSING


@dataclass(frozen=True)
class Confusion:
    """Counts of what is said, of runs with one effect hidden or none.

    Attributes:
        hidden: in words, a row each.
        said: in words, a column each: first the right answers, in the order of the rows, then what else is said.
        counts: of it (rows, columns); a run may be given several names.
    """

    hidden: tuple[str, ...]
    said: tuple[str, ...]
    counts: NDArray[np.int64]

    @classmethod
    def of(cls, confusion: Mapping[str, Mapping[str, int]]) -> Confusion:
        """Matrix of counts by what is hidden and what is said."""
        answers = [NOTHING_MISSING if name == NOTHING else name for name in confusion]
        columns = [*answers, *sorted({name for counts in confusion.values() for name in counts} - set(answers))]
        counts = np.array([[row.get(name, 0) for name in columns] for row in confusion.values()], dtype=np.int64)
        rows, said = (tuple(map(words, names)) for names in (confusion, columns))
        return cls(rows, said, counts.reshape(len(rows), len(said)))

    @property
    def shares(self) -> NDArray[np.float64]:
        """Of all that is said in a row (rows, columns)."""
        return self.counts / np.maximum(self.counts.sum(axis=1, keepdims=True), 1)
