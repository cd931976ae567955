"""Dry frictions of one axis multiply: what scales the level scales all that other effects add to it.

    M = (K_0 + sum of added levels)*(1 + w_1)*(1 + w_2)*...

Linear in the strengths only with the other strengths held, as share of K_0; a fit brings them in line.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.workbench import Workbench
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect, Signals

if TYPE_CHECKING:
    from bench.diagnose.hypothesis import Hypothesis, Named

Levels = tuple[tuple[float, ...], ...]


def rubbing(seen: Workbench, hypothesis: Hypothesis, index: int) -> Workbench:
    """The recording with the level of dry friction that the effect at an index scales, as share of K_0.

    sgn(omega) and what effects add to it, times what scales it before the one at the index.
    """
    adding, scaling = [], []
    for (k, effect, physics), level in zip(_frictions(hypothesis), _given(hypothesis), strict=True):
        if level and k != index and (not physics.scales_friction or k < index):
            (scaling if physics.scales_friction else adding).append((physics, effect.shape, level))

    def change(signals: Signals) -> Signals:
        for physics, shape, level in (*adding, *scaling):
            signals = replace(signals, friction=signals.friction + physics.level(signals, shape, level))
        return signals

    return seen.with_signals(change) if adding or scaling else seen


def levels_of(hypothesis: Hypothesis, theta: NDArray[np.float64], owners: NDArray[np.int64]) -> Levels:
    """Strengths over K_0 of the effects that are dry friction, where K_0 is positive; () of the others."""
    rubs = {index for index, _, _ in _frictions(hypothesis)} if theta[2] > 0.0 else set()
    return tuple(
        tuple(float(value) for value in theta[owners == index] / theta[2]) if index in rubs else ()
        for index in range(len(hypothesis.effects))
    )


def multiply(hypothesis: Hypothesis) -> bool:
    """Whether an effect scales what another adds."""
    rubs = [physics for _, _, physics in _frictions(hypothesis)]
    return len(rubs) > 1 and any(physics.scales_friction for physics in rubs)


def alike(levels: Levels, before: Levels) -> bool:
    """Whether levels have settled."""
    if [len(level) for level in levels] != [len(level) for level in before]:
        return False
    return all(np.allclose(new, old, rtol=1e-3, atol=1e-6) for new, old in zip(levels, before, strict=True))


def _frictions(hypothesis: Hypothesis) -> Iterator[tuple[int, Named, Effect]]:
    for index, effect in enumerate(hypothesis.effects):
        physics = catalogue().get(effect.name)
        if physics is not None and type(physics).level is not Effect.level:
            yield index, effect, physics


def _given(hypothesis: Hypothesis) -> Iterator[tuple[float, ...]]:
    for index, _, _ in _frictions(hypothesis):
        yield hypothesis.levels[index] if index < len(hypothesis.levels) else ()
