"""Whether a recording determines what is asked of it; a refusal with its reason beats a number it cannot carry."""

from __future__ import annotations

import numpy as np

from bench.errors import UndeterminedError
from bench.identify.names import parameter_name
from bench.identify.normal_equations import NormalEquations
from bench.identify.regressors import COULOMB, INERTIA, OFFSET, VISCOUS
from bench.trace.conditioning import COHERENCE

#: Rows that the regression must have for each of its columns.
ROWS_PER_COLUMN = 20
#: Share of the motion in the weaker direction below which friction and offset are one number.
DIRECTION_SHARE = 0.02
#: Share of a column's power that the others do not explain; 1 % inflates its standard error tenfold.
INDEPENDENT_SHARE = 0.01

RECORD = {
    INERTIA: "a motion that accelerates and brakes hard several times",
    VISCOUS: "a motion with at least two clearly different speeds in each direction",
    COULOMB: "a motion in both directions, several seconds each",
    OFFSET: "a motion in both directions, several seconds each",
}


def require_coherent(coherence: float, linear: bool) -> None:
    """UndeterminedError unless effort and acceleration share at least half of their power at some frequency."""
    if coherence < COHERENCE:
        name = parameter_name(INERTIA, linear).replace("_", " ")
        reason = f"acceleration and effort have nothing in common (coherence at most {coherence:.2f})"
        raise UndeterminedError(name, reason, RECORD[INERTIA])


def require_determined(equations: NormalEquations, linear: bool) -> None:
    """UndeterminedError naming the first quantity that the rows leave open.

    Args:
        equations: of every column, the constant one among them.
        linear: whether the axis is linear.
    """
    least = ROWS_PER_COLUMN * len(equations.names)
    if equations.count < least:
        reason = f"only {equations.count} filtered samples move clearly in one direction, {least} are needed"
        raise UndeterminedError(parameter_name(INERTIA, linear).replace("_", " "), reason, RECORD[INERTIA])
    _require_directions(equations, linear)
    _require_excited(equations, linear)


def _require_directions(equations: NormalEquations, linear: bool) -> None:
    coulomb, constant = equations.names.index(COULOMB), equations.names.index(OFFSET)
    mean_direction = equations.gram[:, coulomb, constant].sum() / equations.count
    weaker = 0.5 * (1.0 - abs(mean_direction))
    if weaker < DIRECTION_SHARE:
        name = f"{parameter_name(COULOMB, linear)} apart from {parameter_name(OFFSET, linear)}".replace("_", " ")
        side = "forward" if mean_direction > 0.0 else "backward"
        raise UndeterminedError(name, f"the axis moves {side} only", RECORD[COULOMB])


def _require_excited(equations: NormalEquations, linear: bool) -> None:
    """Each column must keep power above its noise, and enough of it beside the others."""
    kept = [name for name in (INERTIA, VISCOUS, COULOMB) if name in equations.names]
    chosen = equations.select(kept)
    scale = np.sqrt(np.diag(chosen.gram.sum(axis=0)))
    matrix = chosen.matrix / np.outer(scale, scale)
    for index, name in enumerate(kept):
        others = np.delete(np.arange(len(kept)), index)
        inner, cross = matrix[np.ix_(others, others)], matrix[others, index]
        share = matrix[index, index] - cross @ np.linalg.lstsq(inner, cross, rcond=1e-9)[0]
        if not share >= INDEPENDENT_SHARE:
            reason = f"only {max(share, 0.0):.1%} of what would show it differs from the other terms and from noise"
            raise UndeterminedError(parameter_name(name, linear).replace("_", " "), reason, RECORD[name])
