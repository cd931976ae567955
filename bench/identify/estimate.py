"""What identification returns: parameters with intervals, and how well they explain the recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist

#: Half width of the 95 % interval of a normal distribution in standard deviations, 1.96.
NORMAL95 = NormalDist().inv_cdf(0.975)


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


@dataclass(frozen=True)
class Residual:
    """Measured minus modelled effort over the rows used.

    Attributes:
        rms: root mean square - unit.
        noise_floor: what the sensors' noise alone would leave - unit; nan where the estimator knows none.
        relative: norm of the residual over the norm of the effort.
        unit: of the effort.
    """

    rms: float
    noise_floor: float
    relative: float
    unit: str


@dataclass(frozen=True)
class Estimate:
    """Result of identification; nothing downstream edits it.

    Attributes:
        estimator: name of the method.
        parameters: by the names of the contract.
        residual: how well they explain the recording.
        samples_read, samples_used: of the recording, and of its rows in the regression times the filter's stride.
        cutoff: half-power frequency of the filter - Hz; nan where nothing was filtered.
        source: signal that speed and acceleration came from.
        warnings: what a user should know before relying on it.
    """

    estimator: str
    parameters: Mapping[str, Parameter]
    residual: Residual
    samples_read: int
    samples_used: int
    cutoff: float
    source: str
    warnings: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> Parameter:
        return self.parameters[name]
