"""A student's answers: what the course asks for, worked out from recordings the right way, or with a known mistake."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from bench.arrays import Array
from bench.course.axis import motor_value, torque_constant
from bench.course.catapult import fit_path
from bench.course.methods import KG_CM2, RPM, filtered_acceleration, mean_inertia, num_derivative
from bench.course.mistakes import MISTAKES
from bench.course.peak_torque import decline
from bench.course.recordings import LabRecordings
from bench.course.run import LabRun
from bench.course.torque_constants import datasheet_points
from bench.course.ways import LATE_METHODS, METHODS, RIGHT, RIGHT_WAYS, Way
from bench.errors import UndeterminedError
from bench.fit.lab import least_squares
from bench.rig.rig import Rig

#: The corner is looked for from the first sample above this share of the largest torque on.
AT_THE_TOP = 0.8


#: A right answer may be so many times as far off as other right ways are from RIGHT.
MARGIN = 2.0


@dataclass(frozen=True)
class Worked:
    """A student's recordings that are worked out in one way after the other: what no way changes is done once.

    All of it raises InputError where a file is missing or cannot be read.
    """

    recordings: LabRecordings

    @cached_property
    def unchanged(self) -> dict[str, float]:
        """Answers of the catapult and of the datasheet."""
        theta, error = fit_path(*np.concatenate(self.recordings.flights.points).T)
        _, (stall, peak), curve = datasheet_points(self.recordings.rig)
        found = {f"catapult_{name}": value for name, value in zip("abc", theta.tolist(), strict=True)}
        found |= {"catapult_E": error, "kT_stall": float(stall), "kT_peak": float(peak)}
        return found | {"kT_a": curve.curvature, "kT_b": 0.0, "kT_c": curve.constant}

    @cached_property
    def corner(self) -> float:
        """Of the fastest run, read from the torque's top on, whatever it is used for - rad/s; NaN where it has none."""
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
        run, rotor = _read(recordings.without_friction, rig, way), motor_value(rig, "rotor_inertia")
        inertia, found["alpha_max"], _ = mean_inertia(run.acceleration, run.torque)
        found["J_without_friction"] = inertia * KG_CM2
        found["J_load_without_friction"] = (inertia - rotor) * KG_CM2
        run = _read(recordings.with_friction, rig, way)
        with suppress(UndeterminedError):  # as with speeds so small by a wrong unit that none reaches the threshold
            (inertia, viscous, coulomb), error = _balance(run, way)
            found |= {"J": inertia * KG_CM2, "K_fric_w": viscous, "K_fric_0": coulomb, "E": error}
            found["J_load"] = (inertia - rotor) * KG_CM2
        found["M_max"] = float(_torque(rig, recordings.fastest.current, way).max())
        return found | ({"corner": corner} if math.isfinite(corner) else {})


def _read(run: LabRun, rig: Rig, way: Way) -> LabRun:
    """The run with speed, acceleration and torque as one way makes them."""
    velocity = run.velocity * way.velocity
    alpha = (METHODS | LATE_METHODS).get(way.method, num_derivative)(velocity, run.sample_period)
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
        alpha, synchronous = filtered_acceleration(run.acceleration, way.width, way.set_back)
    velocity, torque = run.velocity[synchronous], run.torque[synchronous]
    fast = np.abs(velocity) >= way.least
    theta, _, error = least_squares(alpha[fast], velocity[fast], torque[fast])
    return theta.tolist(), error


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
    """Shares by which right answers may be off on these recordings, by how far right ways differ on them."""
    others = [worked.answers(way) for way in RIGHT_WAYS]
    right = {name: value for name, value in worked.answers().items() if value}
    return {name: MARGIN * max(abs(other[name] / value - 1.0) for other in others) for name, value in right.items()}
