"""The policy with one number off, halved or doubled; numbers are read from the policy itself."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from pkgutil import resolve_name

from bench.diagnosis.policy import POLICY, Policy

#: Shares and bounds that effects state of themselves: where each stands, and what it decides.
OF_EFFECTS = (
    (
        "bench.effects.backlash",
        "OF_YIELDING",
        "smallest gap that is named, over the deflection of its contact at the peak torque",
    ),
    ("bench.effects.load_torque_event", "RESOLVED", "shortest event that is named, in widths of the filter"),
    ("bench.effects.load_torque_event", "LONGEST", "largest share of the recording that events last together"),
)
FACTORS = {"off": 0.0, "half": 0.5, "double": 2.0}
#: Weights of the score: each may be zero.
WEIGHTS = frozenset({"remaining", "over", "number", "outside", "none", "with_unknown"})


@dataclass(frozen=True)
class Threshold:
    """A number that decides on names.

    Attributes:
        owner, name: policy, module or class that it stands in, and what it is called there.
        value: as is.
        decides: what, in the words of its documentation.
    """

    owner: str
    name: str
    value: float
    decides: str

    @property
    def weighs(self) -> bool:
        """Whether it is a weight of the score."""
        return self.name in WEIGHTS

    @property
    def factors(self) -> dict[str, float]:
        """By what it is multiplied: without a weight a search ends all the same, without a bound it may not."""
        return FACTORS if self.weighs else {name: factor for name, factor in FACTORS.items() if factor}

    @contextmanager
    def times(self, factor: float) -> Iterator[Policy]:
        """The policy with the threshold so many times what it is; a whole number stays one."""
        value = type(self.value)(self.value * factor)
        if self.owner == "Policy":
            yield replace(POLICY, **{self.name: value})
            return
        owner = resolve_name(self.owner)
        setattr(owner, self.name, value)
        try:
            yield POLICY
        finally:
            setattr(owner, self.name, self.value)


def thresholds() -> list[Threshold]:
    """Those of the policy in its order, then those of effects."""
    found = [
        Threshold("Policy", field.name, getattr(POLICY, field.name), _documented(field.name))
        for field in fields(POLICY)
    ]
    return found + [
        Threshold(owner, name, getattr(resolve_name(owner), name), decides) for owner, name, decides in OF_EFFECTS
    ]


def _documented(name: str) -> str:
    """What the policy's documentation says of one of its numbers, the first sentence of it."""
    text = inspect.cleandoc(Policy.__doc__ or "")
    found = re.search(rf"^    (?:\w+, )*{name}(?:, \w+)*: (.*(?:\n     +.*)*)", text, re.MULTILINE)
    return " ".join(found.group(1).split()).split(". ")[0].rstrip(".") if found else ""
