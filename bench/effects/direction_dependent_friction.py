"""Direction-dependent friction: dry and viscous friction differ between the two directions.

    M = K_w*omega + K_0*sgn(omega) + D_0/2 + D_w/2*|omega|

D_0, D_w - Coulomb and viscous friction forward less backward - N*m (N), N*m*s/rad (N*s/m). The constant part cannot be
told from a torque offset by any recording: they are each other's `ambiguous_with`.
Source: A. Janot, M. Gautier, M. Brunot, NSIB workshop 2019 (EMPS, asymmetric friction).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.effect import Base, Column, Effect, Signals
from bench.units import Quantity


class DirectionDependentFriction(Effect):
    """See the module."""

    name = "direction_dependent_friction"
    summary = "friction differs between the two directions"
    quantities = (
        Quantity("coulomb_difference", "D_0", "N*m"),
        Quantity("viscous_difference", "D_w", "N*m*s/rad"),
    )

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """1/2 and |omega|/2."""
        return [[(np.full_like(signals.time, 0.5), 0)], [(0.5 * signals.velocity * signals.sign, 0)]]

    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Differences forward less backward."""
        return {"coulomb_difference": strengths[0], "viscous_difference": strengths[1]}


EFFECT = DirectionDependentFriction()
