"""Recordings of the independent axis whose current is damaged as recorders and sensors do it."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter

from bench.diagnosis.diagnosis import diagnose
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from tests.recorded import PLAIN

AXIS = PLAIN.axis
RIG = Rig.of(
    {
        "name": "axis",
        "kind": "rotary",
        "motor": {"torque_constant": "0.7 N*m/A", "rotor_inertia": "5 kg*cm**2", "peak_current": "6 A"},
        "drive": {
            "position_gain": f"{AXIS.position_gain} 1/s",
            "velocity_gain": "0.15 N*m*s/rad",
            "integral_gain": "2 N*m/rad",
            "inertia_feedforward": "14 kg*cm**2",
            "control_period": f"{AXIS.control_period} s",
        },
    }
)
#: A recursive filter of one sample is found in twice as many.
SECONDS = 3.0
SINGLES = {
    "quadratic_drag": (2.5e-5,),
    "cogging_torque": (0.06, 6.0, 0.4),
    "unbalance": (0.15, 0.3),
    "stribeck_friction": (0.2, 3.0),
}
#: What damages are tried on: nothing hidden and one of the singles; the others take longer than they tell.
HIDDEN = (
    None,
    *(pytest.param(name, marks=pytest.mark.slow) if k < len(SINGLES) - 1 else name for k, name in enumerate(SINGLES)),
)
#: Amperes that a current is cut off to.
DIGIT = 0.02


@cache
def recordings(seconds: float = SECONDS) -> dict[str, Trace]:
    """One without an effect, under the name `null`, and one of each single."""
    cases = {"null": (), **{name: (KINDS[name](*values),) for name, values in SINGLES.items()}}
    return PLAIN.record(cases, random_motion(AXIS, np.random.default_rng(11), seconds), 11)


def filtered(current: np.ndarray, time: np.ndarray, lag: float = 1e-3) -> np.ndarray:
    """Behind a recorder's recursive filter."""
    pole = np.exp(-(time[1] - time[0]) / lag)
    return lfilter([1.0 - pole], [1.0, -pole], current, zi=[pole * current[0]])[0]


def late(current: np.ndarray, time: np.ndarray, delay: float = 0.5e-3) -> np.ndarray:
    """Half a millisecond late."""
    return np.interp(time - delay, time, current)


def stale(current: np.ndarray, time: np.ndarray, share: float = 0.02) -> np.ndarray:
    """Some samples repeat the one before."""
    fresh = np.random.default_rng(5).random(current.size) >= share
    return current[np.maximum.accumulate(np.where(fresh, np.arange(current.size), 0))]


def uneven(current: np.ndarray, time: np.ndarray, difference: float = 0.01) -> np.ndarray:
    """Readings of positive current are larger by a share than those of negative."""
    return current * (1.0 + 0.5 * difference * np.sign(current))


def cut_off(current: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Cut off towards zero."""
    return DIGIT * np.trunc(current / DIGIT)


def rounded(current: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Rounded to the nearest step."""
    return DIGIT * np.round(current / DIGIT)


def drifting(current: np.ndarray, time: np.ndarray, drift: float = 0.02) -> np.ndarray:
    """Readings that grow by a share over the recording."""
    return current * (1.0 + drift * time / time[-1])


@cache
def diagnosed(name, damage=None, seconds=SECONDS):
    """Diagnosis of a recording, damaged."""
    trace = recordings(seconds)[name]
    if damage is not None:
        trace = trace.with_signals({"current": damage(trace["current"], trace.time)}, {})
    return diagnose(trace, RIG)


def names(diagnosis) -> set[str]:
    """Of its effects."""
    return {effect.name for effect in diagnosis.effects}


def inertia_holds(diagnosis) -> bool:
    """Whether J is within three half widths of its interval, or a percent."""
    found = diagnosis.parameters["moment_of_inertia"]
    return abs(found.value - AXIS.inertia) < max(1.5 * (found.ci95[1] - found.ci95[0]), 0.01 * AXIS.inertia)
