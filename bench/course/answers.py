"""A student's answers: what the course asks for, worked out from recordings the right way, or with a known mistake."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import butter, filtfilt, savgol_filter

from bench.arrays import Array
from bench.course.axis import KG_CM2, RPM, motor_value, torque_constant
from bench.course.catapult import fit_path
from bench.course.friction import DELAY, WIDTH, filtered_acceleration
from bench.course.peak_torque import decline
from bench.course.recordings import LabRecordings, LabRun
from bench.course.torque_constants import coefficients, datasheet_points
from bench.errors import UndeterminedError
from bench.fit.lab import LEAST_SPEED, backward_difference, least_squares, mean_inertia
from bench.rig.rig import Rig

#: The corner is looked for from the first sample above this share of the largest torque on.
AT_THE_TOP = 0.8


@dataclass(frozen=True)
class Way:
    """How the recordings are worked out; the right one without arguments.

    Attributes:
        velocity: factor on the speed in rad/s that should be 1.
        current: factor on the current in A that should be 1.
        constant: torque per ampere at every current, `stall`, `peak` or `zero`; empty for kT(Iq).
        width, set_back: acceleration for least squares is the mean of so many differences, set back by so many samples.
        method: by which it is differentiated instead, one of METHODS; empty for means of differences.
        least: slower samples are left out of least squares - rad/s.
        rpm: factor on speeds in rpm that should be 1.
    """

    velocity: float = 1.0
    current: float = 1.0
    constant: str = ""
    width: int = WIDTH
    set_back: int = DELAY
    method: str = ""
    least: float = LEAST_SPEED
    rpm: float = 1.0

    def and_also(self, other: Way) -> Way | None:
        """Both mistakes at once; None where they are about the same."""
        own, others = self.changed, other.changed
        both_filters = bool(FILTER & own.keys() and FILTER & others.keys())
        return None if own.keys() & others.keys() or both_filters else replace(self, **others)

    @property
    def changed(self) -> dict[str, Any]:
        """What is not as it is right."""
        return {name: value for name, value in vars(self).items() if value != getattr(RIGHT, name)}


RIGHT = Way()
FILTER = {"width", "set_back", "method"}
LOW_PASS: Any = butter(2, 0.15)
#: Derivatives of a speed - rad/s, (n,) at a period - s - that are in step with it: others than means of differences.
METHODS: dict[str, Callable[[Array, float], Any]] = {
    "gradient": np.gradient,
    "Savitzky-Golay": lambda speed, period: savgol_filter(speed, 11, 2, deriv=1, delta=period),
    "filtfilt": lambda speed, period: filtfilt(LOW_PASS[0], LOW_PASS[1], np.gradient(speed, period)),
    "spline": lambda speed, period: CubicSpline(np.arange(speed.size), speed)(np.arange(speed.size), 1) / period,
}
#: Ways that are right, too: what they give apart from RIGHT is no mistake.
RIGHT_WAYS = (
    *(Way(width=width, set_back=width // 2) for width in (2, 6, 8)),
    *(Way(method=method) for method in METHODS),
    Way(least=30.0),
)
#: A right answer may be so many times as far off as those are from RIGHT.
MARGIN = 2.0


@dataclass(frozen=True)
class Mistake:
    """A mistake that students make, known by the figures that it gives on their own recordings.

    Attributes:
        name: of it.
        explanation: what went wrong, to the student.
        ways: in which recordings are worked out with it.
    """

    name: str
    explanation: str
    ways: tuple[Way, ...]


MISTAKES = (
    Mistake(
        "degrees for radians",
        "The speed went in in deg/s: divide by 180/π to get rad/s before anything else.",
        (Way(velocity=180.0 / math.pi),),
    ),
    Mistake(
        "milliamperes for amperes",
        "The current went in in mA: divide by 1000 before kT(Iq).",
        (Way(current=1e3), Way(current=1e3, constant="stall"), Way(current=1e3, constant="zero")),
    ),
    Mistake(
        "no kT(Iq)",
        "One torque constant was used at every current: torque is kT(Iq)·Iq with the curve of task 4.",
        (Way(constant="stall"), Way(constant="peak"), Way(constant="zero")),
    ),
    Mistake(
        "half-sample lag",
        "The mean was set back by its own delay alone: the backward difference is half a sample late besides, and "
        "J·α of that half sample is taken for friction.",
        (*(Way(width=width, set_back=(width - 1) // 2) for width in (3, 5, 7)), Way(set_back=1)),
    ),
    Mistake(
        "filter not synchronised",
        "alpha_filt was used as the filter delivers it: set it back by its delay, so that it belongs to the same time "
        "as speed and torque.",
        tuple(Way(width=width, set_back=0) for width in (3, WIDTH, 5, 7)),
    ),
    Mistake(
        "backward difference",
        "The bare backward difference went into least squares: it is noisy and half a sample late; use alpha_filt on "
        "t_sync.",
        (Way(width=1, set_back=0),),
    ),
    Mistake(
        "2π",
        "A factor of 2π is missing: rad/s = 2π·(turns per second), n/rpm = 60/(2π)·ω.",
        (Way(velocity=0.5 / math.pi), Way(rpm=2.0 * math.pi), Way(velocity=2.0 * math.pi)),
    ),
    Mistake("rpm for rad/s", "The speed went in in rpm: rad/s = 2π/60·n.", (Way(velocity=RPM),)),
    Mistake(
        "wrong sign",
        "Current and speed are counted in opposite directions: an inertia is positive. Turn one of them.",
        (Way(current=-1.0),),
    ),
    Mistake(
        "peak value for RMS",
        "The current is √2 times too large: kT of the datasheet is per ampere RMS.",
        (Way(current=math.sqrt(2.0)),),
    ),
)


@dataclass(frozen=True)
class Worked:
    """Recordings that are worked out in one way after the other: what no way changes is done once.

    Attributes:
        recordings: a student's.
        corner: of the fastest run - rad/s; NaN where its current does not tell one.
        unchanged: answers of the catapult and of the datasheet.
    """

    recordings: LabRecordings
    corner: float
    unchanged: dict[str, float]

    @classmethod
    def of(cls, recordings: LabRecordings) -> Worked:
        """Read all of a folder.

        Raises:
            InputError: a file is missing or cannot be read.
        """
        rig = recordings.rig
        theta, error = fit_path(*np.concatenate(recordings.flights.points).T)
        stall, peak = datasheet_points(rig)[1].tolist()
        unchanged = {f"catapult_{name}": value for name, value in zip("abc", theta.tolist(), strict=True)}
        unchanged |= {"catapult_E": error, "kT_stall": stall, "kT_peak": peak}
        unchanged |= {f"kT_{name}": value for name, value in zip("abc", coefficients(rig).tolist(), strict=True)}
        return cls(recordings, _corner(recordings.fastest), unchanged)

    def answers(self, way: Way = RIGHT) -> dict[str, float]:
        """Every quantity of the form, in its unit, in one way; those are left out that it gives no value of."""
        rig = self.recordings.rig
        return {
            **self.unchanged,
            **_task6(_seen(self.recordings.without_friction, rig, way), rig),
            **_task9(_seen(self.recordings.with_friction, rig, way), rig, way),
            "M_max": float(_torque(rig, self.recordings.fastest.current, way).max()),
            **({"corner": self.corner * way.velocity * RPM * way.rpm} if math.isfinite(self.corner) else {}),
        }


def _corner(run: LabRun) -> float:
    """The corner, read from the torque's top on, whatever unit or constant is made of it."""
    start = int(np.argmax(run.torque > AT_THE_TOP * run.torque.max()))
    try:
        return decline(run.velocity[start:], run.current[start:], run.sample_period).corner
    except UndeterminedError:
        return math.nan


