"""The regression M = J*alpha + K_w*omega + K_0*sgn(omega) + M_0 - tau*dM/dt as columns of filtered motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.trace.motion import Motion

INERTIA, VISCOUS, COULOMB, OFFSET, MISALIGNMENT = "inertia", "viscous", "coulomb", "offset", "misalignment"


@dataclass(frozen=True)
class Regressors:
    """Columns of one stretch of motion, rows whose direction is known.

    The last column, -dM/dt, takes up a shift tau of the reported effort against the reported speed by a part of a
    sample: M_reported(t) = M(t - tau) = M - tau*dM/dt to first order. Without it the shift goes into friction.

    Attributes:
        names: of the columns.
        columns: (m, p).
        effort: (m,), what they explain.
        noise: (p,) standard deviation of the sensor noise in each column, independent between columns: a smoothed
            signal and its derivative are uncorrelated under white noise, as G is even and omega*G odd.
        time: (m,) - s.
    """

    names: tuple[str, ...]
    columns: NDArray[np.float64]
    effort: NDArray[np.float64]
    noise: NDArray[np.float64]
    time: NDArray[np.float64]


def regressors(motion: Motion) -> Regressors:
    """Columns of a motion: inertia, viscous, Coulomb, constant, misalignment."""
    used = motion.direction != 0.0
    conditioning = motion.conditioning
    table = {
        INERTIA: (motion.acceleration, conditioning.acceleration_noise),
        VISCOUS: (motion.velocity, conditioning.velocity_noise),
        COULOMB: (motion.direction, 0.0),
        OFFSET: (np.ones_like(motion.time), 0.0),
        MISALIGNMENT: (-motion.effort_rate, conditioning.effort_noise * conditioning.filter.noise_gain(1)),
    }
    columns = np.stack([column[used] for column, _ in table.values()], axis=1)
    noise = np.array([noise for _, noise in table.values()])
    return Regressors(tuple(table), columns, motion.effort[used], noise, motion.time[used])
