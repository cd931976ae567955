"""Encoder eccentricity: the measured position errs once per revolution, the measured velocity accordingly.

    q_m = q + e*sin(q + phi),  omega_m = omega*(1 + e*cos(q + phi))

e - amplitude - rad: eccentricity over radius of the graduation; q - angle of the motor - rad.
Source: A. Ernst, Digital Linear and Angular Metrology, 1998 (eccentricity of graduations).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bench.effects.physics import Array, Axis, Number, Sensing, Values
from bench.units import Quantity

#: Fixed-point steps that turn a measured into a true angle: each multiplies the error by e, which is far below 1.
STEPS = 12


class EncoderEccentricity(Sensing):
    """See the module."""

    name = "encoder_eccentricity"
    summary = "measured position errs once per revolution"
    quantities = (Quantity("amplitude", "e", "rad", lower=0.0, upper=0.5), Quantity("phase", "phi", "rad", angle=True))

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Where the effect is absent."""
        return {"amplitude": 0.0}

    def defaults(self, axis: Axis) -> Mapping[str, Number]:
        """A phase of zero."""
        return {"phase": 0.0}

    def seen(self, values: Values, position: Array, velocity: Array) -> tuple[Array, Array]:
        """By the equations above."""
        angle, amplitude = position + values["phase"], values["amplitude"]
        return position + amplitude * np.sin(angle), velocity * (1.0 + amplitude * np.cos(angle))

    def unseen(self, values: Mapping[str, float], position: Array, velocity: Array) -> tuple[Array, Array]:
        """By fixed-point iteration of q = q_m - e*sin(q + phi)."""
        amplitude, true = values["amplitude"], position
        for _ in range(STEPS):
            true = position - amplitude * np.sin(true + values["phase"])
        return true, velocity / (1.0 + amplitude * np.cos(true + values["phase"]))


EFFECT = EncoderEccentricity()
