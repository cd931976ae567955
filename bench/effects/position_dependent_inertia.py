"""Position-dependent inertia: a linkage or an eccentric disk, with the torque that its change of kinetic energy costs.

    M = J(q)*alpha + J'(q)*omega**2/2, J(q) = J*(1 + A*sin(n*q + phi))

A - relative amplitude; n - harmonic; q - angle - rad. Lagrange's equation of the kinetic energy J(q)*omega**2/2.
With J*sin(n*q)*alpha = d/dt(J*sin(n*q)*omega) - J*n*cos(n*q)*omega**2, only raw products are differentiated.
"""

from bench.arrays import Array, namespace
from bench.effects.acting import ResistingTorque, VaryingInertia
from bench.effects.signals import Axis, Base, Moment, Number, Signals, Values
from bench.effects.waves import PHASE, Harmonic, harmonics, wave
from bench.trace.filter import Column
from bench.units import Quantity


class PositionDependentInertia(Harmonic, VaryingInertia, ResistingTorque):
    name = "position_dependent_inertia"
    summary = "inertia varies with position, with its velocity-squared torque"
    shapes = (harmonics(1, 4),)
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.0, null=0.0),
        shapes[0].quantity,
        PHASE,
    )

    def of_wave(self, signals: Signals, number: float, sine: Array, cosine: Array) -> list[Column]:
        omega, half = signals.velocity, 0.5 * number * signals.velocity**2
        return [[(omega * sine, 1), (-half * cosine, 0)], [(omega * cosine, 1), (half * sine, 0)]]

    def unit(self, base: Base) -> float:
        return base.inertia

    def added_inertia(self, values: Values, axis: Axis, at: Moment) -> Number:
        return axis.inertia * wave(values, "relative_amplitude", at.position)

    def resisting_torque(self, values: Values, axis: Axis, at: Moment) -> Number:
        slope = axis.inertia * values["relative_amplitude"] * values["harmonic"]
        angle = values["harmonic"] * at.position + values["phase"]
        return 0.5 * slope * namespace(angle).cos(angle) * at.velocity**2


EFFECT = PositionDependentInertia()
