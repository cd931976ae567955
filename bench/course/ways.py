"""Ways in which a student's recordings are worked out: the right one, other right ones, and those with a mistake."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import uniform_filter1d
from scipy.signal import butter, filtfilt, savgol_filter

from bench.arrays import Array
from bench.course.methods import DELAY, LEAST_SPEED, WIDTH


@dataclass(frozen=True)
class Way:
    """How the recordings are worked out; the right one without arguments.

    Attributes:
        velocity: factor on the speed in rad/s that should be 1.
        current: factor on the current in A that should be 1.
        constant: torque per ampere at every current, `stall`, `peak` or `zero`; empty for kT(Iq).
        width, set_back: acceleration for least squares is the mean of so many differences, set back by so many samples.
        method: by which it is differentiated instead, one of METHODS; empty for means of differences.
        least: slower samples are left out of least squares - rad/s.
        rpm: factor on speeds in rpm that should be 1.
    """

    velocity: float = 1.0
    current: float = 1.0
    constant: str = ""
    width: int = WIDTH
    set_back: int = DELAY
    method: str = ""
    least: float = LEAST_SPEED
    rpm: float = 1.0

    def and_also(self, other: Way) -> Way | None:
        """Both mistakes at once; None where they are about the same."""
        own, others = self.changed, other.changed
        both_filters = bool(FILTER & own.keys() and FILTER & others.keys())
        return None if own.keys() & others.keys() or both_filters else replace(self, **others)

    @property
    def changed(self) -> dict[str, Any]:
        """What is not as it is right."""
        return {name: value for name, value in vars(self).items() if value != getattr(RIGHT, name)}


RIGHT = Way()
FILTER = {"width", "set_back", "method"}
LOW_PASS: Any = butter(2, 0.15)
#: Derivatives of a speed - rad/s, (n,) at a period - s - that are in step with it: others than means of differences.
METHODS: dict[str, Callable[[Array, float], Any]] = {
    "gradient": np.gradient,
    "Savitzky-Golay": lambda speed, period: savgol_filter(speed, 11, 2, deriv=1, delta=period),
    "filtfilt": lambda speed, period: filtfilt(LOW_PASS[0], LOW_PASS[1], np.gradient(speed, period)),
    "mean of three centred differences": lambda speed, period: uniform_filter1d(np.gradient(speed, period), 3),
    "mean of five centred differences": lambda speed, period: uniform_filter1d(np.gradient(speed, period), 5),
    "spline": lambda speed, period: CubicSpline(np.arange(speed.size), speed)(np.arange(speed.size), 1) / period,
}
#: The mean of four centred differences, which belongs between two samples, on either of them: half a sample late or
#: early.
LATE_METHODS: dict[str, Callable[[Array, float], Any]] = {
    "mean of centred differences, late": lambda speed, period: uniform_filter1d(np.gradient(speed, period), WIDTH),
    "mean of centred differences, early": lambda speed, period: uniform_filter1d(
        np.gradient(speed, period), WIDTH, origin=-1
    ),
}
#: Ways that are right, too: what they give in addition to RIGHT is no mistake.
RIGHT_WAYS = (
    *(Way(width=width, set_back=width // 2) for width in (2, 6, 8)),
    *(Way(method=method) for method in METHODS),
    Way(least=30.0),
)
