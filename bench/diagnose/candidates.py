"""Every effect of the catalogue tried beside a fitted hypothesis: how much of what is left would it take?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.columns import lags, prepared
from bench.diagnose.fit import Fit, fit
from bench.diagnose.friction_levels import rubbing
from bench.diagnose.grids import TURNING, sought
from bench.diagnose.hypothesis import BACKLASH, CURRENT_LAG, ECCENTRICITY, ELASTIC, VELOCITY_LAG, Named
from bench.diagnose.outside import OUTSIDE
from bench.diagnose.soft_coupling import coupled_columns
from bench.diagnose.workbench import Workbench
from bench.effects.catalogue import catalogue
from bench.effects.effect import Column, Signals

Array = NDArray[np.float64]

EVENT = "load_torque_event"
#: Motor and load are joined in one way.
TWO_BODIES = frozenset({ELASTIC, BACKLASH})
#: Grid of lags - s, of antiresonances - rad/s, and of the coupling's damping ratio.
LAGS = (3e-4, 8e-4, 2e-3, 4e-3, 8e-3)
ANTIRESONANCES = tuple(2.0 * np.pi * float(f) for f in np.geomspace(8.0, 110.0, 28))
DAMPINGS = (0.01, 0.04, 0.12)
#: Points in time between which events are sought.
EVENT_EDGES = 240


@dataclass(frozen=True)
class Candidate:
    """An effect tried.

    Attributes:
        named: effect and shape.
        gain: sum of squares it would take from the residual - (N*m)**2 (N**2).
    """

    named: Named
    gain: float


def candidates(bench: Workbench, current: Fit, excluded: frozenset[str] = frozenset()) -> list[Candidate]:
    """Best shape on the grid of every effect that is not in the hypothesis yet, best first."""
    basis = current.span
    hypothesis = current.hypothesis
    seen = rubbing(prepared(bench, hypothesis), hypothesis, len(hypothesis.effects))
    excluded = excluded | TURNING if bench.linear else excluded
    best: dict[str, Candidate] = {}
    present = {effect.name for effect in current.hypothesis.effects}
    found = _linear(seen, current, basis, excluded)
    for candidate in (
        *found,
        *_transforms(bench, seen, current, basis, excluded),
        *_events(seen, current, basis, excluded),
    ):
        name = candidate.named.name
        repeatable = name in ("cogging_torque", "torque_ripple", EVENT)
        if present & TWO_BODIES and name in TWO_BODIES:
            continue
        if name in present and (not repeatable or candidate.named in current.hypothesis.effects):
            continue
        if name not in best or candidate.gain > best[name].gain:
            best[name] = candidate
    return sorted(best.values(), key=lambda candidate: -candidate.gain)


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
    full = np.sqrt(np.sum(rows**2, axis=1))
    rows = rows - (rows @ basis) @ basis.T
    scale = np.sqrt(np.sum(rows**2, axis=1))
    rows = rows * np.where(scale > 1e-4 * np.maximum(full, 1e-300), 1.0 / np.maximum(scale, 1e-300), 0.0)[:, None]
    shared = (rows @ residual).reshape(-1, width)
    groups = rows.reshape(-1, width, rows.shape[1])
    inverse = np.linalg.pinv(groups @ groups.transpose(0, 2, 1), rcond=1e-8, hermitian=True)
    return np.einsum("gi,gij,gj->g", shared, inverse, shared)


def _linear(seen: Workbench, current: Fit, basis: Array, excluded: frozenset[str]) -> Iterator[Candidate]:
    """Effects that are columns of raw products, each over its grid, all filtered in one go."""
    _, resting = lags(seen, current.hypothesis)
    for physics in (*catalogue().values(), *OUTSIDE.values()):
        if physics.name in excluded or physics.name == EVENT or not physics.searched:
            continue
        grids = _grid(sought(seen, physics))
        if not grids:
            continue
        made = seen.table(lambda s, p=physics, g=grids: [c for shape in g for c in p.columns(s, shape)], resting)
        width = made.shape[1] // len(grids)
        worth = gains(made, width, current.residual, basis)
        yield from (Candidate(Named(physics.name, shape), float(w)) for shape, w in zip(grids, worth, strict=True))


def _grid(sought_along: tuple[tuple[float, ...], ...]) -> list[tuple[float, ...]]:
    if not sought_along:
        return [()]
    mesh = np.meshgrid(*sought_along, indexing="ij")
    return [tuple(float(value) for value in point) for point in zip(*(m.ravel() for m in mesh), strict=True)]


def _transforms(
    bench: Workbench, seen: Workbench, current: Fit, basis: Array, excluded: frozenset[str]
) -> Iterator[Candidate]:
    """Effects that change how columns are made: lags by fitting anew, the others by their first-order columns."""
    before = float(np.sum(current.residual**2))
    moving, _ = lags(bench, current.hypothesis)
    for name in (CURRENT_LAG, VELOCITY_LAG):
        other = bench.conditioning.source == "position" and name == VELOCITY_LAG
        if name in excluded or other or {CURRENT_LAG, VELOCITY_LAG} & set(current.hypothesis.names):
            continue
        for lag in LAGS:
            tried = fit(bench, current.hypothesis.with_effect(Named(name, (lag,))))
            worth = before - float(np.sum(tried.residual**2))
            yield Candidate(Named(name, (lag,)), worth)
    if ELASTIC not in excluded:
        shapes = [(antiresonance, damping) for antiresonance in ANTIRESONANCES for damping in DAMPINGS]
        made_of = ("couplings", moving, current.hypothesis.shape_of(ECCENTRICITY))
        made = seen.memory.get(made_of, lambda: coupled_columns(seen, shapes, (), moving))
        worth = gains(made, 1, current.residual, basis)
        yield from (Candidate(Named(ELASTIC, shape), float(w)) for shape, w in zip(shapes, worth, strict=True))
    if ECCENTRICITY not in excluded and ECCENTRICITY not in current.hypothesis.names:
        columns = seen.table(_eccentric, moving)
        worth = float(gains(columns, 2, current.residual, basis)[0])
        start = np.linalg.lstsq(columns, current.residual, rcond=None)[0] / -current.theta[0]
        yield Candidate(Named(ECCENTRICITY, (float(start[0]), float(start[1]))), worth)


def _eccentric(signals: Signals) -> list[Column]:
    """First-order columns of e_s and e_c: alpha errs by d/dt(omega*(e_s*cos(q) - e_c*sin(q)))."""
    omega, angle = signals.velocity, signals.position
    return [[(omega * np.cos(angle), 1)], [(-omega * np.sin(angle), 1)]]


def _events(seen: Workbench, current: Fit, basis: Array, excluded: frozenset[str]) -> Iterator[Candidate]:
    """The best window of time, all of them compared through cumulative sums."""
    if EVENT in excluded:
        return
    time = seen.row_values(lambda s: s.time)
    edges = np.unique(np.linspace(0, time.size, EVENT_EDGES + 1).astype(int))
    summed = np.concatenate([[0.0], np.cumsum(current.residual)])[edges]
    spanned = np.concatenate([np.zeros((1, basis.shape[1])), np.cumsum(basis, axis=0)])[edges]
    first, last = np.triu_indices(edges.size, 1)
    kept = (edges[last] - edges[first]) < 0.6 * time.size
    first, last = first[kept], last[kept]
    power = (edges[last] - edges[first]) - np.sum((spanned[last] - spanned[first]) ** 2, axis=1)
    count = edges[last] - edges[first]
    worth = np.where(power > 0.02 * count, (summed[last] - summed[first]) ** 2 / np.maximum(power, 1e-9), 0.0)
    best = int(np.argmax(worth))
    stop = min(int(edges[last[best]]), time.size - 1)
    yield Candidate(Named(EVENT, (float(time[edges[first[best]]]), float(time[stop]))), float(worth[best]))
