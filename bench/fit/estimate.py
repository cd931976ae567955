"""The result of an identification: parameters with intervals, what follows from them, and how well they explain."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bench.arrays import Array
from bench.axis_kind import ARMATURE, COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.comparison.spread import Between
from bench.errors import InputError, UndeterminedError
from bench.files import read_text
from bench.fit.dead_time import CommandDelay, DeadTime
from bench.gate.check import Check
from bench.names import meant
from bench.parameter import Parameter
from bench.presented import Presented
from bench.rig.given import Given, trace_of
from bench.rig.rig import Rig
from bench.structured import parse_json
from bench.trace.motion import Motion
from bench.trace.trace import Trace


@dataclass(frozen=True)
class Residual:
    """Measured minus modelled effort over the rows used.

    Attributes:
        rms: root mean square - unit.
        noise_floor: expected RMS from sensor noise alone - unit; nan if the estimator has none.
        relative: norm of the residual over the norm of the effort.
        unit: of the effort.
        depends_on: what it depends on where its RMS is that of noise; None if it is noise, or more than noise.
    """

    rms: float
    noise_floor: float
    relative: float
    unit: str
    depends_on: str | None = None


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
class MotorConstants:
    """Constants of a motor, as `bench.fit.motor` finds them.

    Attributes:
        parameters: those that the recording determines, by name.
        refused: why it does not determine others, by name.
        supply: lowest and highest supply voltage, where that is recorded - V.
    """

    parameters: Mapping[str, Parameter]
    refused: Mapping[str, str]
    supply: tuple[float, float] | None = None


@dataclass(frozen=True, repr=False)
class Estimate(Presented, Mapping[str, Parameter]):
    """Result of an identification: a mapping of names to parameters, which are attributes, too.

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
        recordings: the estimate by each recording, where several were fitted together.
        between: their spread, by name of a quantity that at least two of them determine alone.
        dead_time: by how much torque is later than motion, if that is more than a sample; None if it is not.
        command: how the torque follows its recorded command; None where it is in step, or not recorded.
        motor: constants of the motor, where a voltage is recorded.
        coupling: of motor and load, by name, where positions of both are recorded.
        of: rig and recordings, where they are in memory, for a figure.
        correlations: of the errors of the parameters of the fit, by name and name; empty if it was read from a file.
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
    dead_time: DeadTime | None = None
    command: CommandDelay | None = None
    motor: MotorConstants | None = None
    coupling: Mapping[str, Parameter] = field(default_factory=dict)
    of: tuple[Rig, tuple[Trace, ...]] | None = field(default=None, compare=False)
    correlations: Mapping[str, Mapping[str, float]] = field(default_factory=dict, compare=False)

    def __getitem__(self, name: str) -> Parameter:
        return meant(name, self.parameters)

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __len__(self) -> int:
        return len(self.parameters)

    @property
    def correlation(self) -> Array:
        """Correlation of the errors of the parameters, in their order (p, p).

        By the least squares; nan for a parameter that they do not give, such as the load's inertia.

        Raises:
            InputError: an estimate that was read from a file.
        """
        if not self.correlations:
            raise InputError("correlation", "found an estimate from a file", "allowed: one that identify(...) returned")
        table = self.correlations
        return np.array([[table[a][b] if a in table and b in table else math.nan for b in self] for a in self])

    @property
    def covariance(self) -> Array:
        """Covariance of the parameters, in their order - unit times unit (p, p): `correlation` times standard errors.

        The standard errors count margins for misfit and tolerances; of these no correlation is known.
        """
        errors = np.array([one.std_error for one in self.parameters.values()])
        return self.correlation * np.outer(errors, errors)

    @property
    def residuals(self) -> Array:
        """Measured less modelled effort of the first recording, where it moves in one direction - unit - (m,).

        Raises:
            InputError: an estimate that was read from a file: it contains no recording.
        """
        _, _, left = self.renderer().along(self)
        return left[np.isfinite(left)]

    @property
    def fitted_values(self) -> Array:
        """The effort that is modelled there - unit - (m,); raises as `residuals`."""
        _, effort, left = self.renderer().along(self)
        return (effort - left)[np.isfinite(left)]

    def predict(self, recording: Given) -> Array:
        """The effort modelled along a recording of the axis, as `identify` takes it - unit - (n,).

        Where the direction is uncertain, and within the filter's reach of an end, it is nan.

        Raises:
            InputError: no recording, or an estimate that was read from a file.
        """
        if self.of is None:
            raise InputError("predict()", "found an estimate from a file", "allowed: one that identify(...) returned")
        trace = trace_of(recording, self.of[0])
        time, effort, left = self.renderer().along(self, trace)
        step = np.diff(time)
        after = np.clip(np.searchsorted(time, trace.time), 1, step.size)  # rows may be every few samples
        between = step[after - 1] < 1.5 * float(np.median(step))
        return np.where(between, np.interp(trace.time, time, effort - left, np.nan, np.nan), np.nan)

    @classmethod
    def load(cls, path: str | Path) -> Estimate:
        """The estimate of a file that `save` wrote, as `bench identify --json` does, or of the folder of its `--out`.

        Raises:
            InputError: no such file, or one without a result.
        """
        path = Path(path) / "identify.json" if Path(path).is_dir() else path
        table = parse_json(read_text(path, "an estimate"), path)
        try:
            residual, smooth = _with_nan(table["residual"]), _with_nan(table["filter"])
            alone = (Alone(one["file"], _stored(one["parameters"]), one["reason"] or "") for one in table["recordings"])
            spread = {
                key: Between(one["std_dev"], (*one["predictive95"],)) for key, one in (table["between"] or {}).items()
            }
            return cls(
                table["estimator"],
                _stored(table["parameters"]),
                Residual(**{**residual, "depends_on": table["residual"].get("depends_on")}),
                table["samples"]["read"],
                table["samples"]["used"],
                smooth["cutoff"],
                smooth["source"],
                tuple(table["warnings"]),
                _with_nan(table)["explained"],
                tuple(Check(**one) for one in table["checks"]),
                tuple(alone),
                spread,
                None if (late := table.get("dead_time")) is None else DeadTime(**_with_stored(late)),
                None if (command := table.get("command")) is None else CommandDelay(**_with_stored(command)),
                _stored_motor(table.get("motor")),
                _stored(table.get("coupling", {})),
            )
        except (KeyError, TypeError, AttributeError) as error:
            raise InputError(path, f"contains no estimate ({error})", "allowed: what Estimate.save writes") from error


