"""Torque constant kT(Iq), which falls as the iron saturates: `M = kT(Iq)*Iq`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array


@dataclass(frozen=True)
class TorqueConstant:
    """kT(I) = a*I**2 + c, an even function of current because a motor is as strong one way as the other.

    The course writes kT(Iq) = a*Iq**2 + b*Iq + c; zero slope at zero current makes b = 0.

    Attributes:
        constant: c, torque per ampere at zero current - N*m/A (N/A on a linear axis).
        curvature: a, zero or negative - N*m/A**3 (N/A**3).
    """

    constant: float
    curvature: float = 0.0

    @classmethod
    def from_datasheet(
        cls,
        continuous_stall_torque: float,
        continuous_stall_current: float,
        peak_torque: float,
        peak_current: float,
    ) -> TorqueConstant:
        """kT from the stall point (M0 - N*m, I0 - A) and the peak point (Mmax - N*m, Imax - A), both met exactly.

        c + a*I0**2 = M0/I0 and c + a*Imax**2 = Mmax/Imax.
        """
        stall = continuous_stall_torque / continuous_stall_current
        peak = peak_torque / peak_current
        curvature = (peak - stall) / (peak_current**2 - continuous_stall_current**2)
        return cls(stall - curvature * continuous_stall_current**2, curvature)

    def __call__(self, current: Array) -> Array:
        """Torque per ampere at a current - A, any shape."""
        return self.constant + self.curvature * current**2

    def torque(self, current: Array) -> Array:
        """Motor torque at a current - A, any shape."""
        return self(current) * current

    def current(self, torque: Array) -> Array:
        """Current that gives a torque - N*m, any shape; the inverse of `torque` below its maximum.

        Solves a*I**3 + c*I = M on the branch through zero (trigonometric solution of the depressed cubic,
        Abramowitz & Stegun 3.8.2). Torque beyond the maximum gives the current of the maximum.
        """
        if self.curvature == 0.0:
            return np.asarray(torque) / self.constant
        p = -self.constant / self.curvature
        q = np.asarray(torque) / self.curvature
        peak = 2.0 * np.sqrt(p / 3.0)
        return peak * np.sin(np.arcsin(np.clip(-3.0 * q / (p * peak), -1.0, 1.0)) / 3.0)
