"""A recording as effects see it, shapes and scopes to ask them with, and all effects to be asked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from bench.axis_kind import LINEAR, ROTARY
from bench.effects.catalogue import catalogue
from bench.effects.effect import Columns, Effect
from bench.effects.signals import Axis, Scope, Signals
from bench.trace.filter import Column

COUNT, STEP = 2000, 1e-3
#: Shapes of effects that no grid finds: of the event, of the eccentricity, of the dead zone.
SOUGHT_OTHERWISE = {
    "load_torque_event": (0.5, 1.2),
    "encoder_eccentricity": (0.02, 0.01),
    "backlash": (0.02, 1257.0, 0.2, 0.0),
}


def signals() -> Signals:
    """Two seconds of reversals over several revolutions, with torque and a friction level of their own."""
    time = STEP * np.arange(COUNT)
    speed, torque = np.zeros((2, COUNT))
    for amplitude, frequency, phase in ((30.0, 2.3, 0.2), (14.0, 5.1, 1.1), (9.0, 0.7, -0.4)):
        speed += amplitude * np.sin(2.0 * np.pi * frequency * time + phase)
        torque += amplitude * np.cos(2.0 * np.pi * 1.3 * frequency * time - phase)
    position = 0.4 + STEP * np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))])
    sign = np.sign(speed)
    torque = 2.0 * torque / np.abs(torque).max()
    level = sign * (1.0 + 0.3 * np.cos(7.0 * time))
    return Signals(time, position, speed, sign, torque, torque, level, 2.5, STEP)


def shape_of(effect: Effect) -> tuple[float, ...]:
    """A shape within what a search tries."""
    if effect.name in SOUGHT_OTHERWISE:
        return SOUGHT_OTHERWISE[effect.name]
    return tuple(slot.grid[len(slot.grid) // 2] for slot in effect.shapes)


def scopes() -> Iterator[Scope]:
    """What recordings of all kinds show."""
    rotary = Scope(ROTARY, "velocity", frozenset(), False, 6.0, 1e-3, 250e-6, 0.0, 2e-3, 60.0, 100.0, 40.0, 6.0, 5e-4)
    recorded = (
        ("velocity", {"velocity", "current"}),
        ("velocity", {"position", "velocity", "current"}),
        ("position", {"position", "velocity", "current"}),
        ("position", {"position", "current"}),
    )
    for kind, (source, names), one_way in product((ROTARY, LINEAR), recorded, (False, True)):
        yield replace(rotary, kind=kind, source=source, signals=frozenset(names), one_way=one_way)


def balanced() -> list[str]:
    """Names of the effects that the torque balance holds as columns."""
    return [name for name, effect in catalogue().items() if isinstance(effect, Columns)]


def columns_of(effect: Effect, seen: Signals, shape: Sequence[float]) -> list[Column]:
    """Columns of an effect that has some, else none."""
    return effect.columns(seen, shape) if isinstance(effect, Columns) else []


def raw(effect: Effect, seen: Signals) -> list[np.ndarray]:
    """Raw samples of all terms of all columns, (n,) each."""
    return [values for column in columns_of(effect, seen, shape_of(effect)) for values, _ in column]


def plain(effect: Effect, seen: Signals) -> list[np.ndarray]:
    """Columns without derivatives (n,): those of an effect that has a term with one are left out."""
    columns = columns_of(effect, seen, shape_of(effect))
    return [sum(values for values, _ in column) for column in columns if all(order == 0 for _, order in column)]


def differ(one: Sequence[np.ndarray], other: Sequence[np.ndarray]) -> bool:
    """Whether any of the values does by more than rounding."""
    return any(np.abs(a - b).max() > 1e-9 * (np.abs(a).max() + 1e-300) for a, b in zip(one, other, strict=True))


EFFECTS = catalogue()
RECORDED = signals()
BASE = Axis(1.2e-3, 8e-4, 0.06)
SCOPES = list(scopes())

every = pytest.mark.parametrize("effect", EFFECTS.values(), ids=list(EFFECTS))
with_columns = pytest.mark.parametrize("effect", [EFFECTS[name] for name in balanced()], ids=balanced())


def changed(effect: Effect, **others: np.ndarray) -> bool:
    """Whether its columns change with some of the signals."""
    return differ(raw(effect, RECORDED), raw(effect, replace(RECORDED, **others)))


def reported(effect: Effect) -> dict[str, float]:
    """Quantities of strengths that are small."""
    strengths = [5e-4] * len(columns_of(effect, RECORDED, shape_of(effect)))
    return dict(effect.report(strengths, shape_of(effect), BASE))


def made(effect: Effect) -> np.ndarray:
    """Sum of its columns without derivatives at the strengths of `reported` (n,)."""
    return 5e-4 * np.sum(plain(effect, RECORDED), axis=0)
