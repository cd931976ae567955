"""Speed and position that are not what their columns say."""

from __future__ import annotations

import numpy as np

from bench.validation.independent.sensors import rounded
from tests.studies.nuisance.nuisance import Nuisance

TURN = 2.0 * np.pi
#: A motion that is reported late, and a torque that acts late.
LAGS = frozenset({"velocity_filter_lag", "current_loop_lag"})
#: What speed and position show only together.
SPEED_LAGS = LAGS | {"encoder_eccentricity"}


class SpeedScaled(Nuisance):
    """A wrong gear ratio, pole count or unit in the drive's speed column: it is not the derivative of position."""

    strengths = (0.16, 0.5, 0.6, 6.0)
    unit = "times"
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        return signals.but(velocity=strength * signals["velocity"]).without("velocity_reference", "position_reference")


class SpeedScaledPositionWrapped(SpeedScaled):
    """The same beside a single-turn encoder, whose position jumps at each turn."""

    strengths = (0.5, 6.0)

    def in_file(self, signals, strength, axis, rng):
        return super().in_file(signals.but(position=np.mod(signals["position"], TURN)), strength, axis, rng)


class SpeedGain(SpeedScaled):
    """An analogue tachometer or a rounded gear ratio: speed some per cent off position's derivative."""

    strengths = (0.98, 1.05)


class PositionWrapped(Nuisance):
    """A single-turn encoder, or a modulo axis of some turns."""

    strengths = (1.0, 4.0)
    unit = "turns"

    def in_file(self, signals, strength, axis, rng):
        return signals.but(position=np.mod(signals["position"], strength * TURN)).without("position_reference")


class NoPosition(Nuisance):
    """The scope had no channel left for position, or none for references either."""

    strengths = ("with references", "without references")

    def in_file(self, signals, strength, axis, rng):
        kept = signals.without("position", "position_reference")
        return kept if strength == "with references" else kept.without("velocity_reference")


class PositionOnly(Nuisance):
    """No speed column, only counts of an encoder."""

    strengths = (16.0, 20.0)
    unit = "bit"
    unsuited = SPEED_LAGS

    def in_file(self, signals, strength, axis, rng):
        coarse = rounded(signals["position"], TURN / 2**strength)
        return signals.but(position=coarse).without("velocity")


class DifferencedSpeed(Nuisance):
    """A cheap drive reports the difference of two encoder counts over a sample period as speed."""

    strengths = (12.0, 14.0)
    unit = "bit"

    def in_file(self, signals, strength, axis, rng):
        counts = rounded(signals["position"], TURN / 2**strength)
        speed = np.diff(counts, prepend=counts[:1]) / float(np.median(np.diff(signals.time)))
        return signals.but(position=counts, velocity=speed)


class EncoderInterpolation(Nuisance):
    """Sine and cosine of unequal size: the position errs with each line of the encoder, speed by its derivative."""

    strengths = (0.005, 0.01)
    unit = "of a line, 256 lines"
    remainder_is_right = True

    def exact(self, fine, strength, axis, rng):
        lines, phase = 256, rng.uniform(-np.pi, np.pi)
        error = strength * TURN / lines
        angle = lines * fine["position"] + phase
        return fine.but(
            position=fine["position"] + error * np.sin(angle),
            velocity=fine["velocity"] * (1.0 + error * lines * np.cos(angle)),
        )


class SpeedOffset(Nuisance):
    """A tachometer's amplifier is off zero: standing still reads as turning."""

    strengths = (0.002, 0.01)
    unit = "of top speed"
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        return signals.but(velocity=signals["velocity"] + strength * axis.top_speed)


class SpeedClipped(Nuisance):
    """The speed channel's range is too small."""

    strengths = (0.6, 0.9)
    unit = "of the largest"
    refusal_is_right = True
    remainder_is_right = True

    def in_file(self, signals, strength, axis, rng):
        most = strength * np.abs(signals["velocity"]).max()
        return signals.but(velocity=np.clip(signals["velocity"], -most, most))


class SpeedHeld(Nuisance):
    """Speed comes over a slower bus than current and is held in between: on average it does lag the motion."""

    strengths = (2.0, 4.0)
    unit = "samples"
    refusal_is_right = True
    right_names = LAGS
    unsuited = SPEED_LAGS

    def in_file(self, signals, strength, axis, rng):
        held = np.arange(signals.time.size) // int(strength) * int(strength)
        return signals.but(velocity=signals["velocity"][held])


class PositionLate(Nuisance):
    """Position is read some time before the sample it is stored with: speed taken from it does lag the motion."""

    strengths = (0.5, 1.0)
    unit = "ms"
    right_names = LAGS
    unsuited = SPEED_LAGS

    def exact(self, fine, strength, axis, rng):
        return fine.but(position=np.interp(fine.time - strength * 1e-3, fine.time, fine["position"]))
