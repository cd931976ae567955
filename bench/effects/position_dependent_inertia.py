"""Position-dependent inertia: a linkage or an eccentric disk, with the torque that its change of kinetic energy costs.

    M = J(q)*alpha + J'(q)*omega**2/2, J(q) = J*(1 + A*sin(n*q + phi))

A - relative amplitude; n - harmonic; q - angle - rad. Lagrange's equation of the kinetic energy J(q)*omega**2/2.
With J*sin(n*q)*alpha = d/dt(J*sin(n*q)*omega) - J*n*cos(n*q)*omega**2, only raw products are differentiated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.arrays import namespace
from bench.effects.acting import ResistingTorque, VaryingInertia
from bench.effects.axis import Axis, Moment, Number, Values
from bench.effects.effect import Columns, Wave
from bench.effects.signals import Base, Shape, Signals
from bench.effects.waves import amplitude_and_phase
from bench.trace.filter import Column
from bench.units import Quantity


class PositionDependentInertia(Wave, Columns, VaryingInertia, ResistingTorque):
    """See the module."""

    name = "position_dependent_inertia"
    summary = "inertia varies with position, with its velocity-squared torque"
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.0, null=0.0),
        Quantity("harmonic", "n", "dimensionless", lower=1.0, linear_unit="rad/m"),
        Quantity("phase", "phi", "rad", angle=True, preset=0.0),
    )
    shapes = (Shape(quantities[1], (1.0, 2.0, 3.0, 4.0), whole=True),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Sine and cosine variation."""
        angle, omega = shape[0] * signals.position, signals.velocity
        half = 0.5 * shape[0] * omega**2
        return [
            [(omega * np.sin(angle), 1), (-half * np.cos(angle), 0)],
            [(omega * np.cos(angle), 1), (half * np.sin(angle), 0)],
        ]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Amplitude relative to the mean inertia, and phase."""
        amplitude, phase = amplitude_and_phase(*strengths)
        return {"relative_amplitude": amplitude / base.inertia, "harmonic": shape[0], "phase": phase}

    def added_inertia(self, values: Values, axis: Axis, at: Moment) -> Number:
        """J(q) - J."""
        angle = values["harmonic"] * at.position + values["phase"]
        return axis.inertia * values["relative_amplitude"] * namespace(angle).sin(angle)

    def resisting_torque(self, values: Values, axis: Axis, at: Moment) -> Number:
        """J'(q)*omega**2/2."""
        slope = axis.inertia * values["relative_amplitude"] * values["harmonic"]
        angle = values["harmonic"] * at.position + values["phase"]
        return 0.5 * slope * namespace(angle).cos(angle) * at.velocity**2


EFFECT = PositionDependentInertia()
