"""The reasons of a diagnosis: a criterion with its figures, which `bench.report.verdict` puts into words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from bench.parameter import Parameter


@dataclass(frozen=True)
class Reason:
    """A criterion that decided, with its figures by name."""

    criterion: str
    figures: Mapping[str, str | float | Parameter] = field(default_factory=dict)
