"""Position-dependent inertia: a linkage or an eccentric disk, with the torque that its change of kinetic energy costs.

    M = J(q)*alpha + J'(q)*omega**2/2, J(q) = J*(1 + A*sin(n*q + phi))

A - relative amplitude; n - harmonic; q - angle - rad. Lagrange's equation of the kinetic energy J(q)*omega**2/2.
"""

from bench.arrays import namespace
from bench.effects.shape import Shapes
from bench.effects.signals import Axis, Number, Signals, Values
from bench.effects.torque import Inertia
from bench.effects.waves import PHASE, Wave, harmonics, phase_angle, turned
from bench.trace.filter import Column
from bench.units import Quantity


class PositionDependentInertia(Wave, Inertia):
    name = "position_dependent_inertia"
    summary = "inertia varies with position, with its velocity-squared torque"
    shapes = (harmonics(1, 4),)
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.0, null=0.0),
        shapes[0].quantity,
        PHASE,
    )

    def unit(self, base: Axis) -> float:
        return base.inertia

    def inertia(self, values: Values, axis: Axis, position: Number) -> tuple[Number, Number]:
        angle, amplitude = phase_angle(values, position), axis.inertia * values["relative_amplitude"]
        xp = namespace(angle)
        return amplitude * xp.sin(angle), amplitude * values["harmonic"] * xp.cos(angle)

    def columns_of(self, signals: Signals, shapes: Shapes) -> list[Column]:
        """Of several harmonics, whose waves are made at once."""
        columns, energy = list[Column](), -0.5 * signals.velocity**2
        for number, (sine, cosine) in turned(signals.position, [shape[0] for shape in shapes]):
            less = number * energy
            columns += [[(sine * signals.velocity, 1), (cosine * less, 0)]]
            columns += [[(cosine * signals.velocity, 1), (-sine * less, 0)]]
        return columns


EFFECT = PositionDependentInertia()
