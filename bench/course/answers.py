"""A student's answers: what the course asks for, worked out from recordings the right way, or with a known mistake."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

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
        rpm: factor on speeds in rpm that should be 1.
    """

    velocity: float = 1.0
    current: float = 1.0
    constant: str = ""
    width: int = WIDTH
    set_back: int = DELAY
    rpm: float = 1.0


RIGHT = Way()


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
    alpha = backward_difference(velocity, run.sample_period)
    return replace(run, velocity=velocity, acceleration=alpha, torque=_torque(rig, run.current, way))


def _torque(rig: Rig, current: Array, way: Way) -> Array:
    if not way.constant:
        return torque_constant(rig).torque(current * way.current)
    stall, peak = datasheet_points(rig)[1]
    constants = {"stall": stall, "peak": peak, "zero": torque_constant(rig).constant}
    return constants[way.constant] * current * way.current


def _task6(run: LabRun, rig: Rig) -> dict[str, float]:
    inertia, largest, _ = mean_inertia(run.acceleration, run.torque)
    load = (inertia - motor_value(rig, "rotor_inertia")) * KG_CM2
    return {"alpha_max": largest, "J_without_friction": inertia * KG_CM2, "J_load_without_friction": load}


def _task9(run: LabRun, rig: Rig, way: Way) -> dict[str, float]:
    alpha, synchronous = filtered_acceleration(run, way.width, way.set_back)
    velocity, torque = run.velocity[synchronous], run.torque[synchronous]
    fast = np.abs(velocity) >= LEAST_SPEED
    try:
        theta, _, error = least_squares(alpha[fast], velocity[fast], torque[fast])
    except UndeterminedError:  # as with speeds so small by a wrong unit that none reaches the threshold
        return {}
    inertia, viscous, coulomb = theta.tolist()
    load = (inertia - motor_value(rig, "rotor_inertia")) * KG_CM2
    return {"J": inertia * KG_CM2, "K_fric_w": viscous, "K_fric_0": coulomb, "E": error, "J_load": load}
