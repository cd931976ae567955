"""Velocity filter lag: the reported velocity lags the motion.

    T*dv/dt + v = omega

T - time constant - s; v - reported velocity, omega - velocity of the motion - rad/s (m/s). v is what is recorded; the
drive has a velocity of its own, without the filter. Where position is recorded too, T is the slope of dq/dt - v over
dv/dt.
Source: W. Leonhard, Control of Electrical Drives (filtered speed feedback).
"""

import numpy as np

from bench.arrays import NORMAL95, rms
from bench.effects.effect import Detected, Lag, smoothed
from bench.effects.signals import Scope
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: A lag below this share of the tick, or of the sample period, is how speed is differenced from positions, no filter.
LEAST_SHARE = 0.6
#: Distance from the lag of a mean over the sample below which a recorder averages - share of the period: means 0.001.
AVERAGED = 0.005
#: Share of the noise of differences of position that remains in a speed which is computed from them.
OF_POSITION = 0.5
#: Disagreement of speed and position above what their noise makes, and the share of it that a lag must explain.
DISAGREE, EXPLAINED = 1.5, 0.7
#: Share of the disagreement that a lag undone may leave and the speed is still of use.
MENDED = 0.1


class VelocityFilterLag(Lag):
    name = "velocity_filter_lag"
    summary = "reported velocity lags the motion"
    filters_motion = True
    signal = "velocity"

    def sought(self, scope: Scope) -> bool:
        """Where only speed is recorded; a recorded position determines the lag by itself."""
        return scope.source == "velocity" and "position" not in scope.signals

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """A lag of the torque, unless position determines that; and one of the current, as the difference shows."""
        return () if "position" in scope.signals else ("current_loop_lag", "current_filter_lag")

    def detect(self, trace: Trace, rig: Rig, width: float) -> Detected | None:
        if not {"position", "velocity"} <= set(trace.signals):
            return None
        smooth = GaussianFilter(max(width, 1.5 * trace.sample_period), trace.sample_period)
        (moved,), (reported, rate) = smoothed(trace, smooth, "position", 1), smoothed(trace, smooth, "velocity", 0, 1)
        if moved.size == 0:
            return None
        difference = moved - reported
        difference = difference - difference.mean()
        noise = {name: white_noise(trace[name]) for name in ("position", "velocity")}
        floor = float(np.hypot(noise["position"] * smooth.noise_gain(1), noise["velocity"] * smooth.noise_gain(0)))
        power = float(rate @ rate) - rate.size * (noise["velocity"] * smooth.noise_gain(1)) ** 2
        lag = float(rate @ difference) / max(power, 1e-300)
        rest = difference - lag * rate
        rest_floor = float(np.hypot(floor, lag * noise["velocity"] * smooth.noise_gain(1)))
        before, after = (rms(off) / max(least, 1e-300) for off, least in ((difference, floor), (rest, rest_floor)))
        explained = 1.0 - float(rest @ rest) / max(float(difference @ difference), 1e-300)
        tick = rig.drive.control_period if rig.drive is not None else 0.0
        least = LEAST_SHARE * (tick if tick and not _of_position(trace) else trace.sample_period)
        if before < DISAGREE or explained < EXPLAINED or lag < least:
            return None
        error = NORMAL95 * float(np.sqrt(np.mean(rest**2) / max(power, 1e-300) * 4.0))
        mean = 0.5 * (trace.sample_period - tick)
        if abs(lag - mean) < AVERAGED * trace.sample_period + error:
            return None
        evidence = {"speed_against_position_before": before, "speed_against_position_after": after}
        errors = {"time_constant": error + 0.5 * tick}
        return Detected({"time_constant": lag}, errors, evidence, mends=after < max(DISAGREE, MENDED * before))


def _of_position(trace: Trace) -> bool:
    """Whether speed is computed from the recorded positions: their noise is in it, too."""
    parts = [part for part in trace.segments if part.stop - part.start > 1]
    differences = [np.diff(trace["position"][part]) / trace.sample_period for part in parts]
    left = [trace["velocity"][part][1:] - made for part, made in zip(parts, differences, strict=True)]
    return white_noise(*left) < OF_POSITION * white_noise(*differences)


EFFECT = VelocityFilterLag()
