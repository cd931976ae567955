"""Motions that show little of an axis, and recordings that show little of a motion."""

from __future__ import annotations

import numpy as np

from bench.validation.independent.references import Motion, Ramps, random_motion, run_up_and_down
from tests.studies.nuisance.nuisance import DURATION, Nuisance

#: Needs many speeds, both directions, or long.
DEMANDING = frozenset(
    {
        *("stribeck_friction", "presliding_friction", "friction_warmup", "load_torque_event", "voltage_limit"),
        *("torque_offset", "direction_dependent_friction", "backlash", "torsion_spring", "load_dependent_friction"),
        *("torque_constant_saturation", "quadratic_drag", "elastic_coupling"),
    }
)


class ShortRecording(Nuisance):
    """The scope's buffer is small."""

    strengths = (0.5, 1.0)
    unit = "s"
    refusal_is_right = True
    unsuited = frozenset({"friction_warmup", "load_torque_event"})

    def motion(self, axis, strength, rng):
        return random_motion(axis, rng, strength)


class OneWay(Nuisance):
    """A conveyor, a spindle, a pump: it never turns back."""

    strengths = (1.0, 3.0)
    unit = "runs"
    refusal_is_right = True
    unsuited = DEMANDING

    def motion(self, axis, strength, rng):
        acceleration = 0.5 * axis.peak_torque / axis.inertia
        tops = axis.top_speed * np.array([0.5, 0.9, 0.7])[: int(strength)]
        points, dwell = [(0.0, 0.0)], 0.15 * DURATION
        for top in tops:
            for speed in (float(top), 0.0):
                time, now = points[-1]
                time += abs(speed - now) / acceleration
                points += [(time, speed), (time + dwell, speed)]
        return Motion((Ramps(points, 0.03),))


class OneProfile(Nuisance):
    """The machine's own motion and no other."""

    strengths = ("trapezoid there and back", "sine")
    refusal_is_right = True
    unsuited = DEMANDING

    def motion(self, axis, strength, rng):
        if strength == "sine":
            return Motion((_Sine(0.7 * axis.top_speed, 1.0, DURATION),))
        acceleration = 0.5 * axis.peak_torque / axis.inertia
        return Motion((run_up_and_down(0.8 * axis.top_speed, acceleration, 0.2 * DURATION, 1, 0.03),))


class _Sine(Ramps):
    """Speed a sine, in and out at rest; so many periods a second."""

    def __init__(self, speed: float, frequency: float, duration: float):
        time = np.linspace(0.0, duration, 4001)
        values = speed * np.sin(2.0 * np.pi * frequency * time)
        super().__init__(list(zip(time, values, strict=True)), 0.02)


class BeginsInMotion(Nuisance):
    """The trigger comes while the axis runs."""

    strengths = (0.5, 0.8)
    unit = "of the largest speed"

    def in_file(self, signals, strength, axis, rng):
        speed = np.abs(signals["velocity"])
        first = int(np.argmax(speed > strength * speed.max()))
        kept = signals.rows(np.arange(first, signals.time.size))
        return kept.stamped(kept.time - kept.time[0])


class SlowMotion(Nuisance):
    """A set-up speed, so as not to hurt anybody: hardly any acceleration."""

    strengths = (0.01, 0.05)
    unit = "of top speed"
    refusal_is_right = True
    unsuited = DEMANDING

    def motion(self, axis, strength, rng):
        top = strength * axis.top_speed
        return Motion((run_up_and_down(top, top / 0.2, 0.15 * DURATION, 2, 0.05),))
