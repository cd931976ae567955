"""Lag of the reported speed, read from position and speed of the same recording."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.diagnose.workbench import Workbench
from bench.effects.velocity_filter_lag import VelocityFilterLag
from bench.trace.filter import GaussianFilter
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: A lag shorter than this share of the sample period is how a drive differences its encoder, not a filter.
LEAST_SHARE = 0.6
#: Disagreement of speed and position above what their noise makes, and the share of it that a lag must explain.
DISAGREE, EXPLAINED = 1.5, 0.7


@dataclass(frozen=True)
class VelocityLag:
    """Reported speed as a first-order lag of the motion: omega_reported + T*d(omega_reported)/dt = dq/dt.

    Attributes:
        time_constant: T - s.
        std_error: s.
        before, after: RMS of dq/dt less reported speed over what noise makes of it, without and with the lag.
    """

    time_constant: float
    std_error: float
    before: float
    after: float


def unlagged(trace: Trace, lag: VelocityLag) -> Trace:
    """The recording with the speed that its reported one lags behind, omega = v + T*dv/dt."""
    effect = VelocityFilterLag()
    values, speed = {"time_constant": lag.time_constant}, trace["velocity"].copy()
    for part in trace.segments:
        speed[part] = effect.unfiltered(values, speed[part], trace.sample_period)
    return trace.with_signals({"velocity": speed}, {})


def velocity_lag(trace: Trace, bench: Workbench) -> VelocityLag | None:
    """The lag, None where the recording holds only one of the two or they agree."""
    if "position" not in trace or "velocity" not in trace:
        return None
    smooth = GaussianFilter(max(bench.conditioning.filter.width, 1.5 * trace.sample_period), trace.sample_period)
    moved, reported, slope = [], [], []
    for part in trace.segments:
        if part.stop - part.start > 4 * smooth.margin:
            moved.append(smooth(trace["position"][part], 1)[0])
            level, rate = smooth(trace["velocity"][part], 0, 1)
            reported.append(level)
            slope.append(rate)
    rate = np.concatenate(slope)
    difference = np.concatenate(moved) - np.concatenate(reported)
    difference = difference - difference.mean()
    noise = {name: white_noise(trace[name]) for name in ("position", "velocity")}
    floor = np.hypot(noise["position"] * smooth.noise_gain(1), noise["velocity"] * smooth.noise_gain(0))
    power = float(rate @ rate) - rate.size * (noise["velocity"] * smooth.noise_gain(1)) ** 2
    lag = float(rate @ difference) / max(power, 1e-300)
    rest = difference - lag * rate
    rest_floor = np.hypot(floor, lag * noise["velocity"] * smooth.noise_gain(1))
    before, after = float(np.sqrt(np.mean(difference**2)) / floor), float(np.sqrt(np.mean(rest**2)) / rest_floor)
    explained = 1.0 - float(rest @ rest) / max(float(difference @ difference), 1e-300)
    if before < DISAGREE or explained < EXPLAINED or lag < LEAST_SHARE * trace.sample_period:
        return None
    return VelocityLag(lag, float(np.sqrt(np.mean(rest**2) / max(power, 1e-300) * 4.0)), before, after)
