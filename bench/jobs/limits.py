"""What one piece of work may take, and what is said of one that gave no result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Limits:
    """Of one piece of work.

    Attributes:
        deadline: after which it is stopped - s.
        memory: of its process, beyond which it is stopped - bytes.
    """

    deadline: float = 120.0
    memory: float = 4.0 * 1024**3


@dataclass(frozen=True)
class Failure:
    """Of one piece of work that gave no result.

    Attributes:
        status: `timed_out` where it was stopped at its deadline, `failed` where it raised, or its process died.
        reason: for a person; the same whenever the same happens.
    """

    status: Literal["failed", "timed_out"]
    reason: str
