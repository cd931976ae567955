"""The difference of two states in one quantity, and the tests on it.

    D = now - baseline ~ t(degrees) with variance  s_n**2/k_n + s_b**2/k_b + tau**2*(1/k_n + 1/k_b)

s - standard error of one recording; tau - additional standard deviation between recordings; k - number of recordings;
n, b - now and baseline. This is the prediction interval of the next recording (G. J. Hahn, W. Q. Meeker, Statistical
Intervals, 1991, section 4.7): with one recording now it is 1 + 1/k_b times the variance of one. The degrees of freedom
of the sum are Satterthwaite's (Biometrics Bulletin 2, 1946, 110-114).

Against a margin m there are three answers:

- same: the interval of 90 % lies within (-m, m). Two one-sided tests at 5 % (D. J. Schuirmann, J. Pharmacokinetics and
  Biopharmaceutics 15, 1987, 657-680); that all quantities are the same is shown at 5 % without a correction, as
  each one has to be (R. L. Berger, Technometrics 24, 1982, 295-300).
- changed: |D| exceeds m; its probability if the true |D| <= m is at most `Difference.chance(m)`, which `holm` corrects
  for the number of comparisons.
- undecided: neither.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its special functions load when first used: 0.2 s

from bench.arrays import Array
from bench.parameter import Parameter

#: Recordings in a baseline from which the spread is theirs alone: at 4 degrees of freedom, 30 comparisons and 1 % an
#: interval is 10 standard deviations wide, at 2 it is 55.
ENOUGH = 5
#: Probability that a quantity that differs by more than its margin is called the same.
NOT_EQUIVALENT = 0.05
SAME, CHANGED, UNDECIDED = "same", "changed", "undecided"
#: From worst to best.
RESULTS = (CHANGED, UNDECIDED, SAME)


@dataclass(frozen=True)
class Measured:
    """A quantity in one state of an axis.

    Attributes:
        value: in `unit`.
        unit: SI.
        std_error: standard error of one such recording from its own noise; 0 if exact - unit.
        degrees: of freedom of this error; inf if it is known.
        recordings: number of recordings that determine the quantity alone.
        spread: standard deviation of their estimates, own errors included; None for fewer than two - unit.
        each: these estimates, in the order of the recordings; () for fewer than two - unit.
    """

    value: float
    unit: str
    std_error: float = 0.0
    degrees: float = math.inf
    recordings: int = 1
    spread: float | None = None
    each: tuple[float, ...] = ()

    @classmethod
    def of(cls, found: Parameter, alone: Sequence[Parameter] = ()) -> Measured:
        """From a quantity with its interval, and from its estimates by each of several recordings alone.

        Of several recordings the error is the root mean square of theirs.
        """
        known = [one for one in alone if math.isfinite(one.std_error)]
        if len(known) < 2:
            return cls(found.value, found.unit, found.std_error, found.degrees)
        error = float(np.sqrt(np.mean([one.std_error**2 for one in known])))
        each = tuple(one.value for one in known)
        spread = float(np.std(each, ddof=1))
        return cls(found.value, found.unit, error, min(one.degrees for one in known), len(known), spread, each)


@dataclass(frozen=True)
class Difference:
    """Now less baseline, in the quantity's unit or as a share of the baseline.

    Attributes:
        value, std_error: of the difference; both in the same unit, or both dimensionless.
        degrees: of freedom.
    """

    value: float
    std_error: float
    degrees: float = math.inf

    @classmethod
    def of(cls, baseline: Measured, now: Measured, between: float, known: float = 0.0) -> Difference:
        """Difference of a quantity in both states, with the variance above.

        `between`: stated standard deviation between recordings - unit; `known`: that of a known difference of the
        states, such as their motion - unit.
        """
        parts = [(now.std_error**2 / now.recordings, now.degrees)]
        shares = 1.0 / now.recordings + 1.0 / baseline.recordings
        if baseline.spread is not None and baseline.recordings >= ENOUGH:
            total = baseline.spread**2  # own errors included
            more = max(0.0, now.std_error**2 - baseline.std_error**2) / now.recordings
            parts = [(total * shares, baseline.recordings - 1.0), (more, now.degrees)]
        else:
            shown = math.sqrt(max(0.0, (baseline.spread or 0.0) ** 2 - baseline.std_error**2))
            parts += [(baseline.std_error**2 / baseline.recordings, baseline.degrees)]
            parts += [(max(between, shown) ** 2 * shares, math.inf)]
        parts += [(2.0 * known**2, math.inf)]
        variance = sum(part for part, _ in parts)
        shakiness = sum(part**2 / degrees for part, degrees in parts)
        degrees = variance**2 / shakiness if shakiness > 0.0 else math.inf
        return cls(now.value - baseline.value, math.sqrt(variance), degrees)

    @classmethod
    def relative(cls, baseline: Parameter, now: Parameter) -> Difference:
        """now/baseline - 1, of a baseline above zero, with the error that both pass on to it."""
        ratio = now.value / baseline.value
        error = float(np.hypot(baseline.std_error * ratio, now.std_error)) / baseline.value
        return cls(ratio - 1.0, error)

    def interval(self, level: float) -> tuple[float, float]:
        """Interval that contains the true difference with probability `level` - unit."""
        reach = float(scipy.special.stdtrit(self.degrees, 0.5 * (1.0 + level))) * self.std_error
        return self.value - reach, self.value + reach

    def within(self, margin: float) -> bool:
        """Whether the difference is shown to be smaller than a margin."""
        low, high = self.interval(1.0 - 2.0 * NOT_EQUIVALENT)
        return -margin < low and high < margin

    def outside(self, low: float, high: float, errors: float) -> bool:
        """Whether it lies outside of a range, however so many standard errors turn out."""
        reach = errors * self.std_error
        return not low - reach < self.value < high + reach

    def chance(self, margin: float) -> float:
        """Probability of a difference this large, in either direction, if the true one is within a margin."""
        if self.std_error == 0.0:
            return float(abs(self.value) <= margin)
        sides = ((abs(self.value) + side * margin) / self.std_error for side in (-1.0, 1.0))
        return min(1.0, sum(float(scipy.special.stdtr(self.degrees, -side)) for side in sides))


@dataclass(frozen=True)
class Comparison:
    """A quantity in two states, and the answer to whether it changed.

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

    def tested(self, least_chance: float = 0.0) -> Comparison:
        """With its chance: the largest of its differences, if all have one sign and it may alarm; at least so much."""
        signs = {difference.value > 0.0 for difference in self.differences}
        if self.held_back or len(signs) != 1:
            return self
        chances = (difference.chance(self.margin) for difference in self.differences)
        return replace(self, chance=max(least_chance, *chances))

    def answered(self, rejected: bool) -> Comparison:
        """With its result; `rejected`: whether the corrected test rejects that it is the same."""
        if rejected:
            return replace(self, result=CHANGED)
        may = self.differences and not self.held_back and self.effect != "appeared"
        shown = may and all(one.within(self.margin) for one in self.differences)
        return replace(self, result=SAME if shown else UNDECIDED)

    @property
    def reason(self) -> str:
        """Why it is undecided; empty if it is not."""
        difference, bounds = self.difference, self.difference95
        if self.held_back or self.result != UNDECIDED or difference is None or bounds is None:
            return self.held_back
        if len({each.value > 0.0 for each in self.differences}) > 1:
            return "the effects of the baseline and those of now give differences of opposite sign"
        if max(each.chance(self.margin) for each in self.differences) < self.chance:
            return "stronger noise may explain the difference"
        known = f"{0.5 * (bounds[1] - bounds[0]):.2g} {self.unit}".removesuffix(" dimensionless")
        if self.margin <= 0.0 or abs(difference.value) <= self.margin:
            return f"the difference is known to ± {known} only, so it may exceed the margin"
        times = f"{abs(difference.value) / self.margin:.2g} margins, but it is known to ± {known} only"
        return f"the difference is {times}: too uncertain for an alarm at this false-alarm rate"

    @property
    def difference(self) -> Difference | None:
        """The smallest of its differences."""
        return min(self.differences, key=lambda one: abs(one.value), default=None)

    @property
    def difference95(self) -> tuple[float, float] | None:
        """Interval of 95 % around all differences - unit."""
        bounds = [one.interval(0.95) for one in self.differences]
        return (min(low for low, _ in bounds), max(high for _, high in bounds)) if bounds else None


def holm(chances: Array, silent: int = 0) -> Array:
    """Chances (n,) of several tests so raised that each one below a rate alarms falsely at that rate for all together.

    S. Holm, Scandinavian Journal of Statistics 6(2), 1979, 65-70; however they depend on each other. `silent`: tests
    that were made too and cannot alarm.
    """
    order = np.argsort(chances, kind="stable")
    raised = (chances.size + silent - np.arange(chances.size)) * chances[order]
    found = np.empty_like(chances)
    found[order] = np.minimum(np.maximum.accumulate(raised), 1.0)
    return found
