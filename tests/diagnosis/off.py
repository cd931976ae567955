"""Every rule, doubt and judge switched off: what takes up lets all pass, what takes away takes nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace

from bench.diagnosis.name.doubts import (
    Contested,
    NotCredible,
    NotInHoldout,
    OneForMany,
    Simpler,
    TwoForOne,
    Unbelievable,
    WrongForm,
)
from bench.diagnosis.name.policy import Policy
from bench.diagnosis.name.rules import (
    Explains,
    NoLongerNeeded,
    Physical,
    Promising,
    Remainder,
    ReplacesClearly,
    Significant,
    worth,
)

#: A rule or doubt, and what its method is when it is off.
OFF: dict[type, tuple[str, Callable]] = {
    Promising: ("of", lambda self, current, tried, significant: tried),
    Significant: ("threshold", lambda self, fitted, numbers, noise=None: 0.0),
    Explains: (
        "holds",
        lambda self, before, after, significant: worth(before, after) > significant.threshold(before, 1),
    ),
    Physical: ("holds", lambda self, fitted: True),
    NoLongerNeeded: ("holds", lambda self, fitted, less, index, significant: False),
    ReplacesClearly: ("holds", lambda self, before, after: True),
    Remainder: ("holds", lambda self, fitted: False),
    NotCredible: ("left", lambda self, fitted, evidence: fitted),
    NotInHoldout: ("left", lambda self, fitted, evidence: fitted),
    Contested: ("left", lambda self, fitted, evidence: fitted),
    WrongForm: ("left", lambda self, fitted, evidence: fitted),
    TwoForOne: ("left", lambda self, fitted, evidence: fitted),
    OneForMany: ("left", lambda self, fitted, evidence: fitted),
    Simpler: ("left", lambda self, fitted, evidence: fitted),
    Unbelievable: ("left", lambda self, fitted, evidence: fitted),
}


def without(kind: type) -> Policy:
    """The policy with a rule or doubt off."""
    policy = Policy()
    method, neutral = OFF[kind]
    off = type(kind.__name__, (kind,), {method: neutral})()
    doubts = tuple(off if isinstance(doubt, kind) else doubt for doubt in policy.doubts)
    own = {field.name: off for field in fields(policy) if isinstance(getattr(policy, field.name), kind)}
    return replace(policy, doubts=doubts, **own)
