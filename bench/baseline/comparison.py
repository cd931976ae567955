"""One comparison of two states, and the answer to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from bench.comparison.difference import Difference

SAME, CHANGED, UNDECIDED = "same", "changed", "undecided"
#: From worst to best.
RESULTS = (CHANGED, UNDECIDED, SAME)


@dataclass(frozen=True)
class Comparison:
    """A quantity in two states.

    Attributes:
        name: of the quantity, or of the effect whose torque it is.
        unit: of all numbers.
        baseline, now: its values; None for an effect that is absent.
        differences: now less baseline: one, or one for each state's effects where these differ; () if unknown.
        margin: difference that does not matter - unit.
        effect: `appeared` or `gone` if it is about the presence of an effect; else empty.
        held_back: why it never raises an alarm; empty if it may.
        chance: probability of such a difference if the true one is within the margin; uncorrected.
        result: `same`, `changed` or `undecided`.
    """

    name: str
    unit: str
    baseline: float | None
    now: float | None
    differences: tuple[Difference, ...]
    margin: float
    effect: str = ""
    held_back: str = ""
    chance: float = 1.0
    result: str = UNDECIDED

    @classmethod
    def of(
        cls,
        name: str,
        unit: str,
        values: tuple[float | None, float | None],
        differences: Sequence[Difference],
        margin: float,
        effect: str = "",
        held_back: str = "",
        least_chance: float = 0.0,
    ) -> Comparison:
        """A comparison with its chance: the largest of its differences, if all have one sign.

        Args:
            name, unit, differences, margin, effect, held_back: as the attributes.
            values: in the baseline and now.
            least_chance: lower bound, of another quantity that has to differ too.
        """
        found = cls(name, unit, *values, tuple(differences), margin, effect, held_back)
        signs = {difference.value > 0.0 for difference in differences}
        if held_back or len(signs) != 1:
            return found
        return replace(found, chance=max(least_chance, *(difference.chance(margin) for difference in differences)))

    def answered(self, rejected: bool) -> Comparison:
        """With its result; `rejected`: whether the corrected test rejects that it is the same."""
        if rejected:
            return replace(self, result=CHANGED)
        may = self.differences and not self.held_back and self.effect != "appeared"
        shown = may and all(one.within(self.margin) for one in self.differences)
        return replace(self, result=SAME if shown else UNDECIDED)

    @property
    def difference(self) -> Difference | None:
        """The smallest of its differences."""
        return min(self.differences, key=lambda one: abs(one.value), default=None)

    @property
    def difference95(self) -> tuple[float, float] | None:
        """Interval of 95 % around all differences - unit."""
        bounds = [one.interval(0.95) for one in self.differences]
        return (min(low for low, _ in bounds), max(high for _, high in bounds)) if bounds else None
