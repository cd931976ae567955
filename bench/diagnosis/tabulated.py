"""An unknown effect as a table: fitted to the residual of a diagnosis, and kept if held-out motion confirms it.

The nodes theta of one table, or of a torque and a friction, minimise

    |residual - columns @ theta|**2 + smoothness*|second differences of theta|**2

with the smoothness and the tables that predict blocks of the motion best from the others (cross-validation: M. Stone,
Journal of the Royal Statistical Society B 36, 1974, 111-147; splines with a penalty: P. H. C. Eilers, B. D. Marx,
Statistical Science 11, 1996, 89-121). The tables are kept if they reduce both gaps of motion that no fit used, that of
torque and that of speed. They are no evidence for a name: names, probabilities and verdict are those without them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from bench.arrays import Array, rms
from bench.diagnosis.model import Extension, HeldOut, Recorded, tracking
from bench.effects.effect import LOSSIEST
from bench.effects.present import Present
from bench.effects.signals import Axis
from bench.effects.tabulated import NAMES, NODES, TABLES, Tabulated, TabulatedFriction, TorqueOverPosition
from bench.errors import SimulationError
from bench.fit.fit import Fit
from bench.fit.hypothesis import delays, rows_of_next
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.plant.model_file import StoredModel
from bench.plant.tracking import run_free
from bench.trace.motion import measured_velocity, windows_of

#: Placeholder for the name of an unknown effect.
UNKNOWN = "unknown_effect"
#: Blocks that the motion is cut into, and parts that they are dealt to, each of which is predicted from the others.
BLOCKS, PARTS = 24, 6
#: Smoothness that is tried, in mean squares of a column.
SMOOTHNESS = tuple(10.0**k for k in range(-4, 5))
#: Share of the mean square of a column by which a node without rows is held near zero.
HELD = 1e-6
#: Free-running windows: how long - s -, and how many at most.
WINDOW, WINDOWS = 0.5, 24
#: Tables at most that held-out motion judges, the best first.
TRIED = 3
#: Least relative reduction of a gap; less is chance.
LEAST = 0.02


@dataclass(frozen=True)
class UnknownEffect:
    """What an unknown effect does, tabulated.

    Attributes:
        tables: with their values.
        motion: name of the held-out motion.
        torque: gap there without and with the tables - N*m (N).
        velocity: the same of the speed of free-running simulations of WINDOW - rad/s (m/s).
    """

    tables: tuple[Present, ...]
    motion: str
    torque: tuple[float, float]
    velocity: tuple[float, float]

    @property
    def over(self) -> tuple[str, ...]:
        """Coordinates of the tables."""
        return tuple(dict.fromkeys(TABLES[one.name].over for one in self.tables))

    @property
    def share(self) -> float:
        """Of the squared torque residual of held-out motion."""
        return 1.0 - (self.torque[1] / self.torque[0]) ** 2


def unknown_effect(stage: Extension, held_out: HeldOut) -> UnknownEffect | None:
    """The residual of a model as tables; None where held-out motion does not confirm them, or MuJoCo has no model."""
    judged, judge = replace(stage, recording=held_out.fitted), held_out.recorded
    if stage.model is None or judged.model is None:
        return None
    balance = Balance.of(judged.fitted).repeating(judge.events)
    before = balance.gap(held_out.judge)
    free: float | None = None
    for tables in tabulated(judged.fitted, choices(judged.fitted))[:TRIED]:
        torque = before, rms(remaining(balance, held_out.judge, tables))
        if not shrinks(torque):
            continue
        free = free_gap(judged.model, judge) if free is None else free
        velocity = free, free_gap(with_tables(judged.model, tables), judge)
        whole = tabulated(stage.fitted, [[TABLES[one.name] for one in tables]])
        if shrinks(velocity) and whole:
            return UnknownEffect(whole[0], judge.name, torque, velocity)
    return None


def with_tables(stored: StoredModel, tables: Sequence[Present]) -> StoredModel:
    """A model with tables in addition to its effects."""
    return replace(stored, model=stored.model.with_effects([*stored.model.effects, *tables]))


def free_gap(stored: StoredModel, recorded: Recorded) -> float:
    """RMS of simulated less measured speed at the judged samples - rad/s (m/s); nan where the simulation diverged.

    In windows of a recording, side by side, each of which begins as the recording has it and runs free.
    """
    trace = recorded.trace
    parts = [part for part in windows_of(trace, WINDOW) if recorded.judged[part].any()]
    parts = parts[:: -(-len(parts) // WINDOWS) or 1]
    held, velocity = tracking(stored, trace, recorded.rig, recorded.events), measured_velocity(trace)
    try:
        runs = run_free(held, parts) if parts else []
    except SimulationError:
        return math.nan
    off = [(run.velocity - velocity[part])[recorded.judged[part]] for run, part in zip(runs, parts, strict=True)]
    return rms(np.concatenate(off)) if off else math.nan


def shrinks(gap: tuple[float, float]) -> bool:
    """Whether a gap becomes smaller by more than chance; not where a simulation diverged."""
    return gap[1] < (1.0 - LEAST) * gap[0]


def remaining(balance: Balance, rows: Rows, effects: Iterable[Present]) -> Array:
    """Measured less modelled torque along a recording, the tables among some effects included - N*m (N) - (m,)."""
    residual, hypothesis = balance.left(rows), balance.hypothesis
    tables = [one for one in effects if one.name in TABLES]
    if not tables:
        return residual
    seen = rows_of_next(rows, hypothesis, residual, balance.laid(rows).by_name(balance.theta))
    for one in tables:
        values = dict(one.values)
        columns = partial(TABLES[one.name].columns, shape=[values[name] for name in ("low", "high", "turns")])
        residual = residual - seen.table(columns, delays(rows, hypothesis)[1]) @ [values[name] for name in NAMES]
    return residual


def choices(fitted: Fit) -> list[list[Tabulated]]:
    """Tables that may explain the residual: each that the recording can show, then a torque with each friction."""
    known = [table for table in TABLES.values() if table.sought(fitted.scope)]
    torques = [table for table in known if isinstance(table, TorqueOverPosition)]
    return [*([table] for table in known), *([one, other] for one in torques for other in known if other is not one)]


def tabulated(fitted: Fit, among: Sequence[Sequence[Tabulated]]) -> list[tuple[Present, ...]]:
    """Tables that predict the residual, best first; a choice of two has to be better than one by more than chance."""
    sizes = {table: shape_of(table, fitted) for table in {table for choice in among for table in choice}}
    columns = {
        table: fitted.seen(partial(table.columns, shape=shape), False) * fitted.determined[:, None]
        for table, shape in sizes.items()
    }
    found, limit = [], (1.0 - LEAST) ** 2 * fitted.squares
    for choice in among:
        nodes, missed = smoothed(np.concatenate([columns[table] for table in choice], axis=1), fitted.residual)
        found.append((missed, len(found), list(zip(choice, np.split(nodes, len(choice)), strict=True))))
    single = min((missed for missed, _, parts in found if len(parts) == 1), default=math.inf)
    kept = [one for one in found if one[0] < min(limit, (1.0 - LEAST) ** 2 * single if len(one[2]) > 1 else math.inf)]
    return [
        tuple(present(table, sizes[table], nodes, fitted.base) for table, nodes in parts)
        for _, _, parts in sorted(kept, key=lambda one: one[0])
    ]


def shape_of(table: Tabulated, fitted: Fit) -> tuple[float, float, float]:
    """Where a table begins and ends, and whether it is one of the whole turn: the range of the rows."""
    if table.over == "position" and fitted.scope.kind.turns and fitted.scope.travel > 2.0 * math.pi:
        return 0.0, 2.0 * math.pi, 1.0
    x = fitted.next_rows.values(lambda signals: table.coordinate(signals.state))
    return 0.0 if table.over == "speed" else float(x.min()), float(x.max()), 0.0


def smoothed(columns: Array, residual: Array) -> tuple[Array, float]:
    """Nodes (p,) of tables side by side, of the best smoothness, and the squares that they miss where not fitted.

    By their columns (m, p) and the residual - N*m (N) - (m,).
    """
    rows, width = columns.shape
    part = np.arange(rows) * BLOCKS // rows % PARTS
    own = [(columns[part == k], residual[part == k]) for k in range(PARTS)]
    grams, products = np.array([x.T @ x for x, _ in own]), np.array([x.T @ y for x, y in own])
    squares = float(residual @ residual)
    gram, product = grams.sum(axis=0), products.sum(axis=0)
    second = np.diff(np.eye(NODES), 2, axis=0)
    bending = np.kron(np.eye(width // NODES), second.T @ second)
    scale = float(np.trace(gram)) / width
    held = HELD * scale * np.eye(width)
    found = []
    for smoothness in SMOOTHNESS:
        penalty = smoothness * scale * bending + held
        nodes = np.linalg.solve(gram - grams + penalty, (product - products)[..., None])[..., 0]
        missed = squares + float(np.einsum("ki,kij,kj->", nodes, grams, nodes) - 2.0 * np.sum(nodes * products))
        found.append((missed, np.linalg.solve(gram + penalty, product)))
    missed, nodes = min(found, key=lambda one: one[0])
    return nodes, missed


def present(table: Tabulated, shape: Sequence[float], nodes: Array, base: Axis) -> Present:
    """A table with its values; friction never drives, and takes no larger share of the torque than any gear's."""
    low, high, turns = shape
    if isinstance(table, TabulatedFriction):
        x = np.linspace(low, high, NODES)
        nodes = np.maximum(nodes, -base.coulomb - (base.viscous * x if table.over == "speed" else 0.0))
        if table.over == "speed":
            nodes[0] = max(nodes[0], 0.0)
        if table.over == "torque":
            nodes = np.minimum(nodes, nodes[0] + LOSSIEST * (x - low))
    ends = {"low": low, "high": high, "turns": turns}
    return Present.of(table.name, ends | dict(zip(NAMES, nodes.tolist(), strict=True)))
