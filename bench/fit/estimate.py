"""The result of an identification: parameters with intervals, and how well they explain the recording."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from bench.comparison.spread import Between
from bench.errors import UndeterminedError
from bench.fit.parameter import Parameter
from bench.gate.check import Check


@dataclass(frozen=True)
class Residual:
    """Measured minus modelled effort over the rows used.

    Attributes:
        rms: root mean square - unit.
        noise_floor: expected RMS from sensor noise alone - unit; nan if the estimator has none.
        relative: norm of the residual over the norm of the effort.
        unit: of the effort.
    """

    rms: float
    noise_floor: float
    relative: float
    unit: str


@dataclass(frozen=True)
class Alone:
    """The estimate by one of several recordings alone.

    Attributes:
        origin: of the recording.
        parameters: those that it determines alone, by name.
        reason: why not all of them; empty if all.
    """

    origin: str
    parameters: Mapping[str, Parameter]
    reason: str = ""


@dataclass(frozen=True)
class Estimate:
    """Result of an identification.

    Attributes:
        estimator: name of the method.
        parameters: by name.
        residual: of the fit.
        samples_read, samples_used: of the recording, and in the regression (rows times the filter's stride).
        cutoff: half-power frequency of the filter - Hz; nan without a filter.
        source: signal that speed and acceleration are from.
        warnings: what a user should know before relying on it.
        explained: share of the effort's variance that the model explains; nan if the estimator does not give it.
        checks: results of the gate.
        recordings: the estimate by each alone, where several were fitted together.
        between: their spread, by name of a quantity that at least two of them determine alone.
    """

    estimator: str
    parameters: Mapping[str, Parameter]
    residual: Residual
    samples_read: int
    samples_used: int
    cutoff: float
    source: str
    warnings: tuple[str, ...] = ()
    explained: float = math.nan
    checks: tuple[Check, ...] = ()
    recordings: tuple[Alone, ...] = ()
    between: Mapping[str, Between] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Parameter:
        return self.parameters[name]


class RefusedEstimateError(UndeterminedError):
    """The recording does not determine everything; the error carries what it does.

    Args:
        reason: why not.
        estimate: without the undetermined parameters.
    """

    def __init__(self, reason: UndeterminedError, estimate: Estimate) -> None:
        self.estimate = estimate
        super().__init__(reason.quantity, reason.reason, reason.record)
