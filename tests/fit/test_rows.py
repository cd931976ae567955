"""Columns of a recording with holes are those of its stretches, each filtered by itself."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.effect import Columns
from bench.effects.rivals import WAVES
from bench.fit.rows import Rows
from bench.trace.trace import Trace
from tests.fit.motions import RIG, recording


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


COPIES = [effect for effect in catalogue().values() if isinstance(effect, Columns) and effect.copies_torque]


@pytest.mark.parametrize("effect", [*COPIES, *WAVES], ids=lambda effect: effect.name)
def test_copies_of_torque_are_made_of_each_sample_alone(effect):
    """Their columns are made of all stretches at once."""
    rows, shape = holed_rows(), tuple(1.5 for _ in effect.shapes)
    by_stretch = rows.table(lambda signals: effect.columns(signals, shape))
    assert np.array_equal(rows.table([effect.columns(rows.joined, shape)]), by_stretch)
    assert np.abs(by_stretch).max() > 0.0
