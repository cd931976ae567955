"""A reported current that is not the one which made the torque."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from bench.validation.independent.sensors import rounded
from tests.studies.nuisance.nuisance import Nuisance
from tests.studies.nuisance.signals import FINE

LAGS = frozenset({"current_loop_lag", "velocity_filter_lag"})
#: A drifting or wrong zero of the current is a torque, constant but for the drift.
ZERO = frozenset({"torque_offset", "direction_dependent_friction"})


class CurrentFiltered(Nuisance):
    """The drive smooths the current it reports by a first-order filter."""

    strengths = (0.5, 1.0)
    unit = "ms"
    right_names = frozenset({"current_filter_lag"})
    unsuited = LAGS

    def exact(self, fine, strength, axis, rng):
        # current is constant within a control period, so that the filter is exact
        pole = float(np.exp(-FINE / (strength * 1e-3)))
        return fine.but(current=np.asarray(lfilter([0.0, 1.0 - pole], [1.0, -pole], fine["current"])))


class CurrentGainAsymmetry(Nuisance):
    """Two amplifiers, one for each sign: amperes per reading differ."""

    strengths = (0.01, 0.02)
    right_names = frozenset({"current_gain_asymmetry"})
    unsuited = frozenset({"direction_dependent_friction"})

    def in_file(self, signals, strength, axis, rng):
        current = signals["current"]
        return signals.but(current=current * (1.0 + 0.5 * strength * np.sign(current)))


class CurrentTruncated(Nuisance):
    """Integer arithmetic cuts the current off towards zero, to 10 or 20 mA of 5.7 A."""

    strengths = (0.0018, 0.0035)
    unit = "of peak"

    def in_file(self, signals, strength, axis, rng):
        step = strength * axis.peak_current
        return signals.but(current=np.trunc(signals["current"] / step) * step)


class CurrentCoarse(Nuisance):
    """A converter of seven or eight bits."""

    strengths = (0.008, 0.016)
    unit = "of peak"

    def in_file(self, signals, strength, axis, rng):
        return signals.but(current=rounded(signals["current"], strength * axis.peak_current))


class TorqueConstantDrift(Nuisance):
    """Magnets warm, or the sensor's gain drifts: torque per reported ampere falls; the rig's kT holds at the start."""

    strengths = (0.01, 0.02)
    right_names = frozenset({"torque_constant_drift"})
    unsuited = frozenset({"friction_warmup"})

    def exact(self, fine, strength, axis, rng):
        return fine.but(current=fine["current"] * (1.0 + strength * fine.time / fine.time[-1]))


class CurrentOffsetDrift(Nuisance):
    """The zero of the current sensor drifts as it warms."""

    strengths = (0.005, 0.01)
    unit = "of peak"
    right_names = ZERO | {"current_offset_drift"}
    unsuited = ZERO | {"friction_warmup"}

    def exact(self, fine, strength, axis, rng):
        return fine.but(current=fine["current"] + strength * axis.peak_current * fine.time / fine.time[-1])


class CurrentLate(Nuisance):
    """The current is read before the sample that it is stored with: it shows torque late."""

    strengths = (0.25, 0.5)
    unit = "ms"
    right_names = frozenset({"current_filter_lag"})
    unsuited = LAGS

    def exact(self, fine, strength, axis, rng):
        late = np.interp(fine.time - strength * 1e-3, fine.time, fine["current"])
        return fine.but(current=late)


class CurrentEarly(Nuisance):
    """Position and speed arrive after the current they belong to."""

    strengths = (0.25, 0.5)
    unit = "ms"
    right_names = LAGS
    unsuited = LAGS

    def exact(self, fine, strength, axis, rng):
        early = np.interp(fine.time + strength * 1e-3, fine.time, fine["current"])
        return fine.but(current=early)


class CurrentClipped(Nuisance):
    """The current channel's range is too small."""

    strengths = (0.5, 0.8)
    unit = "of the largest"
    refusal_is_right = True
    remainder_is_right = True
    unsuited = frozenset({"torque_constant_saturation"})

    def in_file(self, signals, strength, axis, rng):
        most = strength * np.abs(signals["current"]).max()
        return signals.but(current=np.clip(signals["current"], -most, most))


class CurrentUnit(Nuisance):
    """Amperes read as milliamperes, or the other way round."""

    strengths = (1e-3, 1e3)
    unit = "times"
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        return signals.but(current=strength * signals["current"])


class CurrentSign(Nuisance):
    """Current counted against speed, or only its magnitude recorded."""

    strengths = ("negative", "magnitude")
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        current = signals["current"]
        return signals.but(current=-current if strength == "negative" else np.abs(current))


class CurrentOfAnotherAxis(Nuisance):
    """The scope recorded the wrong drive's current, or the right one's at another time."""

    strengths = ("another axis", "another time")
    refusal_is_right = True

    def exact(self, fine, strength, axis, rng):
        current = fine["current"]
        other = current[::-1] if strength == "another axis" else np.roll(current, current.size // 3)
        return fine.but(current=np.ascontiguousarray(other))


class Hum(Nuisance):
    """Mains in the current's wiring."""

    strengths = (0.003, 0.01)
    unit = "of peak, 50 Hz"
    frequency = 50.0

    def exact(self, fine, strength, axis, rng):
        angle = 2.0 * np.pi * self.frequency * fine.time + rng.uniform(-np.pi, np.pi)
        return fine.but(current=fine["current"] + strength * axis.peak_current * np.sin(angle))


class Pickup(Hum):
    """A neighbour's machine in the current's wiring; no effect of the catalogue."""

    unit = "of peak, 17 Hz"
    remainder_is_right = True
    frequency = 17.0


class HeavyTails(Nuisance):
    """Switching of the inverter in some samples of speed and current: noise far from normal."""

    strengths = (0.002, 0.01)
    unit = "of samples"

    def in_file(self, signals, strength, axis, rng):
        found = {}
        for name, scale in (("velocity", 2e-3 * axis.top_speed), ("current", 0.03 * axis.peak_current)):
            struck = rng.random(signals.time.size) < strength
            found[name] = signals[name] + scale * struck * rng.standard_t(3.0, signals.time.size)
        return signals.but(**found)
