"""Rules switched off: what takes up lets all pass, what takes away takes nothing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bench.diagnosis.policy import Policy

#: Questions of the policy, and what they answer when they are off.
RULES: dict[str, Callable] = {
    "by_chance": lambda self, fitted, numbers=1: 0.0,
    "only_damps": lambda self, before, after: False,
    "physical": lambda self, fitted: True,
    "remains": lambda self, fitted: False,
}


def without(rule: str, **numbers: Any) -> Policy:
    """The policy with a rule off, and other numbers."""
    return type("Off", (Policy,), {rule: RULES[rule]})(**numbers)
