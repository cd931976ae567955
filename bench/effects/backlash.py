"""Backlash: motor and load are joined through a dead zone (a gear, a worn key).

    M_c = 0 for |p| <= g/2, beyond it k*(|p| - g/2)*sgn(p) + d*dp/dt, never pulling; p = q_m - q_l

g - gap - rad (m); k, d - stiffness - N*m/rad (N/m) - and damping - N*m*s/rad (N*s/m) - of the contact; p - angle of the
motor less that of the load. Sensor and friction sit at the motor.
Source: M. Nordin, P.-O. Gutman, Automatica 38 (2002) 1633-1649, sec. 2 (dead zone with stiff contact).
"""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from bench.effects.mjcf import add_coupling_joint
from bench.effects.physics import Axis, Mechanism, Number
from bench.units import Quantity

#: Contact of a gear whose own is not known: natural frequency against the two inertias - rad/s - and damping ratio.
CONTACT_FREQUENCY, CONTACT_DAMPING_RATIO = 2.0 * np.pi * 200.0, 0.2
#: Impedance of the joint's limit: constant, and so small that stiffness and damping below act unattenuated.
IMPEDANCE = (0.01, 0.01, 1.0, 0.5, 2.0)


class Backlash(Mechanism):
    """See the module."""

    name = "backlash"
    summary = "motor and load are joined through a dead zone"
    quantities = (
        Quantity("gap", "g", "rad", lower=0.0),
        Quantity("contact_stiffness", "k", "N*m/rad", lower=0.0),
        Quantity("contact_damping", "d", "N*m*s/rad", lower=0.0),
    )

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Where the effect is absent: no gap, which is a rigid coupling as far as a recording tells."""
        return {"gap": 0.0}

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
        joint = add_coupling_joint(spec, name)
        inverse = 1.0 / float(axis.motor_inertia) + 1.0 / float(axis.inertia - axis.motor_inertia)
        joint.range = [-0.5 * values["gap"], 0.5 * values["gap"]]
        joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        joint.solref_limit = [-values["contact_stiffness"] * inverse, -values["contact_damping"] * inverse]
        joint.solimp_limit = list(IMPEDANCE)


EFFECT = Backlash()
