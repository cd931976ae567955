"""Limits of one piece of work, and the failure of one without a result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Limits:
    """Limits of one piece of work.

    Attributes:
        deadline: after which it is stopped - s.
        memory: of its process, beyond which it is stopped - bytes.
    """

    deadline: float = 120.0
    memory: float = 4.0 * 1024**3


@dataclass(frozen=True)
class Failure:
    """Why a piece of work gave no result.

    Attributes:
        status: `timed_out` where it was stopped at its deadline, `failed` where it raised, or its process died.
        reason: for a person; the same whenever the same happens.
    """

    status: Literal["failed", "timed_out"]
    reason: str
