"""Coupling of motor and load from two positions of one recording: stiffness, damping, backlash, transmission error.

    M - J_m*a = K_w*w + K_0*sgn(w) + M_0 - s*dM/dt + (k*z + d*dz/dt)/i
    z = u - clip(u - c, -g/2, g/2) - c,   u = q/i - q_l - e

M, q, w, a - torque, position, speed, acceleration of the motor; s - shift of the torque; q_l - position of the load -
rad (m); i - gear ratio; k, d - stiffness, damping on the load's side - N*m/rad, N*m*s/rad; g, c - gap of the teeth and
its middle - rad; e - transmission error, a sine and a cosine of the position of load and motor.

The motor's balance alone needs no property of the load. Below the resonance the twist follows the acceleration, so J_m
is taken from the rig where it is stated. Gap and middle are searched; all others are linear.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.errors import UndeterminedError
from bench.fit.regression import DETERMINED, filtered, regressed
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter
from bench.trace.motion import ONE_SIGN, Conditioning, condition, known_sign, raw_speed
from bench.trace.noise import resolution, white_noise
from bench.trace.trace import Trace

WHAT, RECORD = "stiffness of the coupling", "quick reversals at high torque, or a finer encoder of the load"
ALIKE = "the twist follows the acceleration; state motor.rotor_inertia in the rig"
#: Gaps and middles tried, over the range of the twist, and tries of the search that follows, and where it ends.
GAPS, MIDDLES, TRIES, NEAR = 10, 5, 120, 2e-5
#: By how much squares of independent rows must fall, in residual variances, for a gap; steps of both encoders in it.
CLEAR, STEPS = 30.0, 2.0
SIDES = "position", "load_position"
#: Share of the range of the twist by which a gap is moved for its derivative.
MOVED = 0.01


@dataclass(frozen=True)
class Twist:
    """Twist of a recording and the motor's balance around it.

    Attributes:
        trace, at: the recording and its filter.
        twist: on the load's side - rad (m) - (n,).
        ratio: of the gear.
        inertia: of the motor, where it is known - kg*m**2 (kg); else 0, and the acceleration is a column.
        moving: rows with a known direction (m,).
        columns: of the balance without the coupling: (a), w, sgn(w), 1, waves, dM/dt, and the torque (k + 1, r).
        waves: of the transmission error among them.
    """

    trace: Trace
    at: Conditioning
    twist: Array
    ratio: float
    inertia: float
    moving: NDArray[np.bool_]
    columns: Array
    waves: int

    @classmethod
    def of(cls, trace: Trace, rig: Rig, effort: Array) -> Twist:
        """Of a recording with a motor torque (n,)."""
        ratio, at = rig.gear_ratio, condition(trace, effort)
        source, load, inertia = trace[at.source], trace["load_position"], rig.motor.inertia
        sign = known_sign(raw_speed(source, at.source, trace.sample_period), at.sign_threshold)
        turns = [load, *([trace["position"]] if ratio != 1.0 else [])] if rig.axis_kind.turns else []
        waves = [wave(angle) for angle in turns for wave in (np.sin, np.cos)]
        signals = source, source, sign, np.ones(len(trace)), *waves, effort, effort
        _, table = filtered(trace, at.filter, signals, (at.order + 1, at.order, *[0] * (len(waves) + 2), 1, 0))
        table[-1] -= inertia * table[0]
        moving = np.abs(table[2]) > 1.0 - ONE_SIGN
        columns = table[1 if inertia else 0 :, moving]
        return cls(trace, at, trace["position"] / ratio - load, ratio, inertia, moving, columns, len(waves))

    def beyond(self, gap: float, middle: float) -> Array:
        """Twist beyond a gap, and its rate (2, r)."""
        free = self.twist - middle
        pushed = free - np.clip(free, -0.5 * gap, 0.5 * gap)
        return filtered(self.trace, self.at.filter, (pushed, pushed), (0, 1))[1][:, self.moving]

    def squares(self, place: Array) -> float:
        """Squared residual with a gap and its middle - (N*m)**2 (N**2)."""
        table = np.vstack([self.beyond(abs(float(place[0])), float(place[1])), self.columns[:-1]]).T
        residual = self.columns[-1] - table @ np.linalg.lstsq(table, self.columns[-1], rcond=None)[0]
        return float(residual @ residual)

    def gap(self) -> tuple[float, float]:
        """Gap and its middle of the smallest residual - rad (m); a gap of 0 where it explains no more than chance."""
        from scipy.optimize import minimize  # 0.2 s, which only a second encoder has to pay

        low, high = np.quantile(self.twist, (0.005, 0.995))
        reach, centre = high - low, 0.5 * (low + high)
        tried = [
            np.array([gap, middle])
            for gap in np.linspace(0.0, 0.95, GAPS) * reach
            for middle in centre + np.linspace(-0.1, 0.1, MIDDLES) * reach
        ]
        begun = min(tried, key=self.squares)
        around = begun + np.array([[0.0, 0.0], [0.1 * reach, 0.0], [0.0, 0.05 * reach]])
        ends = {"xatol": NEAR * reach, "fatol": NEAR * self.squares(begun)}
        options = {"maxfev": TRIES, "initial_simplex": around, **ends}
        found = minimize(self.squares, begun, method="Nelder-Mead", options=options)
        gap, middle, smooth = abs(float(found.x[0])), float(found.x[1]), self.at.filter
        rows = self.columns.shape[1] * smooth.stride * smooth.sample_period / (2.0 * math.sqrt(math.pi) * smooth.width)
        without = self.squares(np.array([0.0, centre]))
        step = resolution(self.trace["position"]) / self.ratio + resolution(self.trace["load_position"])
        if rows * (without / max(found.fun, 1e-300) - 1.0) < CLEAR or gap < STEPS * step:
            return 0.0, centre
        return gap, middle

    def noise(self, share: float) -> Array:
        """Covariance of the noise in the columns, of a twist that is pushed for a share of the time."""
        size, smooth = 1 + len(self.columns), self.at.filter
        loud = [white_noise(*(self.trace[name][part] for part in self.trace.segments)) for name in SIDES]
        order, found = self.at.order, np.zeros((size, size))
        motion = [(order + 1, 1.0)] * (not self.inertia) + [(order, 1.0)]
        twist = [(0, share / self.ratio), (1, share / self.ratio)]
        found[:2, :2] = _noise(smooth, loud[1], [(0, share), (1, share)])
        found[-1, -1] = (self.at.effort_noise * smooth.noise_gain(1)) ** 2
        if self.at.source == "position":
            last = 2 + len(motion)
            found[:last, :last] += _noise(smooth, loud[0], [*twist, *motion])
            return found
        found[:2, :2] += _noise(smooth, loud[0], twist)
        last = slice(2, 2 + len(motion))
        found[last, last] += _noise(smooth, self.at.source_noise, motion)
        return found


def _noise(smooth: GaussianFilter, size: float, made: Sequence[tuple[int, float]]) -> Array:
    """Covariance of derivatives of one white noise, of some orders and factors (p, p): of j**(a - b)*w**(a + b)."""
    found = np.zeros((len(made), len(made)))
    for k, (one, by) in enumerate(made):
        for other, (order, times) in enumerate(made):
            if (one + order) % 2 == 0:
                sign = -1.0 if (one - order) % 4 else 1.0
                found[k, other] = sign * by * times * (size * smooth.noise_gain((one + order) // 2)) ** 2
    return found


def coupling(trace: Trace, rig: Rig) -> Mapping[str, Parameter]:
    """Of a recording with both positions, by name; UndeterminedError without a torque, or where no stiffness shows."""
    kind = rig.axis_kind
    effort, unit = rig.effort(trace)
    if unit != kind.effort_unit:
        record = f"the same, with motor.{kind.effort}_constant in the rig"
        raise UndeterminedError(WHAT, f"the {kind.effort} is in {unit}", record)
    of = Twist.of(trace, rig, effort)
    gap, middle = of.gap()
    pushed = of.beyond(gap, middle)
    table, noise = np.vstack([pushed, of.columns]), of.noise(float(np.mean(np.abs(of.twist - middle) > 0.5 * gap)))
    if gap:
        step = MOVED * float(np.ptp(of.twist))
        stiff = float(np.linalg.lstsq(table[:-1].T, table[-1], rcond=None)[0][0])
        moved = of.beyond(gap + step, middle)[0], of.beyond(gap, middle + step)[0]
        table = np.insert(table, -1, [stiff * (one - pushed[0]) / step for one in moved], axis=0)
        noise = np.pad(noise, (0, 2))
    time = filtered(trace, of.at.filter, (trace.time,), (0,))[0][of.moving]
    found = regressed(time, table, noise, of.at.effort_noise, of.at.filter, ALIKE)
    return _named(found, of, gap, rig)


def _named(found: Sequence[Parameter], of: Twist, gap: float, rig: Rig) -> dict[str, Parameter]:
    """Parameters of the coupling, on the load's side, from the coefficients of the motor's balance."""
    kind, ratio = rig.axis_kind, of.ratio
    known = {
        name: replace(one.times(ratio), unit=f"{kind.effort_unit}{part}/{kind.length_unit}")
        for (name, part), one in zip({"stiffness": "", "damping": "*s"}.items(), found, strict=False)
    }
    stiffness = known["stiffness"]
    if not 0.0 < stiffness.half_width < DETERMINED * stiffness.value:
        raise UndeterminedError(WHAT, f"it would be {stiffness}", RECORD)
    if gap:
        wide = found[-2].half_width
        known["backlash_gap"] = Parameter(
            gap, kind.length_unit, found[-2].std_error, (max(gap - wide, 0.0), gap + wide)
        )
    first = 2 + (not of.inertia) + 3
    for name, place in zip(("load", "motor"), range(first, first + of.waves, 2), strict=False):
        pair = found[place : place + 2]
        size = math.hypot(*(one.value for one in pair)) * ratio / stiffness.value
        wide = max(one.half_width for one in pair) * ratio / stiffness.value
        if size > wide:
            known[f"transmission_error_per_{name}_turn"] = Parameter.around(size, kind.length_unit, wide / 2.0, wide)
    return known
