"""The lab course's estimators, as a student writes them: fixed thresholds on a backward difference.

They are kept for comparison with the default estimator. Their faults: the backward difference amplifies speed noise by
sqrt(2)/T and lags speed by half a sample, noise in alpha biases J towards zero, rows are chosen by thresholds that do
not depend on noise or motion, and the covariance assumes independent residuals.
"""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import NORMAL95, Array
from bench.axis_kind import VISCOUS
from bench.errors import InputError, UndeterminedError
from bench.fit.determined import RECORD
from bench.fit.estimate import Estimate, Residual, load_inertia
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: The course drops slower samples - rad/s.
LEAST_SPEED = 20.0


def least_squares(acceleration: Array, velocity: Array, torque: Array) -> tuple[Array, Array, float]:
    """J, K_w and K_0 of M = J*alpha + K_w*omega + K_0*sgn(omega) by least squares over the fast samples (n,).

    With standard errors under independent residuals (3,), and the remaining quadratic error - (N*m)**2.
    UndeterminedError where the three columns are not independent.
    """
    columns = np.stack([acceleration, velocity, np.sign(velocity)], axis=1)
    theta, _, rank, _ = np.linalg.lstsq(columns, torque, rcond=None)
    if rank < 3 or len(torque) <= 3:
        reason = f"the {len(torque)} samples faster than {LEAST_SPEED:g} rad/s cannot separate inertia and friction"
        raise UndeterminedError("inertia and friction", reason, RECORD[VISCOUS])
    error = float(np.sum((torque - columns @ theta) ** 2))
    variance = error / (len(torque) - 3) * np.diag(np.linalg.inv(columns.T @ columns))
    return np.asarray(theta, dtype=np.float64), np.sqrt(variance), error


def identify_as_in_the_lab(trace: Trace, rig: Rig) -> Estimate:
    """The course's least squares on a recording of a rotary axis.

    Raises:
        InputError: a linear axis, or no velocity.
        UndeterminedError: too few samples faster than 20 rad/s.
    """
    if not rig.axis_kind.turns:
        allowed = "allowed: rotary; the course's thresholds are in rad/s"
        raise InputError(rig.source, f"found a {rig.kind} axis", allowed)
    torque, unit = rig.net_effort(trace)
    velocity = trace["velocity"]
    differences = [np.diff(velocity[part], prepend=velocity[part][:1]) for part in trace.segments]
    acceleration = np.concatenate(differences) / trace.sample_period
    fast = np.abs(velocity) >= LEAST_SPEED
    theta, std_error, error = least_squares(acceleration[fast], velocity[fast], torque[fast])
    numbers = zip(rig.axis_kind.base_parameters(unit).items(), theta.tolist(), std_error.tolist(), strict=True)
    parameters = {
        name: Parameter.around(value, label, error, NORMAL95 * error) for (name, label), value, error in numbers
    }
    rms = math.sqrt(error / np.count_nonzero(fast))
    relative = math.sqrt(error / np.sum(torque[fast] ** 2))
    return Estimate(
        estimator="lab",
        parameters=parameters | load_inertia(parameters, rig),
        residual=Residual(rms, math.nan, relative, unit),
        samples_read=len(trace),
        samples_used=int(np.count_nonzero(fast)),
        cutoff=math.nan,
        source="velocity",
        explained=1.0 - error / float(np.sum((torque[fast] - torque[fast].mean()) ** 2)),
        warnings=("intervals take residuals for independent, as the course does: they are too narrow",),
    )
