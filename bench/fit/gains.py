"""What columns would explain of a residual beside those that are fitted."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array, symmetric_inverse


def gains(columns: Array, width: int, residual: Array, basis: Array) -> Array:
    """Squares that groups of columns take from a residual (m,) beyond what an orthonormal basis (m, p) spans.

    Args:
        columns: (m, groups*width), group by group.
        width: columns of a group.
        residual: (m,).
        basis: (m, p).

    Returns:
        (groups,) - the residual's unit squared.
    """
    rows = np.ascontiguousarray(columns.T)
    full = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    rows = rows - (rows @ basis) @ basis.T
    scale = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    rows *= np.where(scale > 1e-4 * np.maximum(full, 1e-300), 1.0 / np.maximum(scale, 1e-300), 0.0)[:, None]
    shared = (rows @ residual).reshape(-1, width)
    groups = rows.reshape(-1, width, rows.shape[1])
    inverse = symmetric_inverse(groups @ groups.transpose(0, 2, 1), 1e-8)
    return np.einsum("gi,gij,gj->g", shared, inverse, shared)
