"""The catapult: flights simulated in MuJoCo, and task 1, the path z = a*y**2 + b*y + c through all their points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from scipy.special import stdtrit

from bench.arrays import Array
from bench.assets import asset
from bench.course.methods import parabola
from bench.course.recordings import LabRecordings
from bench.course.result import Number, TaskResult, chart, curve, panel
from bench.errors import SimulationError, UndeterminedError
from bench.files import write_text
from bench.plant.plant import DIVERGED
from bench.plant.simulate import SCHEMA
from bench.structured import json_text

FLIGHTS, POINTS = 10, 20
#: Units of a, b and c.
UNITS = {"a": "1/m", "b": "1", "c": "m"}
#: Angles of the arm from the forward horizontal when it is let go, and when the ball is - rad.
COCKED, RELEASE = math.radians(200.0), math.radians(135.0)
#: Scatter of a launch: of the spring's stiffness - share, and of the release - rad; of the sensor: in y and z - m.
STIFFNESS_SCATTER, RELEASE_SCATTER, SENSOR_SCATTER = 0.015, math.radians(0.5), 0.004
#: The flight is seen from its release until this height - m.
LOWEST = 0.05


@dataclass(frozen=True)
class Flight:
    """A flight from its release on.

    Attributes:
        points: (POINTS, 2) y and z evenly in time - m.
        coefficients: a - 1/m, b, c - m of z = a*y**2 + b*y + c, from the state at the release alone.
    """

    points: Array
    coefficients: Array


def fly(stiffness_factor: float = 1.0, release: float = RELEASE) -> Flight:
    """Throw the ball once; without arguments as the catapult is built.

    Args:
        stiffness_factor: of the spring against the model's.
        release: angle of the arm at which the ball is let go - rad; SimulationError where it never gets there.
    """
    model = mujoco.MjModel.from_xml_path(str(asset("mjcf", "catapult.xml")))
    data = mujoco.MjData(model)
    arm = model.joint("arm")
    model.jnt_stiffness[arm.id] *= stiffness_factor
    data.qpos[arm.qposadr[0]] = COCKED
    mujoco.mj_forward(model, data)
    data.qpos[model.joint("ball").qposadr[0] :][:3] = data.site("cup").xpos
    while data.qpos[arm.qposadr[0]] > release:
        mujoco.mj_step(model, data)
        if data.time > 2.0 or data.warning.number.any():
            raise SimulationError(DIVERGED)
    data.eq_active[model.equality("grip").id] = 0
    path, coefficients = [_ball(model, data)[:2]], _parabola(*_ball(model, data), -model.opt.gravity[2])
    while path[-1][1] > LOWEST:
        mujoco.mj_step(model, data)
        path.append(_ball(model, data)[:2])
        if data.time > 10.0:
            raise SimulationError(DIVERGED)
    seen = np.linspace(0, len(path) - 2, POINTS).round().astype(int)
    return Flight(np.array(path)[seen], coefficients)


def _ball(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[float, float, float, float]:
    """y, z - m, and their rates - m/s - of the ball."""
    joint = model.joint("ball")
    position, velocity = data.qpos[joint.qposadr[0] :], data.qvel[joint.dofadr[0] :]
    return float(position[1]), float(position[2]), float(velocity[1]), float(velocity[2])


def _parabola(y: float, z: float, speed_y: float, speed_z: float, gravity: float) -> Array:
    """Ballistic path without drag: z = z0 + v_z/v_y*(y - y0) - g/(2*v_y**2)*(y - y0)**2, as a, b, c."""
    a, slope = -gravity / (2.0 * speed_y**2), speed_z / speed_y
    return np.array([a, slope - 2.0 * a * y, z - slope * y + a * y**2])


def record_flights(folder: Path, random: np.random.Generator) -> list[Path]:
    """Write flights as a sensor sees them as CSV, one each, and the truth; returns the paths written."""
    flights, paths = [], []
    for number in range(1, FLIGHTS + 1):
        factor = 1.0 + STIFFNESS_SCATTER * random.standard_normal()
        flights.append(fly(factor, RELEASE + RELEASE_SCATTER * random.standard_normal()))
        seen = flights[-1].points + SENSOR_SCATTER * random.standard_normal((POINTS, 2))
        paths.append(folder / f"experiment-{number:02}.csv")
        rows = "\n".join(f"{y:.4f},{z:.4f}" for y, z in seen)
        write_text(paths[-1], f"y [m],z [m]\n{rows}\n")
    nominal = zip(UNITS.items(), fly().coefficients.tolist(), strict=True)
    content = {
        "schema": SCHEMA,
        "parameters": {name: {"value": value, "unit": unit} for (name, unit), value in nominal},
        "flights": [flight.coefficients.tolist() for flight in flights],
        "sensor_scatter": {"value": SENSOR_SCATTER, "unit": "m"},
    }
    truth = folder / "truth.json"
    write_text(truth, json_text(content) + "\n")
    return [*paths, truth]


def fit_path(y: Array, z: Array) -> tuple[Array, float]:
    """Coefficients (3,) - 1/m, 1, m - and remaining quadratic error E - m**2 - of points (n,) - m.

    Raises UndeterminedError where all points lie at fewer than three places y.
    """
    if np.unique(y).size < 3:
        reason = "the points lie at fewer than three places y"
        raise UndeterminedError("path of the throw", reason, "points all along the path")
    return parabola(y, z)


def _halves(flights: Sequence[Array], theta: Array) -> list[float | None]:
    """Half widths of 95 % of the throw's coefficients (3,), by how the flights' own differ, and from those of all.

    Points of several paths in one fit are not their mean: on 40 recorded classes' flights that moved b by 0.8 %.
    """
    if len(flights) < 2 or min(map(len, flights)) < theta.size:
        return [None] * theta.size
    own = np.array([fit_path(*flight.T)[0] for flight in flights])
    spread = stdtrit(len(own) - 1, 0.975) * own.std(axis=0, ddof=1) / math.sqrt(len(own))
    return (spread + np.abs(own.mean(axis=0) - theta)).tolist()


def path(recordings: LabRecordings) -> TaskResult:
    """Coefficients and remaining quadratic error; path and points in one diagram; both solvers compared."""
    flights = recordings.flights
    y, z = np.concatenate(flights.points).T
    theta, error = fit_path(y, z)
    along = np.linspace(y.min(), y.max(), 300)
    numbered = enumerate(flights.points, start=1)
    dots = [curve(flight[:, 0], flight[:, 1], f"experiment {k}", "dots") for k, flight in numbered]
    fitted = curve(along, np.polyval(theta, along), "least squares")
    rms = np.sqrt(error / y.size) * 1e3
    count = (
        f"The throw is z = {theta[0]:.4g}·y² {theta[1]:+.4g}·y {theta[2]:+.4g} (m), by least squares over {y.size} "
        f"points of {len(flights.points)} experiments; the points lie {rms:.2g} mm RMS from it."
    )
    matrix = np.vander(y, 3)
    by_normal_equations = np.linalg.lstsq(matrix.T @ matrix, matrix.T @ z, rcond=None)[0]
    solvers = (
        f"The normal equations (AᵀA)⁻¹Aᵀb give the same path within "
        f"{np.abs(matrix @ (by_normal_equations - theta)).max():.1g} m. They lose twice as many digits as QR, as AᵀA "
        f"has the square of A's condition number, here {np.linalg.cond(matrix):.0f}."
    )
    found = zip(UNITS.items(), theta.tolist(), _halves(flights.points, theta), strict=True)
    numbers = [Number(name, value, unit, flights.truth.get(name), half=half) for (name, unit), value, half in found]
    drawn = chart("Task 1: path and all points", panel("y / m", "z / m", *dots, fitted))
    return TaskResult((count, solvers, *flights.notes), (*numbers, Number("E", error, "m²")), (drawn,))
