"""What identification returns: parameters with intervals, and how well they explain the recording."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from bench.balance.parameter import Parameter
from bench.errors import UndeterminedError
from bench.gate.check import Check


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
class Between:
    """How recordings of one axis differ in a quantity.

    Attributes:
        std_dev: standard deviation of what each recording tells alone - the quantity's unit.
        predictive95: where what one recording more tells alone is to be expected, at 95 % - the quantity's unit.
    """

    std_dev: float
    predictive95: tuple[float, float]


@dataclass(frozen=True)
class Alone:
    """What one of several recordings tells by itself.

    Attributes:
        origin: of the recording.
        parameters: that it determines alone, by the names of the contract.
        reason: why not all of them; empty where it determines all.
    """

    origin: str
    parameters: Mapping[str, Parameter]
    reason: str = ""


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
        explained: share of the effort's variance that the model explains; nan where the estimator does not tell.
        checks: what the gate found before the fit.
        recordings: each alone, where several were fitted together.
        between: how they differ, by the names of the quantities that at least two of them tell alone.
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
    """The recording cannot answer; what was found all the same goes with it.

    Args:
        reason: why not.
        estimate: what was found, less what the recording leaves open.
    """

    def __init__(self, reason: UndeterminedError, estimate: Estimate) -> None:
        self.estimate = estimate
        super().__init__(reason.quantity, reason.reason, reason.record)
