"""The result of one check of a recording."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Status = Literal["pass", "warn", "fail", "not_applicable"]
#: From worst to best.
STATUSES: tuple[Status, ...] = ("fail", "warn", "pass", "not_applicable")


@dataclass(frozen=True)
class Check:
    """Result of a check.

    Attributes:
        name: of the check.
        status: `fail` ends an identification, `warn` is printed.
        found: in the recording.
        allowed: what would pass.
        advice: what to do; empty if nothing.
        unanswerable: whether a failed recording is sound, and only insufficient.
    """

    name: str
    status: Status
    found: str
    allowed: str
    advice: str = ""
    unanswerable: bool = False


def absent(name: str, found: str, allowed: str) -> Check:
    """A check that does not apply to this recording.

    Args:
        name: of the check.
        found: why not.
        allowed: what would pass.
    """
    return Check(name, "not_applicable", found, allowed)
