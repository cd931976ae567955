"""Whether the residual depends on torque or on the square of speed: a gain of the current sensor that is not constant.

    residual = c*z,   z = M*(M/M_max)**2,   M*(omega/omega_max)**2   or   omega*|omega|/omega_max**2

M - modelled torque - N*m (N); omega - speed - rad/s (m/s); c - strength, tested against its own standard error, which
counts correlated residuals. Most of such an error looks like inertia: 11 % more RMS than noise moved J by 4 %.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.axis_kind import OFFSET
from bench.fit.hypothesis import Layout, Name
from bench.fit.rows import Rows
from bench.fit.solution import NormalEquations, block_edges, equations, estimated

#: Half widths of 95 % that a strength has to exceed: on 200 recordings of axes that lack nothing the largest had 1.4.
CLEAR = 1.6
#: RMS torque that only the dependence explains, over that of the effort, from which on it matters.
LEAST = 1e-3
CAUSES = {
    "torque": "the torque constant or the current sensor is not linear",
    "speed²": "a drag, or a torque constant that falls with speed",
}


@dataclass(frozen=True)
class Dependence:
    """A dependence of the residual that is more than chance.

    Attributes:
        on: `torque` or `speed²`.
        moved: change of each fitted number by its name, were the dependence part of the model.
    """

    on: str
    moved: Mapping[Name, float]

    def __str__(self) -> str:
        return f"the residual depends on the {self.on}, which noise does not: {CAUSES[self.on]}"


def dependence(rows: Rows, laid: Layout, theta: Array, offset: bool = False) -> Dependence | None:
    """The clearest dependence of a model's residual; `theta` of its columns, `offset`: whether it has a constant."""
    modelled, speed = laid.columns @ theta[: laid.owners.size], rows.values(lambda s: s.velocity)
    load, fast = (values / max(float(np.abs(values).max()), 1e-300) for values in (modelled, speed))
    # each column, and by how much it moves with the noise of the modelled torque
    tested = {
        "load": ("torque", modelled * load**2, 3.0 * load**2),
        "gain": ("speed²", modelled * fast**2, fast**2),
        "drag": ("speed²", fast * np.abs(fast), 0.0 * fast),
    }
    slopes, size = np.array([slope for *_, slope in tested.values()]), laid.owners.size
    of_torque = laid.noise @ theta[:size]
    shared = np.outer(slopes.mean(axis=1), of_torque)
    own = slopes @ slopes.T / speed.size * float(theta[:size] @ of_torque)
    table = np.vstack([laid.columns.T, *(column for _, column, _ in tested.values()), np.ones(speed.size), laid.effort])
    noise = np.pad(np.block([[laid.noise, shared.T], [shared, own]]), (0, 1))

    def between(edges: NDArray[np.int64]) -> NormalEquations:
        return equations((*laid.owners, *tested, OFFSET), table, noise, edges, laid.known)

    every = between(np.array([0, speed.size]))
    base = [name for name in every.names if name not in tested and (offset or name in laid.owners)]
    least = rows.conditioning.effort_noise**2 / rows.conditioning.filter.stride
    without = every.only(lambda each: each in base)
    plain, _ = without.solved()
    found: dict[float, Dependence] = {}
    for name, (on, _, _) in tested.items():
        kept = [*base, name]
        having = every.only(lambda each, kept=kept: each in kept)
        fitted, inverse = having.solved()
        saved = (without.residual_power(plain) - having.residual_power(fitted)) / having.count
        if saved <= (LEAST * rms(laid.effort)) ** 2:
            continue
        blocks = between(block_edges(rows.time, rows.conditioning.filter.width))
        scores = blocks.only(lambda each, kept=kept: each in kept).scores(fitted)
        covariance, reach = estimated(scores, inverse, least)
        at = having.names.index(name)
        size = abs(float(fitted[at])) / max(reach * float(np.sqrt(covariance[at, at])), 1e-300)
        if size > CLEAR:
            moved = dict(zip(without.names, (np.delete(fitted, at) - plain).tolist(), strict=True))
            found[size] = Dependence(on, moved)
    return found[max(found)] if found else None
