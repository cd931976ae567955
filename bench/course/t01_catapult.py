"""Task 1: the path z = a*y**2 + b*y + c through the points of all flights, in the least-squares sense."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bench.arrays import Array
from bench.course.flights import Flights
from bench.course.result import Chart, Curve, Number, Panel, Task
from bench.errors import UndeterminedError

KEY, TITLE = "1", "Catapult"

#: Distances by which y is measured from further away, to see when the normal equations fail - m.
SHIFTS = (0.0, 1.0, 10.0, 100.0, 1000.0, 10000.0)


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


def task(flights: Flights, truth: Mapping[str, float]) -> Task:
    """Coefficients and remaining quadratic error; path and points in one diagram; both solvers compared.

    Args:
        flights: as read.
        truth: a, b, c of the throw without scatter; empty for real ones.

    Raises:
        UndeterminedError: all points at fewer than three places y.
    """
    points = np.concatenate(flights.points)
    y, z = points[:, 0], points[:, 1]
    matrix = columns(y)
    if np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        reason = "the points lie at fewer than three places y"
        raise UndeterminedError("path of the throw", reason, "points all along the path")
    theta = by_orthogonal_solver(matrix, z)
    error = float(np.sum((z - matrix @ theta) ** 2))
    along = np.linspace(y.min(), y.max(), 300)
    dots = tuple(Curve(f[:, 0], f[:, 1], f"experiment {k}", "dots") for k, f in enumerate(flights.points, start=1))
    path = Curve(along, columns(along) @ theta, "least squares")
    chart = Chart("Task 1: path and all points", (Panel("y / m", "z / m", (*dots, path)),))
    units = {"a": "1/m", "b": "1", "c": "m"}
    numbers = [
        Number(name, float(value), units[name], truth.get(name)) for name, value in zip("abc", theta, strict=True)
    ]
    solvers, comparison = compare_solvers(y, z)
    counts = (
        f"{len(flights.points)} experiments, {y.size} points; RMS distance in z {np.sqrt(error / y.size) * 1e3:.2g} mm."
    )
    return Task(
        KEY, TITLE, (counts, solvers, *flights.notes), (*numbers, Number("E", error, "m²")), (chart, comparison)
    )


def compare_solvers(y: Array, z: Array) -> tuple[str, Chart]:
    """How far the two solvers' paths are apart as y is measured from further away, which leaves the path as it is."""
    condition, apart = [], []
    for shift in SHIFTS:
        matrix = columns(y + shift)
        condition.append(float(np.linalg.cond(matrix)))
        paths = [matrix @ solve(matrix, z) for solve in (by_normal_equations, by_orthogonal_solver)]
        apart.append(float(np.max(np.abs(paths[0] - paths[1]))))
    known = np.maximum(apart, 1e-17)
    chart = Chart(
        "Task 1: normal equations against an orthogonal solver",
        (
            Panel(
                "condition number of A",
                "largest difference of the paths / m",
                (Curve(np.array(condition), known, "measured", "bold dots"),),
                log=True,
            ),
        ),
    )
    worst = next((k for k, value in enumerate(apart) if value > 1e-3), len(SHIFTS) - 1)
    findings = (
        f"(AᵀA)⁻¹Aᵀb and QR agree within {apart[0]:.1g} m here (condition number {condition[0]:.0f}). They part when "
        f"A is badly conditioned, for AᵀA has its square: with y measured from {SHIFTS[worst]:g} m away "
        f"({condition[worst]:.1g}) the paths are {apart[worst]:.1g} m apart."
    )
    return findings, chart
