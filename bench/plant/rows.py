"""Effects of axes side by side, gathered: one kind of effect on all the axes that have it, values as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.effect import Effect
from bench.effects.kinds import Axis, Moment, Winding
from bench.plant.axis_model import AxisModel

Kind = TypeVar("Kind", bound=Effect)


@dataclass
class Rows(Generic[Kind]):
    """One effect on some axes of a batch.

    Attributes:
        effect: what it is.
        index: of the axes that have it.
        values: of its quantities, (k,) each.
        axis: constants of these axes, (k,) each.
        memory: of the effect, (k,).
    """

    effect: Kind
    index: NDArray[np.intp] | slice
    values: dict[str, Array]
    axis: Axis
    memory: Array = field(default_factory=lambda: np.zeros(0))

    def moment(self, at: Moment) -> Moment:
        """What these axes see of a moment."""
        if isinstance(self.index, slice):
            return at
        time, began = (each[self.index] if isinstance(each, np.ndarray) else each for each in (at.time, at.began))
        return Moment(time, at.position[self.index], at.velocity[self.index], at.effort[self.index], began)


def gather(models: Sequence[AxisModel], kind: type[Kind], ticked: bool = False) -> list[Rows[Kind]]:
    """Effects of a kind, in the order of their names; an effect that an axis has twice makes two of them.

    Args:
        models: of the axes side by side.
        kind: of the effects.
        ticked: only those that MuJoCo does not make by itself.
    """
    found: dict[tuple[str, int], list[int]] = {}
    values: dict[tuple[str, int], list[dict[str, float]]] = {}
    for row, model in enumerate(models):
        count: dict[str, int] = {}
        for present in model.of_kind(kind):
            if ticked and present not in model.ticked:
                continue
            count[present.name] = count.get(present.name, -1) + 1
            key = present.name, count[present.name]
            found.setdefault(key, []).append(row)
            values.setdefault(key, []).append(dict(present.values))
    return [_rows(models, key[0], found[key], values[key], kind) for key in sorted(found)]


def _rows(
    models: Sequence[AxisModel], name: str, index: list[int], values: list[dict[str, float]], kind: type[Kind]
) -> Rows[Kind]:
    effect = next(p.effect for p in models[index[0]].effects if p.name == name)
    assert isinstance(effect, kind)
    axes = [models[row].axis for row in index]
    constants = {
        key: np.array([getattr(axis, key) for axis in axes], dtype=np.float64)
        for key in ("inertia", "motor_inertia", "viscous", "coulomb", "peak_effort")
    }
    return Rows(
        effect,
        slice(None) if len(index) == len(models) else np.array(index),
        {key: np.array([value[key] for value in values]) for key in values[0]},
        Axis(**constants, winding=_windings(axes)),
        np.zeros(len(index)),
    )


def _windings(axes: Sequence[Axis]) -> Winding | None:
    known = [axis.winding for axis in axes if axis.winding is not None]
    if len(known) < len(axes):
        return None
    names = ("torque_constant", "resistance", "inductance", "back_emf_constant")
    return Winding(**{name: np.array([getattr(winding, name) for winding in known]) for name in names})
