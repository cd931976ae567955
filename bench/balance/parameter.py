"""An identified quantity with its interval."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """An identified quantity.

    Attributes:
        value: in `unit`.
        unit: SI, or built from the unit the effort was allowed in (A*s**2/rad, ...).
        std_error: standard error - unit; nan where the estimator knows none.
        ci95: 95 % interval - unit.
    """

    value: float
    unit: str
    std_error: float
    ci95: tuple[float, float]
