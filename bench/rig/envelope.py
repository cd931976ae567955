"""Torque over speed that a log reaches, and the limits of a drive without a datasheet that follow from it.

    |M| <= M_p,    driving:  |M| <= s*(w_0 - |w|)

M_p - largest torque, of current or magnets - N*m (N); w_0 - no-load speed, at which the back-EMF takes all the voltage
- rad/s (m/s); s - slope, kT*Ke/R - N*m*s/rad (N*s/m). Both meet at the corner, w_c = w_0 - M_p/s.

At a limit the torque does not follow its demand: in several stretches of the log the samples are dense along one
straight edge of the point cloud, and only noise exceeds it. Both limits bound a convex region, so they are edges of the
convex hull of the samples. The standard errors count each stretch at a limit as one observation
(cluster-robust covariance). Source: K.-Y. Liang, S. L. Zeger, Biometrika 73 (1986) 13-22.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.errors import InputError, UndeterminedError
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.motion import measured_velocity
from bench.trace.noise import resolution, white_noise
from bench.trace.trace import Trace

#: Deviations of the noise within which a sample is at a limit.
REACH = 3.0
#: Least number of samples of a stretch at a limit, and samples of the running median that removes spikes.
SHORTEST, MEDIAN = 8, 5
#: Samples at each end of a stretch that are not used, as the torque may approach or leave the limit there.
ENDS = 6
#: Least number of stretches at a limit.
STRETCHES = 3
#: Share of the speeds that the samples at the voltage's limit must span, and of the samples that may lie beyond.
SPAN, BEYOND = 0.1, 0.01
#: Span of the trend of the samples at a limit, in deviations of the noise: the torque of a planned motion bends more.
STRAIGHT = 0.5
#: Iterations of choosing the samples near the line and fitting the line to them.
ROUNDS = 8
#: Intervals of the speed in each of which the largest torque is reported.
BINS = 30


@dataclass(frozen=True)
class Limit:
    """A straight limit M = level - slope*w that the samples of several stretches lie on.

    Attributes:
        values: level - N*m (N) - and slope - N*m*s/rad (N*s/m).
        covariances: of both, from the scatter between stretches and from that of the samples (2, 2, 2).
        stretches: how many.
        at: which samples (n,).
    """

    values: Array
    covariances: Array
    stretches: int
    at: NDArray[np.bool_]

    def parameter(self, value: float, slopes: Array, unit: str) -> Parameter:
        """A quantity with these derivatives to level and slope, its interval by Student's t."""
        error = math.sqrt(max(float(slopes @ one @ slopes) for one in self.covariances))  # few stretches may agree
        half = float(scipy.special.stdtrit(self.stretches - 1, 0.975)) * error
        return Parameter(value, unit, error, (value - half, value + half))


@dataclass(frozen=True)
class Envelope:
    """Largest torque over speed of a log, and the limits that it reaches.

    Attributes:
        speed, reached: largest torque while driving in each of BINS intervals of the speed - N*m (N) -, and the speed
            at which it occurs - rad/s (m/s); of intervals with a sample that drives, (b,) each.
        largest, fastest: largest torque, driving or braking - N*m (N) -, and largest speed - rad/s (m/s).
        peak, slope, no_load, corner: M_p, s, w_0 and w_c; None where the log does not reach their limit.
        at_peak, at_voltage: stretches at the two limits.
    """

    speed: Array
    reached: Array
    largest: float
    fastest: float
    peak: Parameter | None
    slope: Parameter | None
    no_load: Parameter | None
    corner: Parameter | None
    at_peak: int
    at_voltage: int

    @property
    def stall(self) -> float | None:
        """Torque at standstill by the limit of the voltage alone, s*w_0 - N*m (N); None without that limit."""
        return None if self.slope is None or self.no_load is None else self.slope.value * self.no_load.value


def envelope_of(trace: Trace, rig: Rig) -> Envelope:
    """The envelope of a recording.

    Raises:
        InputError: neither speed nor position, or no torque in N*m (force in N).
        UndeterminedError: its torque never acts along the motion.
    """
    effort, unit = rig.effort(trace)
    if unit != rig.effort_unit:
        allowed = f"allowed: {rig.effort_unit}; give the rig a motor.torque_constant, or motor.rated_torque"
        raise InputError(trace.origin, f"gives the effort in {unit}", allowed)
    return envelope(measured_velocity(trace), effort, rig.axis_kind.speed_unit, unit)


def envelope(speed: Array, torque: Array, speed_unit: str, torque_unit: str) -> Envelope:
    """The envelope of regular samples: speed (n,) - rad/s (m/s) -, torque (n,) - N*m (N).

    Raises:
        UndeterminedError: its torque never acts along the motion.
    """
    fast, strong = (scipy.ndimage.median_filter(np.abs(values), MEDIAN) for values in (speed, torque))
    noise = _noise(torque), _noise(speed)
    driving = speed * torque > 0.0
    if not driving.any():
        raise UndeterminedError("the limits", "torque never acts along the motion", "a recording that accelerates")
    top = _limit(fast, strong, np.array([strong.max(), 0.0]), noise, np.ones_like(driving))
    below = driving & (strong < (strong.max() if top is None else top.values[0]) - REACH * noise[0])
    line = _voltage(fast, strong, noise, below)
    peak = slope = no_load = corner = None
    if top is not None:
        peak = top.parameter(top.values[0], np.array([1.0, 0.0]), torque_unit)
    if line is not None:
        level, rate = line.values
        slope = line.parameter(rate, np.array([0.0, 1.0]), f"{torque_unit}/({speed_unit})")
        no_load = line.parameter(level / rate, np.array([1.0, -level / rate]) / rate, speed_unit)
        if peak is not None:
            at = (level - peak.value) / rate
            corner = line.parameter(at, np.array([1.0, -at]) / rate, speed_unit)
            corner = corner.widened(peak.half_width / rate)
    place = np.minimum(BINS * fast / fast.max(), BINS - 1).astype(int)
    inside = [np.flatnonzero(driving & (place == k)) for k in range(BINS)]
    most = [every[np.argmax(strong[every])] for every in inside if every.size]
    return Envelope(
        fast[most],
        strong[most],
        float(strong.max()),
        float(fast.max()),
        peak,
        slope,
        no_load,
        corner,
        0 if top is None else top.stretches,
        0 if line is None else line.stretches,
    )


