"""Check recordings of one axis against each other, and count the answers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from scipy.stats import binomtest, norm

from bench.baseline.check import FALSE_ALARM_RATE, Allowed, Checked, compare
from bench.baseline.observe import Observed, observe
from bench.errors import BenchError
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Chance at which a recording that allows a detection makes it.
POWER = 0.95
#: A recording shows a new effect if its torque stands so many noises above what J, K_w and K_0 explain.
SHOWN = 1.5


@dataclass
class Answers:
    """Answers to checks of one kind.

    Attributes:
        results: how often each, `refused` among them.
        allowed: checks whose recordings allow a detection, and how many of them detect.
        alarms: what was called changed, by its name.
    """

    results: Counter[str] = field(default_factory=Counter)
    allowed: Counter[bool] = field(default_factory=Counter)
    alarms: Counter[str] = field(default_factory=Counter)

    def add(self, checked: Checked | None, allows: bool = False, what: str = "") -> None:
        """One more check; None where a recording was refused.

        Args:
            checked: its answer.
            allows: whether the recording allows to detect the change.
            what: has changed: its name, or the beginning of it.
        """
        self.results[checked.result if checked is not None else "refused"] += 1
        if checked is None:
            return
        changed = [one.name for one in checked.comparisons if one.result == "changed"]
        self.alarms.update(changed)
        if allows:
            self.allowed[any(name.startswith(what) for name in changed)] += 1

    @property
    def answered(self) -> int:
        """Checks that were not refused."""
        return sum(self.results.values()) - self.results["refused"]

    def bounds(self, result: str) -> tuple[float, float]:
        """Clopper and Pearson's 95 % interval of how often a result comes."""
        found = binomtest(self.results[result], max(self.answered, 1)).proportion_ci(0.95, "exact")
        return float(found.low), float(found.high)

    def detected(self) -> tuple[int, int, float, float]:
        """Detections, recordings that allow them, and the same interval of their share."""
        count = sum(self.allowed.values())
        found = binomtest(self.allowed[True], max(count, 1)).proportion_ci(0.95, "exact")
        return self.allowed[True], count, float(found.low), float(found.high)


def observed(traces: Sequence[Trace], rig: Rig, names: bool) -> Observed | None:
    """The state of an axis; None where its recordings are refused."""
    try:
        return observe(traces, rig, names)
    except BenchError:
        return None


def answer(baseline: Observed | None, now: Observed | None, rig: Rig) -> Checked | None:
    """The check; None where one of the states is not to be had."""
    if baseline is None or now is None:
        return None
    return compare(baseline.state, now, Allowed.of(rig), FALSE_ALARM_RATE)


def allows(checked: Checked | None, name: str, share: float) -> bool:
    """Whether errors and spreads let a change of a quantity by a share be found, were each as it is stated."""
    if checked is None:
        return False
    one = next(one for one in checked.comparisons if one.name == name)
    assert one.baseline is not None
    difference = one.difference
    assert difference is not None
    reach = norm.isf(FALSE_ALARM_RATE / checked.family / 2.0) + norm.isf(1.0 - POWER)
    return share * abs(one.baseline) - one.margin > reach * difference.std_error
