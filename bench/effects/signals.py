"""What effects are given: samples of a recording and what it can show; a simulated axis and its state in a step.

What belongs to a simulation is numbers, or arrays (k,) of axes side by side, of any library of the array API standard.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from bench.arrays import Array, spline
from bench.axis_kind import AxisKind
from bench.trace.filter import Column

#: A number, or an array (k,): those of the array API standard have no static type in common.
Number = Any
#: Values of an effect's quantities by their names - SI.
Values = Mapping[str, Number]
#: Least inertia of links along a recording over that in the configuration of the MJCF.
LEAST_LINK = 0.1


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
        friction: level of dry friction with its sign, as share of K_0: sgn(omega), or as changed by a named effect;
            effects that scale dry friction multiply it.
        peak_effort: effort at the motor's peak current - N*m (N); the recording's largest where the rig has none.
        sample_period: s.
        source: signal that speed and acceleration are taken from, `velocity` or `position`.
        load: torque of the load as named effects make it - N*m (N).
        began: the recording, since the start of the first of several that are joined - s.
        known: other known torque - N*m (N) -, as a column; () where none is.
        known_inertia: by which the momentum in that has the noise of the speed - kg*m**2 (kg) - (n,).
        known_slope: by which it differs where the load is not where the motor is - N*m/rad (N/m) - (n,).
        link_inertia: of the links on which it acts, as the motor has it - kg*m**2 (kg); 0 where it acts on none.
        of_motion: what the motion takes from the effort before it is `effort` - N*m (N) -: induced voltage, a known
            weight. A shift of the effort's signal against the motion does not move it.
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
    known_inertia: Array | float = 0.0
    known_slope: Array | float = 0.0
    link_inertia: float = 0.0
    of_motion: Array | float = 0.0

    @property
    def state(self) -> AxisState:
        """State of the axis at the samples; friction has its sign."""
        effort, friction, step = self.torque, self.friction, self.sample_period
        return AxisState(
            self.time, self.position, self.velocity, effort, self.began, self.load, friction=friction, step=step
        )

    @property
    def unit(self) -> Axis:
        """The axis of J = K_w = K_0 = 1, for which a strength is the quantity itself."""
        return Axis(1.0, 1.0, 1.0, peak_effort=self.peak_effort)

    @cached_property
    def carried(self) -> Array:
        """Known torque - N*m (N) - (n,)."""
        parts = [np.gradient(values, self.sample_period) if order else values for values, order in self.known]
        return np.sum(parts, axis=0) if parts else np.zeros_like(self.time)

    @cached_property
    def heavier(self) -> Array:
        """Inertia of the links, as a payload and where they are make it, over `link_inertia` (n,); 1 without."""
        if not self.known or not self.link_inertia > 0.0:
            return np.ones_like(self.time)
        known = np.broadcast_to(self.known_inertia, self.time.shape)
        return np.maximum(1.0 + known / self.link_inertia, LEAST_LINK)

    def pull(self, heavier: Array | float) -> tuple[Array, Array] | None:
        """Deceleration of links by known torque on them - rad/s**2 (m/s**2) -, and its slope - 1/s**2 -; None of none.

        That of links as heavy as given, as `heavier`, where the motor is, and by how much it grows as they are ahead:
        (n,) each. Where they are heavier still, they are so along the motor's motion.
        """
        if not self.known or not self.link_inertia > 0.0:
            return None
        inertia = heavier * self.link_inertia
        own = (inertia - self.link_inertia) * np.gradient(self.velocity, self.sample_period)
        return (self.carried - own) / inertia, np.broadcast_to(self.known_slope, self.time.shape) / inertia

    def reaction(self, twist: Array) -> Column:
        """Torque of links that are ahead by a twist p - rad (m) (n,) -, d(m*dp/dt)/dt, m as `heavier` has it."""
        if not self.known:
            return [(twist, 2)]
        return [(self.heavier * twist, 2), (-np.gradient(self.heavier, self.sample_period) * twist, 1)]

    @cached_property
    def course(self) -> Array:
        """Speed between samples, by powers of shares of a sample - rad/s (m/s) - (k, n - 1): that of a cubic spline.

        The spline runs through the signal that speed is taken from.
        """
        if self.source == "velocity":
            return spline(self.velocity)
        return spline(self.position)[1:] * np.array([[1.0], [2.0], [3.0]]) / self.sample_period


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
        rotor_inertia: of the motor without load, 0 where the rig has none - kg*m**2 (kg).
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
        """Distance of wave numbers that the travel just distinguishes: half a cycle over it - 1 (rad/m)."""
        return math.pi / self.travel


@dataclass(frozen=True)
class Winding:
    """Motor winding: k_T - N*m/A (N/A), R - ohm, L - H, K_e - V*s/rad (V*s/m)."""

    torque_constant: Number
    resistance: Number
    inductance: Number
    back_emf_constant: Number


@dataclass(frozen=True)
class Axis:
    """The axis, as far as effects need it; numbers, or arrays (k,). A torque balance gives the first three.

    Attributes:
        inertia: total inertia J - kg*m**2 (kg).
        viscous: K_w - N*m*s/rad (N*s/m).
        coulomb: K_0 - N*m (N).
        motor_inertia: its part on the motor's side of a coupling - kg*m**2 (kg).
        peak_effort: motor torque at peak current - N*m (N).
        winding: None if the rig does not give it.
    """

    inertia: Number
    viscous: Number
    coulomb: Number
    motor_inertia: Number = 0.0
    peak_effort: Number = math.inf
    winding: Winding | None = None


class AxisState(NamedTuple):
    """State of an axis that a torque without memory depends on: at the middle of a step (k,), or at samples (n,).

    Attributes:
        time: since the recording's start - s.
        position: rad (m).
        velocity: rad/s (m/s).
        effort: torque that reaches the stage of the effect - N*m (N).
        began: start of the recording, counted from that of the first where several are joined - s.
        load: resisting torque of the load, as the transmission carries it, where friction follows it - N*m (N).
        friction: level of dry friction that other effects make - N*m (N).
        direction: of the motion for which a level of friction is wanted, 1 or -1.
        step: over which a torque is averaged - s.
    """

    time: Number
    position: Number
    velocity: Number
    effort: Number
    began: Number = 0.0
    load: Number = 0.0
    friction: Number = 0.0
    direction: float = 1.0
    step: float = 0.0

    def of_direction(self, direction: float) -> AxisState:
        """The same in a direction; `_replace` takes twice as long, which a tick of a lone axis feels."""
        return AxisState._make((*self[:7], direction, self.step))

    def of_friction(self, level: Number) -> AxisState:
        """The same at a level of dry friction - N*m (N)."""
        return AxisState._make((*self[:6], level, *self[7:]))
