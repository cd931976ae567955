"""How foreign recordings are to be read: what only the user knows of them, as a rig's `[trace]` says it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol


class HowToRead(Protocol):
    """What a reader is told about a recording."""

    @property
    def columns(self) -> Mapping[str, str]:
        """Signal (or `time`) -> column of the file with unit; a leading `-` turns the sign."""
        ...

    @property
    def sample_period(self) -> float | None:
        """Of a file without time, or with a sample index - s."""
        ...

    @property
    def position_period(self) -> float | None:
        """By which the position wraps - rad (m)."""
        ...

    @property
    def axis(self) -> str | None:
        """Axis to be read where a file holds several."""
        ...


@dataclass(frozen=True)
class How:
    """`HowToRead` of one's own, where there is no rig."""

    columns: Mapping[str, str] = field(default_factory=dict)
    sample_period: float | None = None
    position_period: float | None = None
    axis: str | None = None


def how_to_read(given: Mapping[str, str] | HowToRead | None) -> HowToRead:
    """Columns alone, or nothing, as `HowToRead`."""
    if given is None:
        return How()
    return How(given) if isinstance(given, Mapping) else given
