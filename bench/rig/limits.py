"""Operating range of a motor: its torque at a speed, briefly and for good, and what a motion leaves of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array, rms
from bench.errors import InputError
from bench.rig.motor import Motor
from bench.rig.peak_curve import PeakCurve

#: Torque this share of the peak torque beyond a limit is still at it: noise of current and speed.
AT_LIMIT = 0.01


@dataclass(frozen=True)
class OperatingRange:
    """Limits of a motor at one mains voltage.

    Attributes:
        peak_torque: limited by the magnets, Mmax - N*m.
        continuous_torque: limited by heat, at standstill, M0 - N*m.
        curve: share of peak torque that voltage leaves at a speed.
        loss: share of continuous torque that speed-dependent losses take up to the no-load speed.
    """

    peak_torque: float
    continuous_torque: float
    curve: PeakCurve
    loss: float

    @classmethod
    def of(cls, motor: Motor, mains: float, where: str) -> OperatingRange:
        """Range of a motor at a mains voltage - V.

        Raises:
            InputError: the motor lacks its torques, or a curve for this voltage; names `where`.
        """
        if motor.peak_torque is None or motor.continuous_stall_torque is None:
            missing = "peak_torque" if motor.peak_torque is None else "continuous_stall_torque"
            raise InputError(f"{where}: motor.{missing}", "missing", "the operating range needs it")
        return cls(
            motor.peak_torque,
            motor.continuous_stall_torque,
            peak_curve(motor, mains, where),
            motor.continuous_torque_loss,
        )

    def peak(self, speed: Array) -> Array:
        """Peak torque at speeds - rad/s, any shape - while the motor drives - N*m."""
        return self.peak_torque * self.curve.share(speed)

    def available(self, speed: Array, torque: Array) -> Array:
        """Peak torque in the direction of a torque - N*m.

        Voltage limits driving only: while braking, the back-EMF helps to drive the current.
        """
        return np.where(speed * torque >= 0.0, self.peak(speed), self.peak_torque)

    def continuous(self, speed: Array) -> Array:
        """Continuous torque at speeds - N*m: M0 less losses that grow in proportion to speed, never above the peak."""
        heated = self.continuous_torque * (1.0 - self.loss * np.abs(speed) / self.curve.no_load_speed)
        return np.minimum(np.maximum(heated, 0.0), self.peak(speed))


@dataclass(frozen=True)
class Reserve:
    """What a motion leaves of the range.

    Attributes:
        peak: least distance of the torque to its limit over the motion - N*m; negative beyond it.
        peak_share: the same as a share of the peak torque.
        at: index of the sample where it is least.
        beyond: share of the samples beyond the limit by more than AT_LIMIT.
        rms_torque: sqrt(mean(M**2)), which heats the winding - N*m.
        mean_speed: mean(|omega|), at which it is compared - rad/s.
        thermal: continuous torque there less the RMS torque - N*m; negative where the motor would overheat.
        thermal_share: the same as a share of the continuous torque there.
    """

    peak: float
    peak_share: float
    at: int
    beyond: float
    rms_torque: float
    mean_speed: float
    thermal: float
    thermal_share: float


def reserve(limits: OperatingRange, speed: Array, torque: Array) -> Reserve:
    """Reserve of a motion that repeats itself, speed - rad/s, torque - N*m, (n,) each."""
    left = limits.available(speed, torque) - np.abs(torque)
    at = int(np.argmin(left))
    effective, mean = rms(torque), float(np.mean(np.abs(speed)))
    allowed = float(limits.continuous(np.asarray(mean)))
    thermal_share = (allowed - effective) / allowed if allowed > 0.0 else -1.0
    return Reserve(
        peak=float(left[at]),
        peak_share=float(left[at]) / limits.peak_torque,
        at=at,
        beyond=float(np.mean(left < -AT_LIMIT * limits.peak_torque)),
        rms_torque=effective,
        mean_speed=mean,
        thermal=allowed - effective,
        thermal_share=thermal_share,
    )


def peak_curve(motor: Motor, mains: float, where: str) -> PeakCurve:
    """The motor's peak curve at a mains voltage - V.

    Raises:
        InputError: the motor has none for it; names `where`.
    """
    for curve in motor.peak_curves:
        if abs(curve.mains_voltage / mains - 1.0) < 1e-6:
            return curve
    known = ", ".join(f"{curve.mains_voltage:g} V" for curve in motor.peak_curves) or "none"
    raise InputError(f"{where}: motor.peak_curves", f"found none for {mains:g} V", f"given are: {known}")
