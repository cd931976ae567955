"""What motions an axis can follow: speed, acceleration and travel inside the limits of its rig."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.plant.drive import peak_torque
from bench.plant.model import AxisParameters
from bench.rig.rig import Rig

#: Without a stated speed, profiles run up to the speed that full torque reaches in this time - s.
RUN_UP = 0.1
#: Share of the motor's stated speed, or of its no-load speed (supply voltage over back-EMF constant), that a motion
#: asks for; the rest is for overshoot.
SPEED_SHARE = 0.8
#: Share of peak torque that friction and load may take at top speed; the rest accelerates.
RESISTING_SHARE = 0.5
#: Share of the torque left for acceleration that a motion asks for; the rest is for the controller.
ACCELERATION_SHARE = 0.8
#: Time in which acceleration builds up, as a share of the time to reach top speed: limits the jerk.
RAMP_SHARE = 0.1
#: Travel of a linear axis whose rig states no stroke - m.
TRAVEL = 0.4


@dataclass(frozen=True)
class MotionLimits:
    """Limits of a motion and the period it is planned at.

    Attributes:
        speed: highest - rad/s (m/s on a linear axis).
        acceleration: highest that leaves the controller some torque - rad/s**2 (m/s**2).
        full_acceleration: at peak torque, close to standstill - rad/s**2 (m/s**2).
        travel: from one end to the other - rad (m); infinite on a rotary axis.
        period: of the references - s.
    """

    speed: float
    acceleration: float
    full_acceleration: float
    travel: float
    period: float

    @classmethod
    def from_rig(cls, rig: Rig, parameters: AxisParameters, period: float) -> MotionLimits:
        """Limits from the motor's peak torque and speed, and the inertia and friction it has to overcome.

        Args:
            rig: motor, load and, on a linear axis, its stroke.
            parameters: true or identified.
            period: of the references - s.

        Raises:
            InputError: no peak current or torque, or too little torque for friction and load.
        """
        torque = peak_torque(rig)
        if not np.isfinite(torque):
            raise InputError(f"{rig.source}: motor.peak_current", "missing", "motions are planned inside its torque")
        standing = parameters.coulomb_friction + abs(parameters.load_torque)
        full = (torque - standing) / parameters.inertia
        if standing >= RESISTING_SHARE * torque:
            raise InputError(
                f"{rig.source}: simulation",
                f"found friction and load of {standing:.3g} {rig.effort_unit}",
                f"allowed: below half of the peak torque, {RESISTING_SHARE * torque:.3g} {rig.effort_unit}",
            )
        viscous = parameters.viscous_friction_coefficient
        speed = _stated_speed(rig) or RUN_UP * full
        if viscous > 0.0:
            speed = min(speed, (RESISTING_SHARE * torque - standing) / viscous)
        acceleration = ACCELERATION_SHARE * (torque - standing - viscous * speed) / parameters.inertia
        travel = math.inf if rig.axis_kind.turns else (rig.load and rig.load.stroke) or TRAVEL
        return cls(speed, acceleration, full, travel, period)

    @property
    def ramp_time(self) -> float:
        """Time in which acceleration builds up - s; at least four ticks."""
        return max(RAMP_SHARE * self.speed / self.acceleration, 4.0 * self.period)


def _stated_speed(rig: Rig) -> float | None:
    motor = rig.motor
    speeds = [speed for speed in (motor.maximum_speed or motor.rated_speed,) if speed is not None]
    if motor.supply_voltage is not None and motor.back_emf_constant is not None:
        speeds.append(motor.supply_voltage / motor.back_emf_constant)
    return SPEED_SHARE * min(speeds) if speeds else None