def _noise(values: Array) -> float:
    """Standard deviation of a signal's noise, at least that of its last digit, or a thousandth of its size."""
    return max(white_noise(values), resolution(values) / math.sqrt(12.0), 1e-3 * float(np.abs(values).max()))


def _voltage(fast: Array, strong: Array, noise: tuple[float, float], chosen: NDArray[np.bool_]) -> Limit | None:
    """The falling edge of the convex hull of the samples with most samples along it, if it is a limit."""
    points = np.column_stack([fast[chosen], strong[chosen]])
    if len(points) < STRETCHES * SHORTEST or np.ptp(points, axis=0).min() <= 0.0:
        return None
    corners = points[scipy.spatial.ConvexHull(points).vertices]
    ends = np.roll(corners, -1, axis=0)
    found = []
    for (w1, m1), (w2, m2) in zip(corners, ends, strict=True):  # counter-clockwise: an upper edge goes to lower speeds
        if w1 > w2 and m1 < m2:
            rate = (m2 - m1) / (w1 - w2)
            limit = _limit(fast, strong, np.array([m1 + rate * w1, rate]), noise, chosen)
            if limit is not None and np.ptp(fast[limit.at]) >= SPAN * fast.max() and limit.values[0] > strong.max():
                found.append(limit)  # it meets the largest torque at a positive speed
    return max(found, key=lambda limit: np.count_nonzero(limit.at), default=None)


def _limit(
    fast: Array, strong: Array, start: Array, noise: tuple[float, float], chosen: NDArray[np.bool_]
) -> Limit | None:
    """The line fitted to the samples near it, from a start (2,); None if few stretches follow it or samples exceed it.

    A limit without a slope has the level alone.
    """

    def place(values: Array) -> tuple[Array, float, NDArray[np.intp]]:
        """Distances from a line (n,), within which samples are on it, and the stretch that each is of (n,)."""
        away, reach = strong - values[0] + values[1] * fast, REACH * math.hypot(noise[0], values[1] * noise[1])
        return away, reach, _stretches(chosen & (np.abs(away) <= reach))

    values, falls = start, start[1] != 0.0
    for _ in range(ROUNDS):
        stretch = place(values)[2]
        at = stretch >= 0
        if stretch.max(initial=-1) + 1 < STRETCHES:
            return None
        before, values = values, np.array([strong[at].mean(), 0.0])
        if falls:
            rate = float(np.cov(fast[at], strong[at])[0, 1] / np.var(fast[at], ddof=1))
            values = np.array([values[0] - rate * fast[at].mean(), -rate])
        if np.allclose(before, values, rtol=1e-9):
            break
    away, reach, stretch = place(values)
    at, count = stretch >= 0, int(stretch.max(initial=-1)) + 1
    if count < STRETCHES or (falls and not values[1] > 0.0):
        return None
    along = chosen & (fast >= fast[at].min()) & (fast <= fast[at].max())
    under = np.count_nonzero(along & (away < -reach) & (away >= -3.0 * reach))
    if np.count_nonzero(along & (away > reach)) > BEYOND * at.sum() or under > at.sum():
        return None
    if rms(away[at]) > reach / REACH or _trend(fast[at], away[at]) > STRAIGHT * reach / REACH:
        return None
    columns = np.column_stack([np.ones(at.sum()), -fast[at] if falls else np.zeros(at.sum())])
    bread = np.linalg.pinv(columns.T @ columns)
    scores = np.zeros((count, 2))
    np.add.at(scores, stretch[at], columns * away[at, None])
    by_stretch = count / (count - 1) * bread @ scores.T @ scores @ bread
    covariances = np.stack([by_stretch, MEDIAN * rms(away[at]) ** 2 * bread]).astype(np.float64)
    return Limit(values, covariances, count, at)


def _trend(x: Array, y: Array) -> float:
    """Span of the parabola through points (n,) - unit of y."""
    along = np.linspace(x.min(), x.max(), 50)
    return float(np.ptp(np.polynomial.Polynomial.fit(x, y, 2)(along)))


def _stretches(at: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Number of the stretch that each sample belongs to (n,), -1 of those outside and of short ones."""
    labels, count = scipy.ndimage.label(scipy.ndimage.binary_erosion(at, np.ones(2 * ENDS + 1)))
    sizes = np.bincount(labels, minlength=count + 1)
    sizes[0] = 0
    number = np.cumsum(sizes >= SHORTEST) - 1
    return np.where(sizes[labels] >= SHORTEST, number[labels], -1)
