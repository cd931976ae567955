"""Backlash: motor and load are joined through a dead zone (a gear, a worn key).

    M_c = 0 for |p| <= g/2, beyond it k*(|p| - g/2)*sgn(p) + d*dp/dt, never pulling; p = q_m - q_l

g - gap - rad (m); k, d - stiffness - N*m/rad (N/m) - and damping - N*m*s/rad (N*s/m) - of the contact; p - angle of the
motor less that of the load. Sensor and friction sit at the motor. In the balance the load's acceleration less the
motor's is a column of strength J_l, and the load is driven along the recorded motion (`bench.effects.dead_zone`); its
shape is searched as `bench.effects.impacts` has it.
Source: M. Nordin, P.-O. Gutman, Automatica 38 (2002) 1633-1649, sec. 2 (dead zone with stiff contact).
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from bench.arrays import Array
from bench.effects.dead_zone import dead_zone_columns
from bench.effects.effect import Contact, Fitted, Load
from bench.effects.impacts import likeliest_shape, open_torque, spread
from bench.effects.mjcf import Spec, add_coupling_joint
from bench.effects.shape import Shape, Shapes
from bench.effects.signals import Axis, Number, Scope, Signals
from bench.trace.filter import Column
from bench.units import Quantity

#: Contact of a gear whose own is not known: natural frequency against the two inertias - rad/s - and damping ratio.
CONTACT_FREQUENCY, CONTACT_DAMPING_RATIO = 2.0 * np.pi * 200.0, 0.2
#: Impedance of the joint's limit: constant, and so small that stiffness and damping below act unattenuated.
IMPEDANCE = (0.01, 0.01, 1.0, 0.5, 2.0)
#: Gap over what the contact yields to the peak torque, below which it is a damped spring: 0.04 or more of real gaps.
OF_YIELDING = 0.005


class Backlash(Contact):
    name = "backlash"
    summary = "motor and load are joined through a dead zone"
    quantities = (
        Quantity("gap", "g", "rad", lower=0.0, null=0.0),
        Quantity("contact_stiffness", "k", "N*m/rad", lower=0.0, minor=True),
        Quantity("contact_damping", "d", "N*m*s/rad", lower=0.0, minor=True),
    )
    shapes = (  # impacts move in jumps: a smaller step of a derivative would see only one
        Shape(quantities[0], reach=0.0, step=3e-3),
        Shape(Quantity("contact_frequency", "w_c", "rad/s", lower=0.0), reach=0.0, step=3e-2),
        Shape(Quantity("contact_damping_ratio", "D", "dimensionless", lower=0.0), reach=0.0, step=3e-2),
        Shape(Quantity("spring_rate", "c/J_l", "1/s**2", lower=0.0), reach=0.0, step=0.0),
    )
    replaces = frozenset({"elastic_coupling", "current_loop_lag"})

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return self.columns_of(signals, [shape])

    def columns_of(self, signals: Signals, shapes: Shapes, loads: Sequence[Load] = ()) -> list[Column]:
        """The same; of what acts on the load, a spring's share is a shape of its own."""
        return dead_zone_columns([signals], shapes)[0]

    def tables_of(self, stretches: Sequence[Signals], shapes: Shapes) -> list[list[Column]]:
        """The same, integrated side by side."""
        return dead_zone_columns(stretches, shapes)

    def noise_of_motion(self, shape: Sequence[float], omega: Array) -> Array:
        """The load does not follow it."""
        return -np.ones_like(omega)

    def wave_number(self, shape: Sequence[float]) -> float:
        return 2.0 * np.pi / shape[0]

    def period(self, shape: Sequence[float]) -> float:
        return 2.0 * np.pi / shape[1]

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        """The gap is more than a small part of what its contact yields to the peak torque."""
        return all(  # of shapes whose strength is known
            gap * load * frequency**2 > OF_YIELDING * scope.peak_effort
            for (load,), (gap, frequency, *_) in zip(strengths, shapes, strict=False)
        )

    def open_torque(self, fitted: Fitted, shape: Sequence[float]) -> Array:
        """Rows soon after an impact: its instant depends on how the load left the other side of the gap."""
        return open_torque(fitted, shape)

    def in_place_of(self, fitted: Fitted, promises: Callable[[float], bool]) -> tuple[float, ...] | None:
        return likeliest_shape(fitted, promises)

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        """Gap, and what the contact's frequency and damping ratio are with the load's inertia."""
        gap, contact, ratio, _ = shape
        stiffness = strengths[0] * contact**2
        return {"gap": gap, "contact_stiffness": stiffness, "contact_damping": 2.0 * ratio * stiffness / contact}

    def spread(self, fitted: Fitted, shape: Sequence[float]) -> Array:
        """Of gap, frequency and damping (3, 3), by resampled recordings."""
        return spread(fitted, shape, int(fitted.places(lambda effect: effect is self)[0]))

    def defaults(self, axis: Axis) -> Mapping[str, Number]:
        """A contact that resonates at CONTACT_FREQUENCY; recordings of an axis hardly determine it."""
        motor = np.asarray(axis.motor_inertia)
        reduced = float(motor * (axis.inertia - motor) / axis.inertia)
        return {
            "contact_stiffness": reduced * CONTACT_FREQUENCY**2,
            "contact_damping": 2.0 * CONTACT_DAMPING_RATIO * reduced * CONTACT_FREQUENCY,
        }

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A joint with a range between motor and load; limits take acceleration, hence the inverse inertia."""
        import mujoco

        joint = add_coupling_joint(spec, name)
        inverse = 1.0 / float(axis.motor_inertia) + 1.0 / float(axis.inertia - axis.motor_inertia)
        joint.range = [-0.5 * values["gap"], 0.5 * values["gap"]]
        joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        joint.solref_limit = [-values["contact_stiffness"] * inverse, -values["contact_damping"] * inverse]
        joint.solimp_limit = list(IMPEDANCE)


EFFECT = Backlash()
