"""Elastic coupling: motor and load are joined by a spring and damper (a belt, a bellows, a slender shaft).

    M_c = k*(q_m - q_l) + d*(omega_m - omega_l),  J_m*alpha_m = M - friction - M_c,  J_l*alpha_l = M_c

k - stiffness - N*m/rad (N/m); d - damping - N*m*s/rad (N*s/m); J_m, J_l - inertia on the motor's and on the load's
side - kg*m**2 (kg). Sensor and friction sit at the motor. Resonance at sqrt(k*(1/J_m + 1/J_l)), antiresonance of the
motor at w_a = sqrt(k/J_l). In the balance the load's acceleration less the motor's is a column of strength J_l.
Source: D. Schröder, Elektrische Antriebe - Regelung von Antriebssystemen (two-mass system).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.acting import Native
from bench.effects.axis import Axis
from bench.effects.effect import Coupling, FiltersMotion, Load
from bench.effects.elastic_coupling.twist import twist_columns
from bench.effects.grids import FREQUENCY
from bench.effects.mjcf import add_coupling_joint
from bench.effects.signals import Base, Shape, Signals
from bench.trace.filter import Column
from bench.units import Quantity

if TYPE_CHECKING:  # 0.2 s, needed only to simulate
    import mujoco

#: Antiresonances - rad/s - and damping ratios that a search tries first.
ANTIRESONANCES = tuple(2.0 * np.pi * float(f) for f in np.geomspace(8.0, 110.0, 28))
DAMPINGS = (0.01, 0.04, 0.12)
#: Damping ratio from which a coupling no longer rings, so that nothing tells it from a lag, and the one from which its
#: quality 1/(2*D) is below one, so that hardly anything does; those of the blind set have 0.04 at most. On the way to
#: another coupling a search may pass the latter.
OVERDAMPED, DULL = 1.0, 0.5


class ElasticCoupling(Coupling, FiltersMotion, Native):
    """See the module."""

    name = "elastic_coupling"
    summary = "motor and load are joined by a spring and damper"
    quantities = (
        Quantity("stiffness", "k", "N*m/rad", lower=0.0, null=np.inf),
        Quantity("damping", "d", "N*m*s/rad", lower=0.0, preset=0.0),
    )
    derived = (Quantity("resonance_frequency", "f", "Hz", lower=0.0),)
    shapes = (
        Shape(Quantity("antiresonance", "w_a", "rad/s", lower=0.0), ANTIRESONANCES, reach=0.35, measure=FREQUENCY),
        Shape(Quantity("damping_ratio", "D", "dimensionless", lower=0.0), DAMPINGS, reach=0.35),
    )

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Load's acceleration less the motor's."""
        return twist_columns(signals, [shape], ())

    def columns_of(
        self, signals: Signals, shapes: Sequence[Sequence[float]], loads: Sequence[Load] = ()
    ) -> list[Column]:
        """Load's acceleration less the motor's, with what acts on the load."""
        return twist_columns(signals, shapes, loads)

    def noise_of_motion(self, shape: Sequence[float], omega: Array) -> NDArray[np.complex128]:
        """Load's acceleration over the motor's, less one: (1 + 2*D*s/w_a)/(1 + 2*D*s/w_a + (s/w_a)**2) - 1."""
        s = 1j * omega / shape[0]
        return -(s**2) / (1.0 + 2.0 * shape[1] * s + s**2)

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> bool:
        """It rings, and part of the inertia sits behind it."""
        return shape[1] < OVERDAMPED and super().physical(strengths, shape, base)

    def credible(self, shape: Sequence[float]) -> bool:
        """It rings well enough to be told from a lag."""
        return shape[1] < DULL

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Stiffness J_l*w_a**2, damping 2*D*k/w_a, and the frequency at which both sides resonate."""
        antiresonance, ratio = shape
        load, motor = strengths[0], base.inertia - strengths[0]
        stiffness = load * antiresonance**2
        resonance = np.sqrt(max(stiffness * (1.0 / max(motor, 1e-12) + 1.0 / load), 0.0)) / (2.0 * np.pi)
        loss = 2.0 * ratio * stiffness / antiresonance
        return {"stiffness": stiffness, "damping": loss, "resonance_frequency": float(resonance)}

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A joint with stiffness and damping between motor and load."""
        joint = add_coupling_joint(spec, name)
        joint.stiffness[0], joint.damping[0] = values["stiffness"], values["damping"]


EFFECT = ElasticCoupling()
