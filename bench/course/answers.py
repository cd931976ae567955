"""A student's answers: what the course asks for, worked out from recordings the right way, or with a known mistake."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import uniform_filter1d
from scipy.signal import butter, filtfilt, savgol_filter

from bench.arrays import Array
from bench.course.axis import KG_CM2, RPM, motor_value, torque_constant
from bench.course.catapult import fit_path
from bench.course.inertia import DELAY, WIDTH, filtered_acceleration
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
    "mean of three centred differences": lambda speed, period: uniform_filter1d(np.gradient(speed, period), 3),
    "mean of five centred differences": lambda speed, period: uniform_filter1d(np.gradient(speed, period), 5),
    "spline": lambda speed, period: CubicSpline(np.arange(speed.size), speed)(np.arange(speed.size), 1) / period,
}
#: The mean of four centred differences, which belongs between two samples, on either of them: half a sample late or
#: early.
LATE_METHODS: dict[str, Callable[[Array, float], Any]] = {
    "mean of centred differences, late": lambda speed, period: uniform_filter1d(np.gradient(speed, period), WIDTH),
    "mean of centred differences, early": lambda speed, period: uniform_filter1d(
        np.gradient(speed, period), WIDTH, origin=-1
    ),
}
#: Ways that are right, too: what they give apart from RIGHT is no mistake.
RIGHT_WAYS = (
    *(Way(width=width, set_back=width // 2) for width in (2, 6, 8)),
    *(Way(method=method) for method in METHODS),
    Way(least=30.0),
)
#: A right answer may be so many times as far off as those are from RIGHT.
MARGIN = 2.0
#: Mistakes that students make, known by the figures that they give on their own recordings: name, what went wrong, to
#: the student, and ways in which recordings are worked out with it.
MISTAKES: tuple[tuple[str, str, tuple[Way, ...]], ...] = (
    (
        "degrees for radians",
        "The speed went in in deg/s: divide by 180/π to get rad/s before anything else.",
        (Way(velocity=180.0 / math.pi),),
    ),
    (
        "milliamperes for amperes",
        "The current went in in mA: divide by 1000 before kT(Iq).",
        (Way(current=1e3), Way(current=1e3, constant="stall"), Way(current=1e3, constant="zero")),
    ),
    (
        "no kT(Iq)",
        "One torque constant was used at every current: torque is kT(Iq)·Iq with the curve of task 4.",
        (Way(constant="stall"), Way(constant="peak"), Way(constant="zero")),
    ),
    (
        "half-sample lag",
        "The mean was set back by its own delay alone: the backward difference is half a sample late besides, and "
        "J·α of that half sample is taken for friction.",
        (
            *(Way(width=width, set_back=(width - 1) // 2) for width in (3, 5, 7)),
            Way(set_back=1),
            *(Way(method=method) for method in LATE_METHODS),
        ),
    ),
    (
        "filter not synchronised",
        "alpha_filt was used as the filter delivers it: set it back by its delay, so that it belongs to the same time "
        "as speed and torque.",
        tuple(Way(width=width, set_back=0) for width in (3, WIDTH, 5, 7)),
    ),
    (
        "backward difference",
        "The bare backward difference went into least squares: it is noisy and half a sample late; use alpha_filt on "
        "t_sync.",
        (Way(width=1, set_back=0),),
    ),
    (
        "2π",
        "A factor of 2π is missing: rad/s = 2π·(turns per second), n/rpm = 60/(2π)·ω.",
        (Way(velocity=0.5 / math.pi), Way(rpm=2.0 * math.pi), Way(velocity=2.0 * math.pi)),
    ),
    ("rpm for rad/s", "The speed went in in rpm: rad/s = 2π/60·n.", (Way(velocity=RPM),)),
    (
        "wrong sign",
        "Current and speed are counted in opposite directions: an inertia is positive. Turn one of them.",
        (Way(current=-1.0),),
    ),
    (
        "peak value for RMS",
        "The current is √2 times too large: kT of the datasheet is per ampere RMS.",
        (Way(current=math.sqrt(2.0)),),
    ),
)


#: Of these, what the text's equations give literally: its backward difference (16) is half a
#: sample late, in the bare and in the filtered acceleration.
AS_THE_TEXT_SAYS = ("half-sample lag", "backward difference")


@dataclass(frozen=True)
class Worked:
    """A student's recordings that are worked out in one way after the other: what no way changes is done once.

    Whatever is asked of it raises InputError where a file is missing or cannot be read.
    """

    recordings: LabRecordings

    @cached_property
    def unchanged(self) -> dict[str, float]:
        """Answers of the catapult and of the datasheet."""
        theta, error = fit_path(*np.concatenate(self.recordings.flights.points).T)
        stall, peak = datasheet_points(self.recordings.rig)[1].tolist()
        of_curve = coefficients(self.recordings.rig).tolist()
        found = {f"catapult_{name}": value for name, value in zip("abc", theta.tolist(), strict=True)}
        found |= {"catapult_E": error, "kT_stall": stall, "kT_peak": peak}
        return found | {f"kT_{name}": value for name, value in zip("abc", of_curve, strict=True)}

    @cached_property
    def corner(self) -> float:
        """Of the fastest run, read from the torque's top on, whatever is made of it - rad/s; NaN where it has none."""
        run = self.recordings.fastest
        start = int(np.argmax(run.torque > AT_THE_TOP * run.torque.max()))
        try:
            return decline(run.velocity[start:], run.current[start:], run.sample_period).corner
        except UndeterminedError:
            return math.nan

    def answers(self, way: Way = RIGHT) -> dict[str, float]:
        """Every quantity of the form, in its unit, in one way; those are left out that it gives no value of."""
        recordings, rig = self.recordings, self.recordings.rig
        found, corner = {**self.unchanged}, self.corner * way.velocity * RPM * way.rpm
        run, rotor = _seen(recordings.without_friction, rig, way), motor_value(rig, "rotor_inertia")
        inertia, found["alpha_max"], _ = mean_inertia(run.acceleration, run.torque)
        found["J_without_friction"] = inertia * KG_CM2
        found["J_load_without_friction"] = (inertia - rotor) * KG_CM2
        run = _seen(recordings.with_friction, rig, way)
        with suppress(UndeterminedError):  # as with speeds so small by a wrong unit that none reaches the threshold
            (inertia, viscous, coulomb), error = _balance(run, way)
            found |= {"J": inertia * KG_CM2, "K_fric_w": viscous, "K_fric_0": coulomb, "E": error}
            found["J_load"] = (inertia - rotor) * KG_CM2
        found["M_max"] = float(_torque(rig, recordings.fastest.current, way).max())
        return found | ({"corner": corner} if math.isfinite(corner) else {})


