"""The regression M = J*alpha + K_w*omega + K_0*sgn(omega) + M_0 - tau*dM/dt as columns of filtered motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS
from bench.trace.motion import Motion


@dataclass(frozen=True)
class Regressors:
    """Columns of one stretch of motion, rows whose direction is known.

    The last column, -dM/dt, takes up a shift tau of the reported effort against the reported speed by a part of a
    sample: M_reported(t) = M(t - tau) = M - tau*dM/dt to first order. Without it the shift goes into friction.

    Attributes:
        names: of the columns.
        table: (m, p + 1): the columns, and the effort that they explain.
        noise: (p,) standard deviation of the sensor noise in each column, independent between columns: a smoothed
            signal and its derivative are uncorrelated under white noise, as G is even and omega*G odd.
        time: (m,) - s.
    """

    names: tuple[str, ...]
    table: NDArray[np.float64]
    noise: NDArray[np.float64]
    time: NDArray[np.float64]

    @property
    def columns(self) -> NDArray[np.float64]:
        """(m, p)."""
        return self.table[:, :-1]

    @property
    def effort(self) -> NDArray[np.float64]:
        """(m,) - the effort's unit."""
        return self.table[:, -1]


def regressors(motion: Motion) -> Regressors:
    """Columns of a motion: inertia, viscous, Coulomb, constant, misalignment."""
    conditioning = motion.conditioning
    noise = {
        INERTIA: conditioning.acceleration_noise,
        VISCOUS: conditioning.velocity_noise,
        COULOMB: 0.0,
        OFFSET: 0.0,
        MISALIGNMENT: conditioning.effort_noise * conditioning.filter.noise_gain(1),
    }
    used = np.flatnonzero(motion.direction)
    table = np.empty((used.size, len(noise) + 1))
    table[:, 0] = motion.acceleration[used]
    table[:, 1] = motion.velocity[used]
    table[:, 2] = motion.direction[used]
    table[:, 3] = 1.0
    np.negative(motion.effort_rate[used], out=table[:, 4])
    table[:, 5] = motion.effort[used]
    return Regressors(tuple(noise), table, np.array(list(noise.values())), motion.time[used])