def _seen(run: LabRun, rig: Rig, way: Way) -> LabRun:
    """The run with speed, acceleration and torque as one way makes them."""
    velocity = run.velocity * way.velocity
    differentiated = METHODS.get(way.method, backward_difference)
    alpha = differentiated(velocity, run.sample_period)
    return replace(run, velocity=velocity, acceleration=alpha, torque=_torque(rig, run.current, way))


def _torque(rig: Rig, current: Array, way: Way) -> Array:
    if not way.constant:
        return torque_constant(rig).torque(current * way.current)
    stall, peak = datasheet_points(rig)[1]
    constants = {"stall": stall, "peak": peak, "zero": torque_constant(rig).constant}
    return constants[way.constant] * current * way.current


def _inertias(figures: Mapping[str, float], factor: float) -> dict[str, float]:
    return {name: factor * value for name, value in figures.items() if name.startswith("J")}


#: Mistakes made after the work is done: name, explanation, and what they change of the figures.
SLIPS: tuple[tuple[str, str, Callable[[Mapping[str, float]], dict[str, float]]], ...] = (
    (
        "J_motor not subtracted",
        "J_load = J - J_motor: the rotor turns, too, and is no part of the load.",
        lambda f: {f"J_load{of}": f[f"J{of}"] for of in ("", "_without_friction") if f"J{of}" in f},
    ),
    (
        "K_w and K_0 exchanged",
        "The second column of A is ω and has K_w - N*m*s/rad -, the third sgn(ω) and has K_0 - N*m.",
        lambda f: {"K_fric_w": f["K_fric_0"], "K_fric_0": f["K_fric_w"]} if "K_fric_w" in f else {},
    ),
    ("kg·m² as kg·cm²", "1 kg·m² = 10⁴ kg·cm²: the number is in kg·m².", lambda f: _inertias(f, 1e-4)),
    ("kg·cm² as kg·m²", "1 kg·m² = 10⁴ kg·cm²: the number is in kg·cm².", lambda f: _inertias(f, 1e4)),
    (
        "rad/s as rpm",
        "The number is in rad/s: n/rpm = 60/(2π)·ω.",
        lambda f: {"corner": f["corner"] / RPM} if "corner" in f else {},
    ),
)


