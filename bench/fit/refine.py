"""Refine an estimate by simulation error: MuJoCo runs the axis along the recording, and its parameters are optimised.

Regression first, simulation second: from a far start the simulation error does not converge (figures in
docs/identify.md), from the regression's estimate it does in a few steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.optimize

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB, INERTIA, OFFSET, VISCOUS
from bench.errors import InputError
from bench.fit.estimate import Estimate, load_inertia
from bench.fit.identify import identify
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.tracking import BANDWIDTH, SoftTracking, track
from bench.rig.rig import Rig
from bench.trace.motion import measured_velocity
from bench.trace.trace import Trace

#: Share of the recording, at its end, that is held out to judge the refinement.
HELD_OUT = 1.0 / 3.0


@dataclass(frozen=True)
class Refinement:
    """Velocity gap before and after refinement: RMS of measured minus simulated velocity - rad/s (m/s).

    Attributes:
        fitted: gap over the whole recording, before and after.
        held_out: gap on motion that neither regression nor refinement used, before and after.
        accepted: whether the refined parameters were kept: only if the held-out gap did not grow.
        bandwidth: of the cascade that keeps the model near the recording - rad/s.
    """

    fitted: tuple[float, float]
    held_out: tuple[float, float]
    accepted: bool
    bandwidth: float = BANDWIDTH


def refine(
    trace: Trace, rig: Rig, start: Estimate, progress: Callable[[float], None] = lambda share: None
) -> tuple[Estimate, Refinement]:
    """Refine inertia and friction (and offset) of an estimate by the velocity gap of the simulated axis.

    Minimises sum((omega_simulated - omega_measured)**2). Whether that helps is tested first: regression and refinement
    on the first two thirds, judged on the rest. Intervals keep the regression's width, as the noise is the same.

    Args:
        trace: the recording the estimate came from.
        rig: of the axis.
        start: regression's estimate.
        progress: called with the share done.

    Raises:
        InputError: the rig gives no torque or force.
        UndeterminedError: two thirds of the recording do not determine the axis.
        SimulationError: the model diverged.
    """
    if start.residual.unit != rig.effort_unit:
        raise InputError(
            rig.source, f"gives the effort in {start.residual.unit}", f"simulation needs {rig.effort_unit}"
        )
    split = trace.time[0] + (1.0 - HELD_OUT) * (trace.time[-1] - trace.time[0])
    seen, unseen = (_Tracking(trace.between(*span), rig) for span in ((trace.time[0], split), (split, np.inf)))
    trial = identify(seen.trace, rig)
    progress(0.1)
    held_out = unseen.gap(trial), unseen.gap(seen.polished(trial))
    whole = _Tracking(trace, rig)
    before = whole.gap(start)
    if held_out[1] > held_out[0]:
        return start, Refinement((before, before), held_out, accepted=False)
    progress(0.5)
    polished = whole.polished(start)
    return polished, Refinement((before, whole.gap(polished)), held_out, accepted=True)


class _Tracking:
    """A recording, and the axis simulated along it."""

    def __init__(self, trace: Trace, rig: Rig) -> None:
        self.trace, self.rig = trace, rig
        self.columns = [INERTIA, VISCOUS, COULOMB, *([OFFSET] if rig.offset else [])]
        self.names = [rig.axis_kind.parameter(column) for column in self.columns]
        self.effort, _ = rig.net_effort(trace)
        self.velocity = measured_velocity(trace)

    def gap(self, estimate: Estimate) -> float:
        """RMS of simulated minus measured velocity - rad/s (m/s)."""
        return rms(self._difference(self._theta(estimate), estimate))

    def polished(self, start: Estimate) -> Estimate:
        """The estimate with the least velocity gap, searched from `start`."""
        first = self._theta(start)
        least = {INERTIA: 0.1 * start[self.rig.axis_kind.inertia].value, OFFSET: -np.inf}
        lower = np.array([least.get(column, 0.0) for column in self.columns])
        found = scipy.optimize.least_squares(
            lambda theta: self._difference(theta, start),
            np.maximum(first, lower),
            x_scale=np.maximum(np.abs(first), 1e-3 * np.abs(first).max()),
            bounds=(lower, np.inf),
            diff_step=1e-4,
            xtol=1e-6,
            max_nfev=10,
        )
        parameters = dict(start.parameters)
        for name, value in zip(self.names, found.x.tolist(), strict=True):
            parameters[name] = start[name].at(value, positive=False)
        parameters |= load_inertia(parameters, self.rig)
        return replace(start, parameters=parameters, estimator="regression, polished by simulation")

    def _theta(self, estimate: Estimate) -> Array:
        return np.array([estimate[name].value for name in self.names])

    def _difference(self, theta: Array, start: Estimate) -> Array:
        values, kind = dict(zip(self.columns, theta.tolist(), strict=True)), self.rig.axis_kind
        axis = AxisParameters(
            inertia=values[INERTIA],
            viscous_friction_coefficient=max(values[VISCOUS], 0.0),
            coulomb_friction=max(values[COULOMB], 0.0),
            load_torque=values.get(OFFSET, 0.0),
            kind=kind,
        )
        late, inertia = start["misalignment"].value, start[kind.inertia].value
        held = SoftTracking(AxisModel(axis), self.trace, self.effort, late, inertia)
        return track(held).velocity - self.velocity
