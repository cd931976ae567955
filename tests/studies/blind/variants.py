"""The policy with one threshold halved or doubled, or one rule off; thresholds are read from the rules themselves."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from bench.diagnosis.name.policy import Policy
from tests.diagnosis.off import OFF, without

#: Shares and bounds that effects state of themselves: where each stands, and what it decides.
OF_EFFECTS = (
    ("bench.effects.effect", "SHARE", "share of what stands above the noise floor that an effect must explain"),
    ("bench.effects.effect", "PITCH_SHARE", "the same for a fine pitch of a linear axis"),
    ("bench.effects.effect", "MANY", "half cycles over the travel from which a pitch is fine"),
    ("bench.effects.load_torque_event", "NEEDED", "share that an event must explain"),
    ("bench.effects.load_torque_event", "RESOLVED", "filter widths that an event lasts at least"),
    ("bench.effects.load_torque_event", "LONGEST", "share of the recording that events last together at most"),
)
FACTORS = {"half": 0.5, "double": 2.0}
#: Rules without which a search ends all the same.
SWITCHED = tuple(kind for kind, (method, _) in OFF.items() if method == "left" or kind.__name__ in ("NoLongerNeeded",))


@dataclass(frozen=True)
class Threshold:
    """A number that decides on names.

    Attributes:
        owner, name: rule or module that it stands in, and what it is called there.
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
        return self.owner in {type(doubt).__name__ for doubt in Policy().doubts}

    @contextmanager
    def times(self, factor: float) -> Iterator[Policy]:
        """The policy with the threshold so many times what it is; a whole number stays one."""
        value = type(self.value)(self.value * factor)
        if "." not in self.owner:
            yield _with(Policy(), self.owner, self.name, value)
            return
        module = importlib.import_module(self.owner)
        setattr(module, self.name, value)
        try:
            yield Policy()
        finally:
            setattr(module, self.name, self.value)


def thresholds() -> list[Threshold]:
    """Those of the policy in its order, then those of effects."""
    policy = Policy()
    parts = [getattr(policy, field.name) for field in fields(policy) if field.name != "doubts"]
    found = [
        Threshold(type(part).__name__, field.name, getattr(part, field.name), _told(part, field.name))
        for part in (*parts, *policy.doubts)
        if is_dataclass(part)
        for field in fields(part)
    ]
    found.append(Threshold("Policy", "most", policy.most, "effects at most; a family of harmonics is one of them"))
    stated = [(name, key, getattr(importlib.import_module(name), key), told) for name, key, told in OF_EFFECTS]
    return found + [Threshold(*each) for each in stated]


def switched_off() -> dict[str, Policy]:
    """The policy with each of the rules off that can be."""
    return {kind.__name__: without(kind) for kind in SWITCHED}


def _with(policy: Policy, owner: str, name: str, value: float) -> Policy:
    if owner == "Policy":
        return replace(policy, **{name: value})

    def changed(part: Any) -> Any:
        return replace(part, **{name: value}) if type(part).__name__ == owner else part

    rules = {field.name: changed(getattr(policy, field.name)) for field in fields(policy) if field.name != "doubts"}
    return replace(policy, doubts=tuple(map(changed, policy.doubts)), **rules)


def _told(part: object, name: str) -> str:
    """What the documentation of a rule says of one of its numbers, the first sentence of it."""
    text = inspect.cleandoc(type(part).__doc__ or "")
    found = re.search(rf"^    {name}: (.*(?:\n     +.*)*)", text, re.MULTILINE)
    return " ".join(found.group(1).split()).split(". ")[0].rstrip(".") if found else ""
