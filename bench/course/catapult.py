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
#: Distances by which y is measured from further away, to see when the normal equations fail - m.
SHIFTS = (0.0, 1.0, 10.0, 100.0, 1000.0, 10000.0)
#: Paths further apart than this are not the same - m.
APART = 1e-3


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


def columns(y: Array) -> Array:
    """A = [y**2, y, 1], (n, 3)."""
    return np.stack([y**2, y, np.ones_like(y)], axis=1)


def by_normal_equations(matrix: Array, b: Array) -> Array:
    """(A'A)^-1 A'b. Its error grows with the condition number's square, as A'A has that."""
    return np.linalg.inv(matrix.T @ matrix) @ (matrix.T @ b)


def by_orthogonal_solver(matrix: Array, b: Array) -> Array:
    """R^-1 Q'b with A = QR: its error grows with the condition number itself.

    Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 5.3.
    """
    q, r = np.linalg.qr(matrix)
    return np.asarray(np.linalg.solve(r, q.T @ b), dtype=np.float64)


def fit_path(y: Array, z: Array) -> tuple[Array, float]:
    """Coefficients (3,) - 1/m, 1, m - and remaining quadratic error E - m**2 - of points (n,) - m.

    Raises UndeterminedError where all points lie at fewer than three places y.
    """
    matrix = columns(y)
    if np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        reason = "the points lie at fewer than three places y"
        raise UndeterminedError("path of the throw", reason, "points all along the path")
    theta = by_orthogonal_solver(matrix, z)
    return theta, float(np.sum((z - matrix @ theta) ** 2))


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
    fitted = curve(along, columns(along) @ theta, "least squares")
    rms = np.sqrt(error / y.size) * 1e3
    count = (
        f"The throw is z = {theta[0]:.4g}·y² {theta[1]:+.4g}·y {theta[2]:+.4g} (m), by least squares over {y.size} "
        f"points of {len(flights.points)} experiments; the points lie {rms:.2g} mm RMS from it."
    )
    solvers = compare_solvers(y, z)
    found = zip(UNITS.items(), theta.tolist(), _halves(flights.points, theta), strict=True)
    numbers = [Number(name, value, unit, flights.truth.get(name), half=half) for (name, unit), value, half in found]
    drawn = chart("Task 1: path and all points", panel("y / m", "z / m", *dots, fitted))
    return TaskResult((count, solvers, *flights.notes), (*numbers, Number("E", error, "m²")), (drawn,))


def compare_solvers(y: Array, z: Array) -> str:
    """How far the two solvers' paths are apart as y is measured from further away, which leaves the path as it is."""
    shifts, condition, apart = [], [], []
    for shift in SHIFTS:
        matrix = columns(y + shift)
        # AᵀA of the furthest has a pivot of exactly 0, and no inverse, for one set of flights in fifty
        if np.linalg.det(matrix.T @ matrix) != 0.0:
            paths = matrix @ by_normal_equations(matrix, z), matrix @ by_orthogonal_solver(matrix, z)
            shifts.append(shift)
            condition.append(float(np.linalg.cond(matrix)))
            apart.append(float(np.max(np.abs(paths[0] - paths[1]))))
    worst = next((k for k, value in enumerate(apart) if value > APART), len(shifts) - 1)
    return (
        f"(AᵀA)⁻¹Aᵀb and QR agree within {apart[0]:.1g} m here (condition number {condition[0]:.0f}). They part when "
        f"A is badly conditioned, for AᵀA has its square: with y measured from {shifts[worst]:g} m away "
        f"({condition[worst]:.1g}) the paths are {apart[worst]:.1g} m apart."
    )
