"""Elastic coupling: motor and load are joined by a spring and damper (a belt, a bellows, a slender shaft).

    M_c = k*(q_m - q_l) + d*(omega_m - omega_l),  J_m*alpha_m = M - friction - M_c,  J_l*alpha_l = M_c

k - stiffness - N*m/rad (N/m); d - damping - N*m*s/rad (N*s/m); J_m, J_l - inertia on the motor's and on the load's
side - kg*m**2 (kg). Sensor and friction sit at the motor. Resonance at sqrt(k*(1/J_m + 1/J_l)), antiresonance of the
motor at sqrt(k/J_l).
Source: D. Schröder, Elektrische Antriebe - Regelung von Antriebssystemen (two-mass system).
"""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from bench.effects.mjcf import add_coupling_joint
from bench.effects.physics import Axis, Mechanism, Number
from bench.units import Quantity


class ElasticCoupling(Mechanism):
    """See the module."""

    name = "elastic_coupling"
    summary = "motor and load are joined by a spring and damper"
    quantities = (
        Quantity("stiffness", "k", "N*m/rad", lower=0.0),
        Quantity("damping", "d", "N*m*s/rad", lower=0.0),
    )

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Where the effect is absent: a rigid coupling."""
        return {"stiffness": np.inf}

    def defaults(self, axis: Axis) -> Mapping[str, Number]:
        """No damping."""
        return {"damping": 0.0}

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A joint with stiffness and damping between motor and load."""
        joint = add_coupling_joint(spec, name)
        joint.stiffness[0], joint.damping[0] = values["stiffness"], values["damping"]


EFFECT = ElasticCoupling()
