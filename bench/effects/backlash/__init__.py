"""Backlash: motor and load are joined through a dead zone (a gear, a worn key).

    M_c = 0 for |p| <= g/2, beyond it k*(|p| - g/2)*sgn(p) + d*dp/dt, never pulling; p = q_m - q_l

g - gap - rad (m); k, d - stiffness - N*m/rad (N/m) - and damping - N*m*s/rad (N*s/m) - of the contact; p - angle of the
motor less that of the load. Sensor and friction sit at the motor. In the balance the load's acceleration less the
motor's is a column of strength J_l; the load follows from the motor's motion, see `bench.effects.backlash.dead_zone`.
Source: M. Nordin, P.-O. Gutman, Automatica 38 (2002) 1633-1649, sec. 2 (dead zone with stiff contact).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.arrays import Array
from bench.effects.acting import Native
from bench.effects.axis import Axis, Number
from bench.effects.backlash.dead_zone import dead_zone_columns
from bench.effects.backlash.likeliest import contact_spread, likeliest_shape
from bench.effects.effect import Contact, Coupling, Fitted, Load, Replacing
from bench.effects.mjcf import add_coupling_joint
from bench.effects.signals import Base, Shape, Signals
from bench.trace.filter import Column
from bench.units import Quantity

if TYPE_CHECKING:  # 0.2 s, needed only to simulate
    import mujoco

#: Contact of a gear whose own is not known: natural frequency against the two inertias - rad/s - and damping ratio.
CONTACT_FREQUENCY, CONTACT_DAMPING_RATIO = 2.0 * np.pi * 200.0, 0.2
#: Impedance of the joint's limit: constant, and so small that stiffness and damping below act unattenuated.
IMPEDANCE = (0.01, 0.01, 1.0, 0.5, 2.0)
#: Factors of gap, frequency and damping within which a recording does not tell a contact from another.
INDISTINCT = (1.01, 1.1, 1.1)


class Backlash(Replacing, Coupling, Contact, Native):
    """See the module."""

    name = "backlash"
    summary = "motor and load are joined through a dead zone"
    quantities = (
        Quantity("gap", "g", "rad", lower=0.0, null=0.0),
        Quantity("contact_stiffness", "k", "N*m/rad", lower=0.0),
        Quantity("contact_damping", "d", "N*m*s/rad", lower=0.0),
    )
    shapes = (  # impacts move in jumps: a smaller step of a derivative would see only one
        Shape(quantities[0], reach=0.0, step=3e-3),
        Shape(Quantity("contact_frequency", "w_c", "rad/s", lower=0.0), reach=0.0, step=3e-2),
        Shape(Quantity("contact_damping_ratio", "D", "dimensionless", lower=0.0), reach=0.0, step=3e-2),
        Shape(Quantity("spring_rate", "c/J_l", "1/s**2", lower=0.0), reach=0.0, step=0.0),
    )
    replaces = frozenset({"elastic_coupling", "current_loop_lag"})

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Load's acceleration less the motor's."""
        return dead_zone_columns(signals, np.array([shape]))

    def columns_of(
        self, signals: Signals, shapes: Sequence[Sequence[float]], loads: Sequence[Load] = ()
    ) -> list[Column]:
        """The same; of what acts on the load, a spring's share is a shape of its own."""
        return dead_zone_columns(signals, np.array(shapes))

    def noise_of_motion(self, shape: Sequence[float], omega: Array) -> Array:
        """The load does not follow it."""
        return -np.ones_like(omega)

    def open_torque(self, fitted: Fitted, shape: Sequence[float]) -> Array:
        """Rows soon after an impact: its instant hangs on how the load left the other side of the gap."""
        shapes = np.tile(shape, (2 * len(INDISTINCT) + 1, 1))
        for k, factor in enumerate(INDISTINCT):
            shapes[2 * k + 1, k] *= factor
            shapes[2 * k + 2, k] /= factor
        columns = fitted.seen(lambda signals: dead_zone_columns(signals, shapes), of_motion=True)
        return np.abs(columns[:, 1:] - columns[:, :1]).max(axis=1)

    def in_place_of(self, fitted: Fitted) -> tuple[float, ...]:
        """By likelihood over gaps and contacts."""
        return likeliest_shape(fitted)

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Gap, and what the contact's frequency and damping ratio are with the load's inertia."""
        gap, contact, ratio, _ = shape
        stiffness = strengths[0] * contact**2
        return {"gap": gap, "contact_stiffness": stiffness, "contact_damping": 2.0 * ratio * stiffness / contact}

    def spread(self, fitted: Fitted, shape: Sequence[float]) -> Array:
        """Of resampled recordings: along the ridge of softer contacts and wider gaps curvature tells nothing."""
        return contact_spread(fitted, np.array(shape), int(fitted.places(Backlash)[0]))

    def defaults(self, axis: Axis) -> Mapping[str, Number]:
        """A contact that resonates at CONTACT_FREQUENCY; recordings of an axis hardly tell it."""
        motor = np.asarray(axis.motor_inertia)
        reduced = float(motor * (axis.inertia - motor) / axis.inertia)
        return {
            "contact_stiffness": reduced * CONTACT_FREQUENCY**2,
            "contact_damping": 2.0 * CONTACT_DAMPING_RATIO * reduced * CONTACT_FREQUENCY,
        }

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A joint with a range between motor and load; limits take acceleration, hence the inverse inertia."""
        import mujoco

        joint = add_coupling_joint(spec, name)
        inverse = 1.0 / float(axis.motor_inertia) + 1.0 / float(axis.inertia - axis.motor_inertia)
        joint.range = [-0.5 * values["gap"], 0.5 * values["gap"]]
        joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        joint.solref_limit = [-values["contact_stiffness"] * inverse, -values["contact_damping"] * inverse]
        joint.solimp_limit = list(IMPEDANCE)


EFFECT = Backlash()
