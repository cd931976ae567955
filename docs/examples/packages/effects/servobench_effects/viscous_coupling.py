"""Viscous coupling: a fluid drags the load along.

    J_l*alpha_l = c*(omega_m - omega_l), so T*alpha_l + omega_l = omega_m with T = J_l/c

c - N*m*s/rad (N*s/m); T - time constant - s; J_l - load's inertia - kg*m**2 (kg). In the balance the load's
acceleration less the motor's is a column of strength J_l.
"""

from bench.effects.effect import Coupling, lagged
from bench.effects.mjcf import add_coupling_joint
from bench.effects.shape import Shape
from bench.units import Quantity


class ViscousCoupling(Coupling):
    """See the module."""

    name = "viscous_coupling"
    summary = "the load is dragged along by a fluid"
    filters_motion = True
    quantities = (Quantity("drag", "c", "N*m*s/rad", lower=0.0, null=float("inf")),)
    shapes = (Shape(Quantity("time_constant", "T", "s", lower=0.0), (2e-3, 5e-3, 0.012, 0.03, 0.08)),)

    def columns(self, signals, shape):
        """Load's acceleration less the motor's."""
        motion, order = (signals.position, 2) if signals.source == "position" else (signals.velocity, 1)
        return [[(lagged(motion, shape[0], signals.sample_period) - motion, order)]]

    def noise_of_motion(self, shape, omega):
        """1/(1 + T*s) - 1."""
        return 1.0 / (1.0 + 1j * omega * shape[0]) - 1.0

    def report(self, strengths, shape, base):
        """c = J_l/T."""
        return {"drag": strengths[0] / shape[0]}

    def add(self, spec, name, values, axis):
        """A joint with nothing but damping between motor and load."""
        add_coupling_joint(spec, name).damping[0] = values["drag"]


EFFECT = ViscousCoupling()
