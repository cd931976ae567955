"""Task 1: the path z = a*y**2 + b*y + c through the points of all flights, in the least-squares sense."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.course.recordings import LabRecordings
from bench.course.result import DoneTask, Number, chart, curve, panel
from bench.errors import UndeterminedError
from bench.report.document import Chart

KEY, TITLE = "1", "Catapult"

#: Distances by which y is measured from further away, to see when the normal equations fail - m.
SHIFTS = (0.0, 1.0, 10.0, 100.0, 1000.0, 10000.0)
#: Paths further apart than this are not the same - m.
APART = 1e-3


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

    Raises:
        UndeterminedError: all points at fewer than three places y.
    """
    matrix = columns(y)
    if np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        reason = "the points lie at fewer than three places y"
        raise UndeterminedError("path of the throw", reason, "points all along the path")
    theta = by_orthogonal_solver(matrix, z)
    return theta, float(np.sum((z - matrix @ theta) ** 2))


def task(recordings: LabRecordings) -> DoneTask:
    """Coefficients and remaining quadratic error; path and points in one diagram; both solvers compared."""
    flights = recordings.flights
    y, z = np.concatenate(flights.points).T
    theta, error = fit_path(y, z)
    along = np.linspace(y.min(), y.max(), 300)
    dots = [curve(f[:, 0], f[:, 1], f"experiment {k}", "dots") for k, f in enumerate(flights.points, start=1)]
    path = curve(along, columns(along) @ theta, "least squares")
    numbers = [
        Number(name, float(value), unit, flights.truth.get(name))
        for name, value, unit in zip("abc", theta, ("1/m", "1", "m"), strict=True)
    ]
    count = (
        f"{len(flights.points)} experiments, {y.size} points; RMS distance in z {np.sqrt(error / y.size) * 1e3:.2g} mm."
    )
    solvers, comparison = compare_solvers(y, z)
    return DoneTask(
        KEY,
        TITLE,
        (count, solvers, *flights.notes),
        (*numbers, Number("E", error, "m²")),
        (chart("Task 1: path and all points", panel("y / m", "z / m", *dots, path)), comparison),
    )


def compare_solvers(y: Array, z: Array) -> tuple[str, Chart]:
    """How far the two solvers' paths are apart as y is measured from further away, which leaves the path as it is."""
    matrices = [columns(y + shift) for shift in SHIFTS]
    condition = [float(np.linalg.cond(matrix)) for matrix in matrices]
    apart = [
        float(np.max(np.abs(matrix @ by_normal_equations(matrix, z) - matrix @ by_orthogonal_solver(matrix, z))))
        for matrix in matrices
    ]
    worst = next((k for k, value in enumerate(apart) if value > APART), len(SHIFTS) - 1)
    findings = (
        f"(AᵀA)⁻¹Aᵀb and QR agree within {apart[0]:.1g} m here (condition number {condition[0]:.0f}). They part when "
        f"A is badly conditioned, for AᵀA has its square: with y measured from {SHIFTS[worst]:g} m away "
        f"({condition[worst]:.1g}) the paths are {apart[worst]:.1g} m apart."
    )
    measured = curve(np.array(condition), np.maximum(apart, 1e-17), "measured", "large dots")
    axes = panel("condition number of A", "largest difference of the paths / m", measured, log=True)
    return findings, chart("Task 1: normal equations against an orthogonal solver", axes)
