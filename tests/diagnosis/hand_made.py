"""Fits whose numbers are made by hand: residuals, floors and strengths as a test states them, nothing solved."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from bench.effects.catalogue import catalogue
from bench.fit.fit import Fit
from bench.fit.hypothesis import BASE, HUM, Hypothesis, Layout, Term
from tests.diagnosis.constructed import bare, moved, recorded

#: Independent rows are this many rows apart in a fit made by hand.
CORRELATION = 2.0
_SCOPE = bare(recorded(moved(2.0))).scope


def term(name: str, *shape: float) -> Term:
    """An effect of the catalogue."""
    return Term(catalogue()[name], shape)


def made(
    left: list[float] | np.ndarray,
    *terms: Term,
    floor: float = 1.0,
    white: float | None = None,
    strengths: tuple[float, ...] = (),
    inertia: float = 1.0,
    determined: list[bool] | None = None,
    numbers: int = 0,
) -> Fit:
    """A fit that leaves what is said.

    Args:
        left: measured less modelled torque of every row (m,).
        terms: of its hypothesis.
        floor, white: RMS of noise, with and without its colour; alike unless said.
        strengths: of the terms, one each.
        inertia: J.
        determined: rows that are; all unless said.
        numbers: of further nuisance parameters.
    """
    left = np.asarray(left, dtype=np.float64)
    theta = np.array([inertia, 0.0, 0.0, 0.0, *([0.0] * numbers), *(strengths or [1.0] * len(terms))])
    owners = np.array([*BASE, *([HUM] * numbers), *range(len(terms))], dtype=object)
    columns = np.zeros((left.size, theta.size))
    layout = Layout(columns, owners, left, np.zeros((theta.size, theta.size)), {}, np.empty(0, dtype=int))
    rows = SimpleNamespace(correlation=CORRELATION, scope=_SCOPE, effort=left)
    sure = np.ones(left.size, dtype=bool) if determined is None else np.array(determined)
    fitted = Fit(rows, Hypothesis(terms), layout, theta, (), sure)  # pyright: ignore[reportArgumentType]
    fitted.__dict__["noise"] = SimpleNamespace(coloured=floor, white=floor if white is None else white)
    fitted.__dict__["depends"] = None
    return fitted


def level(squares: float, rows: int = 100) -> np.ndarray:
    """Residuals (rows,) with that sum of squares."""
    return np.full(rows, np.sqrt(squares / rows))
