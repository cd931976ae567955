"""A student's answers: what the course asks for, worked out from recordings the right way, or with a known mistake."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.course.corner import decline
from bench.course.flights import Flights, find_flights, read_flights
from bench.course.recordings import FASTEST, WITH_FRICTION, WITHOUT_FRICTION, Recordings
from bench.course.rig import rotor_inertia, torque_constant
from bench.course.run import Run
from bench.course.t01_catapult import by_orthogonal_solver, columns
from bench.course.t03_torque_constants import torque_constants
from bench.course.t04_torque_constant_curve import coefficients
from bench.course.t06_inertia import KG_CM2
from bench.course.t08_fast_samples import WIDTH
from bench.course.t10_peak_torque import LEAST_TORQUE, RPM
from bench.errors import UndeterminedError
from bench.fit.lab import LEAST_SPEED, backward_difference, least_squares, mean_inertia
from bench.rig.rig import Rig


@dataclass(frozen=True)
class Asked:
    """A quantity that a student hands in.

    Attributes:
        task: number in the course.
        name: of the quantity in the form.
        unit: as pint reads it; of the form, answers in another one are converted.
        tolerance: share by which a right answer may be off: other filters, thresholds and ways to read a corner are
            right too. None where they make any value; it then only helps to recognise a mistake.
        near_zero: what stands for the value in that share where it is zero.
    """

    task: str
    name: str
    unit: str
    tolerance: float | None
    near_zero: float = 0.0


ASKED = (
    Asked("1", "catapult_a", "1/m", 0.02),
    Asked("1", "catapult_b", "dimensionless", 0.02),
    Asked("1", "catapult_c", "m", 0.02),
    Asked("1", "catapult_E", "m**2", 0.05),
    Asked("3", "kT_stall", "N*m/A", 0.005),
    Asked("3", "kT_peak", "N*m/A", 0.005),
    Asked("4", "kT_a", "N*m/A**3", 0.01),
    Asked("4", "kT_b", "N*m/A**2", 0.01, near_zero=0.1),
    Asked("4", "kT_c", "N*m/A", 0.005),
    Asked("6", "alpha_max", "rad/s**2", 0.2),
    Asked("6", "J_without_friction", "kg*cm**2", 0.02),
    Asked("6", "J_load_without_friction", "kg*cm**2", 0.02),
    Asked("9", "J", "kg*cm**2", 0.02),
    Asked("9", "K_fric_w", "N*m*s/rad", 0.1),
    Asked("9", "K_fric_0", "N*m", 0.08),
    Asked("9", "E", "(N*m)**2", None),
    Asked("9", "J_load", "kg*cm**2", 0.02),
    Asked("10", "M_max", "N*m", 0.03),
    Asked("10", "corner", "rpm", 0.05),
)


@dataclass(frozen=True)
class Alpha:
    """How acceleration is made for least squares: the mean of `width` differences, set back by `set_back` samples."""

    width: int = WIDTH
    set_back: int = WIDTH // 2


@dataclass(frozen=True)
class Way:
    """How the recordings are worked out.

    Attributes:
        velocity: factor on the speed in rad/s that should be 1.
        current: factor on the current in A that should be 1.
        constant: torque per ampere at every current, `stall`, `peak` or `zero`; empty for kT(Iq).
        alpha: of least squares.
        rpm: factor on speeds in rpm that should be 1.
    """

    velocity: float = 1.0
    current: float = 1.0
    constant: str = ""
    alpha: Alpha = Alpha()
    rpm: float = 1.0


@dataclass(frozen=True)
class Material:
    """What a student has: the rig file, three recordings and the flights."""

    rig: Rig
    without_friction: Run
    with_friction: Run
    fastest: Run
    flights: Flights

    @classmethod
    def of(cls, recordings: Recordings) -> Material:
        """Read all of a folder.

        Raises:
            InputError: one is missing or cannot be read.
        """
        return cls(
            recordings.rig,
            recordings.run(WITHOUT_FRICTION),
            recordings.run(WITH_FRICTION),
            recordings.run(FASTEST),
            read_flights(find_flights(recordings.folder)),
        )


def answers(material: Material, way: Way | None = None) -> dict[str, float]:
    """Every quantity of the form, in its unit, worked out in one way; those are left out that it gives no value of."""
    way = way or Way()
    rig = material.rig
    y, z = np.concatenate(material.flights.points).T
    theta = by_orthogonal_solver(columns(y), z)
    stall, peak = torque_constants(rig.motor, rig.source)
    found: dict[str, float] = {f"catapult_{name}": value for name, value in zip("abc", theta.tolist(), strict=True)}
    found["catapult_E"] = float(np.sum((z - columns(y) @ theta) ** 2))
    found |= {"kT_stall": stall, "kT_peak": peak}
    curve = coefficients(rig.motor, rig.source).tolist()
    found |= {f"kT_{name}": value for name, value in zip("abc", curve, strict=True)}
    found |= _task6(material, way) | _task9(material, way) | _task10(material, way)
    return found


def _torque(rig: Rig, current: Array, way: Way) -> Array:
    if not way.constant:
        return torque_constant(rig).torque(current * way.current)
    stall, peak = torque_constants(rig.motor, rig.source)
    constants = {"stall": stall, "peak": peak, "zero": torque_constant(rig).constant}
    return constants[way.constant] * current * way.current


def _task6(material: Material, way: Way) -> dict[str, float]:
    run, rig = material.without_friction, material.rig
    alpha = backward_difference(run.velocity * way.velocity, run.sample_period)
    inertia, largest, _ = mean_inertia(alpha, _torque(rig, run.current, way))
    return {
        "alpha_max": largest,
        "J_without_friction": inertia * KG_CM2,
        "J_load_without_friction": (inertia - rotor_inertia(rig)) * KG_CM2,
    }


def _task9(material: Material, way: Way) -> dict[str, float]:
    run, rig = material.with_friction, material.rig
    velocity, torque = run.velocity * way.velocity, _torque(rig, run.current, way)
    difference = backward_difference(velocity, run.sample_period)[1:]
    width, set_back = way.alpha.width, way.alpha.set_back
    alpha = np.convolve(difference, np.full(width, 1.0 / width), mode="valid")
    # the last difference of a mean is that of its sample; the mean comes with it unless it is set back
    part = slice(width - set_back, width - set_back + alpha.size)
    fast = np.abs(velocity[part]) >= LEAST_SPEED
    try:
        theta, _, error = least_squares(alpha[fast], velocity[part][fast], torque[part][fast])
    except UndeterminedError:  # as with speeds so small by a wrong unit that none reaches the threshold
        return {}
    return {
        "J": float(theta[0]) * KG_CM2,
        "K_fric_w": float(theta[1]),
        "K_fric_0": float(theta[2]),
        "E": error,
        "J_load": (float(theta[0]) - rotor_inertia(rig)) * KG_CM2,
    }


def _task10(material: Material, way: Way) -> dict[str, float]:
    """The corner is read from the torque's top on, whatever unit or constant made of it."""
    run, rig = material.fastest, material.rig
    torque = _torque(rig, run.current, way)
    right = torque_constant(rig).torque(run.current)
    start = int(np.argmax(right > (1.0 - LEAST_TORQUE) * right.max()))
    try:
        speed = decline(run.velocity[start:], run.current[start:], run.sample_period).corner
    except UndeterminedError:
        return {"M_max": float(torque.max())}
    return {"M_max": float(torque.max()), "corner": speed * way.velocity * RPM * way.rpm}
