"""Directional load friction: friction by transmitted torque differs between driving the load and being driven by it.

    M = (K_0 + |K_m*M_motor + K_e*M_load|)*sgn(omega)

K_m, K_e - coefficients on the motor's side and on the load's; M_motor - motor torque, M_load - resisting torque of the
load without its inertia (gravity, a spring) - N*m (N). With K_e = 0 it is load-dependent friction. A gear that drives
its load up passes (1 - K_m) of the motor's torque on and needs (1 + K_e) of the load's; let down, the load gives back
(1 - K_e) of its own: so without a torque of the load K_e is not determined, and it is tried only in the place of
load-dependent friction, with a load that is named.
Source: M. Duclusaud, G. Passault, V. Padois, O. Ly, Extended friction models for the physics simulation of servo
actuators, 2024, arXiv 2410.08650 (model M5; M6 adds squares to its rise at low speed).
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from bench.effects.effect import LOSSIEST, Fitted
from bench.effects.shape import Shape, grid_of
from bench.effects.signals import Axis, AxisState, Number, Values
from bench.effects.torque import Friction, FrictionLaw
from bench.units import Quantity

#: Ratios that are tried, and again between the neighbours of the best.
RATIOS = tuple(float(ratio) for ratio in np.geomspace(0.1, 10.0, 25))


class DirectionalLoadFriction(Friction):
    name = "directional_load_friction"
    summary = "friction by transmitted torque differs between driving and being driven"
    copies_torque = True
    follows_load = True
    quantities = (
        Quantity("motor_coefficient", "K_m", "dimensionless", lower=0.0, upper=LOSSIEST, null=0.0),
        Quantity("load_ratio", "K_e/K_m", "dimensionless", lower=0.0),
    )
    derived = (Quantity("load_coefficient", "K_e", "dimensionless", lower=0.0),)
    shapes = (Shape(quantities[1], RATIOS, reach=0.3),)
    replaces = frozenset({"load_dependent_friction"})

    def friction(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return values["motor_coefficient"] * abs(at.effort + values["load_ratio"] * at.load)

    def in_place_of(self, fitted: Fitted, promises: Callable[[float], bool]) -> tuple[float, ...] | None:
        """The best ratio with a load, or none without one."""
        if not fitted.places(lambda effect: effect.transmitted).size:
            return None
        best = max(fitted.tried(self, grid_of(self.shapes, fitted.scope)), key=lambda tried: tried.gain).shape[0]
        step = RATIOS[1] / RATIOS[0]
        closer = [(best * step**power,) for power in np.linspace(-1.0, 1.0, 25).tolist()]
        return max(fitted.tried(self, closer), key=lambda tried: tried.gain).shape

    def unlike(self, fitted: Fitted) -> tuple[float, ...] | None:
        """As much friction by the load's torque as by the motor's, if there is a load."""
        return (1.0,) if fitted.places(lambda effect: effect.transmitted).size else None

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        motor, ratio = strengths[0], shape[0]
        return {"motor_coefficient": motor, "load_ratio": ratio, "load_coefficient": motor * ratio}

    def law(self, values: Mapping[str, float], axis: Axis) -> FrictionLaw:
        """Of both torques; what the load resists is minus what acts from outside."""
        motor = values["motor_coefficient"]
        return FrictionLaw(motor=motor, external=motor * values["load_ratio"])


EFFECT = DirectionalLoadFriction()
