"""What one look at a recording found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Status = Literal["pass", "warn", "fail", "not_applicable"]
#: From worst to best.
STATUSES: tuple[Status, ...] = ("fail", "warn", "pass", "not_applicable")


@dataclass(frozen=True)
class Check:
    """One check of a recording, passed or not.

    Attributes:
        name: of the contract.
        status: `fail` ends an identification, `warn` is told.
        found: in the recording.
        allowed: what would pass.
        advice: what to do; empty where there is nothing to do.
        unanswerable: whether a fail means that a sound recording cannot answer, rather than that it is wrong.
    """

    name: str
    status: Status
    found: str
    allowed: str
    advice: str = ""
    unanswerable: bool = False


def absent(name: str, found: str, allowed: str) -> Check:
    """A check that this recording gives no occasion for.

    Args:
        name: of the check.
        found: why not.
        allowed: what it would hold the recording to.
    """
    return Check(name, "not_applicable", found, allowed)