def _seen(run: LabRun, rig: Rig, way: Way) -> LabRun:
    """The run with speed, acceleration and torque as one way makes them."""
    velocity = run.velocity * way.velocity
    alpha = (METHODS | LATE_METHODS).get(way.method, backward_difference)(velocity, run.sample_period)
    return replace(run, velocity=velocity, acceleration=alpha, torque=_torque(rig, run.current, way))


def _torque(rig: Rig, current: Array, way: Way) -> Array:
    if not way.constant:
        return torque_constant(rig).torque(current * way.current)
    stall, peak = datasheet_points(rig)[1]
    constants = {"stall": stall, "peak": peak, "zero": torque_constant(rig).constant}
    return constants[way.constant] * current * way.current


def _balance(run: LabRun, way: Way) -> tuple[list[float], float]:
    """J, K_w and K_0 in SI by least squares over the fast samples, and the remaining quadratic error."""
    alpha, synchronous = run.acceleration, slice(None)
    if not way.method:
        alpha, synchronous = filtered_acceleration(run, way.width, way.set_back)
    velocity, torque = run.velocity[synchronous], run.torque[synchronous]
    fast = np.abs(velocity) >= way.least
    theta, _, error = least_squares(alpha[fast], velocity[fast], torque[fast])
    return theta.tolist(), error


def _inertias(figures: Mapping[str, float], factor: float) -> dict[str, float]:
    return {name: factor * value for name, value in figures.items() if name.startswith("J")}


#: The same of mistakes made after the work is done, and what they change of the figures.
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
    singles = [(name, way) for name, _, ways in MISTAKES for way in ways]
    found: list[tuple[tuple[str, ...], dict[str, float]]] = [((name,), worked.answers(way)) for name, way in singles]
    for (one, first), (two, second) in combinations(singles, 2):
        both = first.and_also(second)
        if one != two and both is not None:
            found.append(((one, two), worked.answers(both)))
    return found


def tolerances(worked: Worked) -> dict[str, float]:
    """Shares by which right answers may be off on these recordings, by how far right ways are apart on them."""
    others = [worked.answers(way) for way in RIGHT_WAYS]
    right = {name: value for name, value in worked.answers().items() if value}
    return {name: MARGIN * max(abs(other[name] / value - 1.0) for other in others) for name, value in right.items()}