def every_mistake(worked: Worked) -> list[tuple[tuple[str, ...], dict[str, float]]]:
    """Figures of each known mistake in the work, and of each two of them at once, with their names."""
    singles = [(mistake.name, way) for mistake in MISTAKES for way in mistake.ways]
    found: list[tuple[tuple[str, ...], dict[str, float]]] = [((name,), worked.answers(way)) for name, way in singles]
    for (one, first), (two, second) in combinations(singles, 2):
        both = first.and_also(second)
        if one != two and both is not None:
            found.append(((one, two), worked.answers(both)))
    return found


def tolerances(worked: Worked) -> dict[str, float]:
    """Shares by which right answers may be off on these recordings, by how far right ways are apart on them."""
    right, others = worked.answers(), [worked.answers(way) for way in RIGHT_WAYS]
    return {
        name: MARGIN * max(abs(other[name] / value - 1.0) for other in others) for name, value in right.items() if value
    }


def _task6(run: LabRun, rig: Rig) -> dict[str, float]:
    inertia, largest, _ = mean_inertia(run.acceleration, run.torque)
    load = (inertia - motor_value(rig, "rotor_inertia")) * KG_CM2
    return {"alpha_max": largest, "J_without_friction": inertia * KG_CM2, "J_load_without_friction": load}


def _task9(run: LabRun, rig: Rig, way: Way) -> dict[str, float]:
    if way.method:
        alpha, synchronous = run.acceleration, slice(None)
    else:
        alpha, synchronous = filtered_acceleration(run, way.width, way.set_back)
    velocity, torque = run.velocity[synchronous], run.torque[synchronous]
    fast = np.abs(velocity) >= way.least
    try:
        theta, _, error = least_squares(alpha[fast], velocity[fast], torque[fast])
    except UndeterminedError:  # as with speeds so small by a wrong unit that none reaches the threshold
        return {}
    inertia, viscous, coulomb = theta.tolist()
    load = (inertia - motor_value(rig, "rotor_inertia")) * KG_CM2
    return {"J": inertia * KG_CM2, "K_fric_w": viscous, "K_fric_0": coulomb, "E": error, "J_load": load}
