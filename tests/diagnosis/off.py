"""Every rule switched off: what takes up lets all pass, what takes away takes nothing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bench.diagnosis.policy import Policy, worth

#: Questions of the policy, and what they answer when they are off.
RULES: dict[str, Callable] = {
    "promises": lambda self, current, gain: True,
    "by_chance": lambda self, fitted, numbers, noise=None: 0.0,
    "accepts": lambda self, before, after: worth(before, after) > self.by_chance(before, 1) and self.physical(after),
    "physical": lambda self, fitted: True,
    "needs": lambda self, fitted, less, index: True,
    "leads": lambda self, before, after: True,
    "replaces_by": lambda self, before, after, without: True,
    "remains": lambda self, fitted: False,
}


def without(rule: str, **numbers: Any) -> Policy:
    """The policy with a rule off, and other numbers."""
    return type("Off", (Policy,), {rule: RULES[rule]})(**numbers)
