"""Options for reading recordings: what only the user knows of them, as in a rig's `[trace]`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol


class ReadingOptions(Protocol):
    """Options for reading a recording; a rig's `[trace]` has them."""

    @property
    def columns(self) -> Mapping[str, str]:
        """Signal (or `time`) -> column of the file with unit; a leading `-` inverts the sign."""
        ...

    @property
    def sample_period(self) -> float | None:
        """Sample period of a file without times, or with a sample index - s."""
        ...

    @property
    def position_period(self) -> float | None:
        """Period by which the position wraps - rad (m)."""
        ...

    @property
    def axis(self) -> str | None:
        """Axis to read from a file with several."""
        ...


@dataclass(frozen=True)
class GivenOptions:
    """Options without a rig."""

    columns: Mapping[str, str] = field(default_factory=dict)
    sample_period: float | None = None
    position_period: float | None = None
    axis: str | None = None


def reading_options(given: Mapping[str, str] | ReadingOptions | None) -> ReadingOptions:
    """Options as they are, from columns alone, or empty."""
    if given is None:
        return GivenOptions()
    return GivenOptions(given) if isinstance(given, Mapping) else given