def _with_nan(table: Mapping[str, Any]) -> dict[str, Any]:
    """What is not known is null in JSON, and nan here."""
    return {key: math.nan if value is None else value for key, value in table.items()}


def _stored(table: Mapping[str, Mapping[str, Any]]) -> dict[str, Parameter]:
    return {name: Parameter(**{**_with_nan(one), "ci95": (*one["ci95"],)}) for name, one in table.items()}


def _with_stored(table: Mapping[str, Any]) -> dict[str, Any]:
    """A table whose values that are tables are parameters."""
    return {**table, **_stored({key: one for key, one in table.items() if isinstance(one, Mapping)})}


def _stored_motor(table: Mapping[str, Any] | None) -> MotorConstants | None:
    if table is None:
        return None
    supply = table["supply"]
    return MotorConstants(_stored(table["parameters"]), table["refused"], None if supply is None else (*supply,))


class RefusedEstimateError(UndeterminedError):
    """The recording does not determine everything, for a reason; the error carries the estimate without that."""

    def __init__(self, reason: UndeterminedError, estimate: Estimate) -> None:
        self.estimate = estimate
        super().__init__(reason.quantity, reason.reason, reason.record)


def load_inertia(parameters: Mapping[str, Parameter], rig: Rig) -> dict[str, Parameter]:
    """J_load = J - J_motor, or (J - J_motor - J_gear)*i**2 behind a gear, if the rig gives J_motor and J is in kg*m**2.

    If the links of a robot are known, the armature of the joint instead, J*i**2 - J_links; none of either where the
    torque is measured behind the rotor.
    """
    inertia = parameters.get(rig.axis_kind.inertia)
    if inertia is None or (rig.load is not None and rig.load.behind_rotor):
        return {}
    if rig.load is not None and rig.load.link_inertia is not None:
        return {ARMATURE: _beyond(inertia, rig.load.link_inertia, rig.load.gear_ratio**2)}
    if rig.motor.rotor_inertia is None or inertia.unit != "kg*m**2":
        return {}
    load = _beyond(inertia, *_before_load(rig))
    moved = (_beyond(inertia, *_before_load(other)).value - load.value for other in rig.within_tolerance())
    return {"load_moment_of_inertia": load.widened(*moved)}


def _before_load(rig: Rig) -> tuple[float, float]:
    """Inertia of motor and gear as the load sees it - kg*m**2 -, and the square of the gear's ratio."""
    gear, ratio = (rig.load.gear_inertia or 0.0, rig.load.gear_ratio) if rig.load else (0.0, 1.0)
    return ((rig.motor.rotor_inertia or 0.0) + gear) * ratio**2, ratio**2


def _beyond(inertia: Parameter, less: float, square: float) -> Parameter:
    """An inertia times the square of a gear's ratio, less another one - kg*m**2."""
    low, high = (bound * square - less for bound in inertia.ci95)
    return Parameter(inertia.value * square - less, inertia.unit, inertia.std_error * square, (low, high))


def modelled_effort(motion: Motion, estimate: Estimate, kind: AxisKind) -> Array:
    """J*alpha + K_w*omega + K_0*sgn(omega) (+ M_0) - tau*dM/dt (m,) - the effort's unit; nan where uncertain."""
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
