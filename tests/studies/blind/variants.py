"""The policy with one number halved or doubled, or one rule or doubt off; numbers are read from the policy itself."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from pkgutil import resolve_name

from bench.diagnosis.doubts import DOUBTS, Doubt
from bench.diagnosis.policy import POLICY, Policy
from tests.diagnosis.off import undoubted, without

#: Shares and bounds that effects state of themselves: where each stands, and what it decides.
OF_EFFECTS = (
    ("bench.effects.effect:Effect", "needed", "share of what stands above the noise floor that an effect must explain"),
    ("bench.effects.effect", "PITCH_SHARE", "the same for a fine pitch of a linear axis"),
    ("bench.effects.effect", "MANY", "half cycles over the travel from which a pitch is fine"),
    ("bench.effects.load_torque_event:LoadTorqueEvent", "needed", "share that an event must explain"),
    ("bench.effects.load_torque_event", "RESOLVED", "filter widths that an event lasts at least"),
    ("bench.effects.load_torque_event", "LONGEST", "share of the recording that events last together at most"),
)
FACTORS = {"half": 0.5, "double": 2.0}
#: Numbers of the policy that only doubts ask, so that a search finds the same.
OF_DOUBTS = frozenset(
    {"holdout_apart", "overlap", "contested", "keeps", "wrong_form", "relatives_leave", "one_for_several"}
    | {"believable", "holdout_gap"}
)


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
    def of_doubts(self) -> bool:
        """Whether only doubts ask it, so that a search finds the same."""
        return self.name in OF_DOUBTS

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


def switched_off() -> dict[str, tuple[Policy, tuple[Doubt, ...]]]:
    """The policy and doubts without each of the rules and doubts without which a search ends all the same."""
    doubts = {doubt.__name__: (POLICY, undoubted(doubt)) for doubt in DOUBTS}
    return {"needs": (without("needs"), DOUBTS), **doubts}


def _documented(name: str) -> str:
    """What the policy's documentation says of one of its numbers, the first sentence of it."""
    text = inspect.cleandoc(Policy.__doc__ or "")
    found = re.search(rf"^    {name}: (.*(?:\n     +.*)*)", text, re.MULTILINE)
    return " ".join(found.group(1).split()).split(". ")[0].rstrip(".") if found else ""
