"""The result of an identification: parameters with intervals, what follows from them, and how well they explain."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from bench.arrays import Array
from bench.axis_kind import ARMATURE, COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.comparison.spread import Between
from bench.errors import UndeterminedError
from bench.gate.check import Check
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.motion import Motion


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


def load_inertia(parameters: Mapping[str, Parameter], rig: Rig) -> dict[str, Parameter]:
    """J_load = J - J_motor, or (J - J_motor - J_gear)*i**2 behind a gear, if the rig gives J_motor and J is in kg*m**2.

    If the links of a robot are known, the armature of the joint instead, J*i**2 - J_links.
    """
    inertia = parameters.get(rig.axis_kind.inertia)
    if inertia is not None and rig.load is not None and rig.load.link_inertia is not None:
        square, links = rig.load.gear_ratio**2, rig.load.link_inertia
        low, high = (bound * square - links for bound in inertia.ci95)
        load = Parameter(inertia.value * square - links, inertia.unit, inertia.std_error * square, (low, high))
        return {ARMATURE: load}
    if inertia is None or rig.motor.rotor_inertia is None or inertia.unit != "kg*m**2":
        return {}
    value, square = _beyond(inertia.value, rig), _beyond(1.0, rig) - _beyond(0.0, rig)
    low, high = (value + (bound - inertia.value) * square for bound in inertia.ci95)
    load = Parameter(value, inertia.unit, inertia.std_error * square, (low, high))
    moved = (_beyond(inertia.value, other) - value for other in rig.within_tolerance())
    return {"load_moment_of_inertia": load.widened(*moved)}


def _beyond(inertia: float, rig: Rig) -> float:
    """An inertia without motor and gear, on the load's side - kg*m**2."""
    gear, ratio = (rig.load.gear_inertia or 0.0, rig.load.gear_ratio) if rig.load else (0.0, 1.0)
    return (inertia - (rig.motor.rotor_inertia or 0.0) - gear) * ratio**2


def modelled_effort(motion: Motion, estimate: Estimate, kind: AxisKind) -> Array:
    """J*alpha + K_w*omega + K_0*sgn(omega) (+ M_0) - tau*dM/dt along a motion (m,) - the effort's unit.

    nan where the direction is uncertain.
    """
    moving = motion.direction != 0.0
    columns = {
        INERTIA: motion.acceleration,
        VISCOUS: motion.velocity,
        COULOMB: motion.direction,
        OFFSET: np.ones(len(motion)),
        MISALIGNMENT: -motion.effort_rate,
    }
    found = {kind.parameter(term): column for term, column in columns.items()}
    modelled = sum((estimate.parameters[name].value * v for name, v in found.items() if name in estimate.parameters))
    return np.where(moving, modelled, np.nan)
