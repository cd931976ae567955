"""Columns of a recording with holes are those of its stretches, each filtered by itself."""

from functools import cache

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.effect import Columns
from bench.effects.rivals import RIVALS, WAVES
from bench.fit.rows import Rows
from bench.trace.trace import Trace
from tests.fit.motions import RIG, recording


@cache
def holed_rows():
    whole = recording(np.random.default_rng(3), position=True)
    kept = (np.arange(len(whole)) % 1811) > 137
    holed = Trace(
        whole.time[kept], {name: whole[name][kept] for name in whole.signals}, dict(whole.units), whole.origin
    )
    rows = Rows.of(holed, RIG)
    assert len(rows.stretches) == 4
    return rows


def test_no_row_reaches_over_a_hole():
    rows = holed_rows()

    def columns(s):
        late = [(s.effort, 1)] if s.time[0] > 2.0 else []  # as an event, which is not in every stretch
        return [[(s.velocity, 1)], [(s.position, 0), (s.velocity, 1), *late]]

    smooth = rows.conditioning.filter
    alone = [smooth.columns(columns(part.signals), (0.0, 1e-3), part.places) for part in rows.stretches]
    assert rows.table(columns, (0.0, 1e-3)) == pytest.approx(np.concatenate(alone, axis=1).T, rel=1e-9, abs=1e-9)


MEMORYLESS = [
    each for each in (*catalogue().values(), *RIVALS, *WAVES) if isinstance(each, Columns) and each.memoryless
]


@pytest.mark.parametrize("effect", MEMORYLESS, ids=lambda effect: effect.name)
def test_columns_without_memory_are_those_of_each_stretch(effect):
    """They are made of all stretches at once, each value from its own sample."""
    rows, shape = holed_rows(), tuple(1.5 for _ in effect.shapes)
    by_stretch = rows.table(lambda signals: effect.columns(signals, shape))
    scale = np.abs(by_stretch).max()
    assert rows.table([rows.columns_of(effect, [shape])]) == pytest.approx(by_stretch, rel=1e-9, abs=1e-12 * scale)


def test_products_with_columns_are_those_of_filtered_ones():
    """Without the columns being filtered, with a derivative, over holes and behind a lag."""
    rows = holed_rows()
    targets = np.random.default_rng(0).normal(size=(rows.time.size, 3))
    (inertia,) = (effect for effect in MEMORYLESS if effect.name == "position_dependent_inertia")
    columns = rows.columns_of(inertia, [(1.0,), (2.0,)])
    filtered = rows.table([columns], 1e-3)
    assert rows.against(targets, 1e-3)(columns) == pytest.approx(filtered.T @ targets, rel=1e-9)
