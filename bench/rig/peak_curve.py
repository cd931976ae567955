"""Peak torque over speed at one mains voltage, as a datasheet draws it."""

from __future__ import annotations

import numpy as np
from pydantic import model_validator

from bench.arrays import Array
from bench.rig.values import Speed, Table, Voltage


class PeakCurve(Table):
    """Peak torque is limited by the magnets up to the corner, and by voltage beyond it, where it falls to zero.

    Attributes:
        mains_voltage: line to line, RMS - V.
        corner_speed: up to which peak torque is available - rad/s (m/s).
        no_load_speed: at which the back-EMF takes all the voltage and torque is zero - rad/s (m/s).
    """

    mains_voltage: Voltage
    corner_speed: Speed
    no_load_speed: Speed

    @model_validator(mode="after")
    def _falls(self) -> PeakCurve:
        if self.corner_speed >= self.no_load_speed:
            raise ValueError("corner_speed must be below no_load_speed")
        return self

    def share(self, speed: Array) -> Array:
        """Share of peak torque available at speeds - rad/s (m/s), any shape: 1 to the corner, then linearly to 0."""
        falling = (self.no_load_speed - np.abs(speed)) / (self.no_load_speed - self.corner_speed)
        return np.clip(falling, 0.0, 1.0)
