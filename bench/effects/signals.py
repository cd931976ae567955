"""What effects are given of a recording: raw samples of a stretch, and what the recording is able to show."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bench.arrays import Array
from bench.axis_kind import AxisKind
from bench.trace.filter import Column


@dataclass(frozen=True)
class Signals:
    """Raw samples of one stretch of a recording, all (n,).

    Attributes:
        time: since the recording's start - s.
        position: rad (m); from speed by the trapezoidal rule where it is not recorded.
        velocity: rad/s (m/s).
        sign: sgn(omega), 0 where noise may have made it.
        effort: motor torque as reported - N*m (N).
        torque: motor torque as it acts, which a lag of the current loop delays - N*m (N).
        friction: level of dry friction with its sign, as share of K_0: sgn(omega), or what a named effect makes of it;
            effects that scale dry friction multiply it.
        peak_effort: effort at the motor's peak current - N*m (N); the recording's largest where the rig tells none.
        sample_period: s.
        source: signal that speed and acceleration are taken from, `velocity` or `position`.
        load: torque of the load as named effects make it - N*m (N).
        began: the recording, since the start of the first of several that are joined - s.
        known: torque that is known to act beside - N*m (N) -, as a column; () where none is.
    """

    time: Array
    position: Array
    velocity: Array
    sign: Array
    effort: Array
    torque: Array
    friction: Array
    peak_effort: float
    sample_period: float
    source: str = "velocity"
    load: Array | float = 0.0
    began: float = 0.0
    known: Column = ()


@dataclass(frozen=True)
class Base:
    """What the torque balance without effects has: J - kg*m**2 (kg), K_w - N*m*s/rad (N*s/m), K_0 - N*m (N)."""

    inertia: float
    viscous: float
    coulomb: float


@dataclass(frozen=True)
class Scope:
    """What a recording is able to show, as far as effects have to know it.

    Attributes:
        kind: of the axis.
        source: signal that speed and acceleration are taken from, `velocity` or `position`.
        signals: names of all that is recorded.
        one_way: whether the axis moves in one direction only.
        duration: of the recording, the longest of several that are joined - s.
        sample_period: s.
        latched: within what time torque and speed were taken: one tick of a drive, else one sample - s.
        drift: standard deviation of a position that was integrated from noisy speed, 0 of a recorded one - rad (m).
        width: of the filter, its standard deviation - s.
        travel: from the lowest to the highest position - rad (m).
        top_speed, rms_speed: rad/s (m/s).
        peak_effort: as `Signals` has it - N*m (N).
        rotor_inertia: of the motor alone, 0 where the rig does not tell - kg*m**2 (kg).
    """

    kind: AxisKind
    source: str
    signals: frozenset[str]
    one_way: bool
    duration: float
    sample_period: float
    latched: float
    drift: float
    width: float
    travel: float
    top_speed: float
    rms_speed: float
    peak_effort: float
    rotor_inertia: float

    @property
    def spacing(self) -> float:
        """Distance of wave numbers that the travel just tells apart: half a cycle over it - 1 (rad/m)."""
        return math.pi / self.travel
