"""Effects of axes side by side, gathered: one kind of effect on all the axes that have it.

Values are arrays of axes; of a lone axis they are numbers, of which all that is computed costs a fraction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.effect import Effect
from bench.effects.kinds import Axis, Moment, Number, Winding
from bench.plant.axis_model import AxisModel

Kind = TypeVar("Kind", bound=Effect)


@dataclass
class Rows(Generic[Kind]):
    """One effect on some axes of a batch.

    Attributes:
        effect: what it is.
        index: of the axes that have it, None where all do.
        values: of its quantities, (k,) each, or numbers of a lone axis.
        axis: constants of these axes, alike.
        memory: of the effect, alike.
    """

    effect: Kind
    index: NDArray[np.intp] | None
    values: dict[str, Number]
    axis: Axis
    memory: Number = 0.0

    def moment(self, at: Moment) -> Moment:
        """What these axes see of a moment."""
        if self.index is None:
            return at
        return Moment(*(self.of(each) for each in (at.time, at.position, at.velocity, at.effort, at.began)))

    def of(self, values: Number) -> Number:
        """Of values of all axes, or one for all, those of these axes."""
        return values if self.index is None or not isinstance(values, np.ndarray) else values[self.index]

    def put(self, values: Number, these: Number) -> Number:
        """Values of all axes with those of these axes in their places; what came in stays as it is."""
        if self.index is None or not isinstance(values, np.ndarray):
            return these
        changed = values.copy()
        changed[self.index] = these
        return changed


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
        key: abreast([float(getattr(axis, key)) for axis in axes])
        for key in ("inertia", "motor_inertia", "viscous", "coulomb", "peak_effort")
    }
    return Rows(
        effect,
        None if len(index) == len(models) else np.array(index),
        {key: abreast([value[key] for value in values]) for key in values[0]},
        Axis(**constants, winding=_windings(axes)),
        abreast([0.0] * len(index)),
    )


def _windings(axes: Sequence[Axis]) -> Winding | None:
    known = [axis.winding for axis in axes if axis.winding is not None]
    if len(known) < len(axes):
        return None
    names = ("torque_constant", "resistance", "inductance", "back_emf_constant")
    return Winding(**{name: abreast([float(getattr(winding, name)) for winding in known]) for name in names})


def abreast(values: Sequence[float] | Array) -> Number:
    """Values of axes side by side, (axes,), as they are now; that of a lone axis as a number.

    NumPy's, which overflows to infinity as arrays do, where one of Python's raises an error.
    """
    return np.float64(values[0]) if len(values) == 1 else np.array(values, dtype=np.float64)
