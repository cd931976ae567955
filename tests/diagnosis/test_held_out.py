"""Motion that judges: the holdout where it is of this axis, else a third of every regime, apart from what is fitted."""

import numpy as np
import pytest

from bench.diagnosis.model import HeldOut, balanced, regimes
from bench.diagnosis.recordings import Recordings
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis
from tests.diagnosis.constructed import RIG, moved, recorded
from tests.diagnosis.hand_made import term

RECORDING, OTHER = recorded(moved(3.0)), recorded(moved(2.5), seed=1)


@pytest.fixture(scope="module")
def recordings():
    return Recordings.of(RECORDING, RIG, OTHER)


def test_a_trusted_holdout_judges_what_the_whole_recording_fits(recordings):
    held_out = HeldOut.of(recordings, True, True, fit(recordings.rows, Hypothesis()))
    assert (held_out.fitted, held_out.judge) == (recordings.rows, recordings.holdout_rows)
    assert (held_out.recorded.trace, held_out.seen.trace) == (OTHER, RECORDING)


@pytest.mark.parametrize("holdout", [None, OTHER])
def test_without_a_trusted_holdout_a_third_of_every_regime_judges_the_rest(recordings, holdout):
    """Of both directions, of slow and fast rows, of low and high positions: a sixth at least, two thirds at most."""
    held_out = HeldOut.of(Recordings.of(RECORDING, RIG, holdout), False, True, fit(recordings.rows, Hypothesis()))
    assert held_out.recorded.trace is held_out.seen.trace is RECORDING
    assert not (held_out.recorded.judged & held_out.seen.judged).any()
    assert (held_out.recorded.judged | held_out.seen.judged).all()
    shown = regimes(recordings.rows).sum(axis=0)
    judged = regimes(recordings.rows)[held_out.recorded.judged[recordings.rows.samples()]].sum(axis=0)
    assert 1.0 / 6.0 < np.min(judged / shown) < np.max(judged / shown) < 2.0 / 3.0


def test_rows_within_the_filters_reach_of_both_parts_are_in_neither(recordings):
    """The filter reaches some 6 widths to each side, so that no row that is fitted is made of samples that judge."""
    held_out = HeldOut.of(recordings, False, True, fit(recordings.rows, Hypothesis()))
    smooth, time = recordings.rows.conditioning.filter, RECORDING.time
    reach = smooth.margin * smooth.sample_period
    assert reach > 3.0 * smooth.width
    for rows, others in ((held_out.fitted, held_out.recorded), (held_out.judge, held_out.seen)):
        away = np.abs(rows.time[:, None] - time[others.judged][None, :]).min(axis=1)
        assert away.min() > reach - 1e-9
    near = recordings.rows.effort.size - held_out.fitted.effort.size - held_out.judge.effort.size
    assert 0 < near < 0.2 * recordings.rows.effort.size


def test_blocks_are_held_out_until_a_third_of_each_regime_is():
    """Three blocks forward, then six backward: one of three, two of six, whatever comes last."""
    forward, backward = [10.0, 0.0], [0.0, 10.0]
    assert balanced(np.array([forward] * 3 + [backward] * 6)).tolist() == [False, True, False] * 3


def test_a_part_judges_what_fitted_and_judging_rows_both_tell(recordings):
    """An event within a stretch of rows is determined by those rows alone; a spring everywhere."""
    held_out = HeldOut.of(recordings, False, True, fit(recordings.rows, Hypothesis()))
    inside = float(np.median(held_out.judge.time))
    hypothesis = Hypothesis((term("torsion_spring"), term("load_torque_event", inside, inside + 0.01)))
    judged, whole = (fit(rows, hypothesis) for rows in (held_out.fitted, recordings.rows))
    assert held_out.determines(judged, whole, 0)
    assert not held_out.determines(judged, whole, 1)


def test_an_event_that_the_rest_would_lack_stays_in_it(recordings):
    """Its size there would be arbitrary; the part that is held out is still a third or so, of other times."""
    plain = HeldOut.of(recordings, False, True, fit(recordings.rows, Hypothesis()))
    inside = float(np.median(plain.judge.time))
    whole = fit(recordings.rows, Hypothesis((term("torsion_spring"), term("load_torque_event", inside, inside + 0.01))))
    held_out = HeldOut.of(recordings, False, True, whole)
    assert plain.lacks(whole, 1)
    assert not held_out.lacks(whole, 1)
    assert not np.any(np.abs(held_out.judge.time - inside) < 0.01)
    assert 0.8 < held_out.judge.effort.size / plain.judge.effort.size < 1.2


def test_an_event_that_the_rest_tells_moves_nothing(recordings):
    plain = HeldOut.of(recordings, False, True, fit(recordings.rows, Hypothesis()))
    inside = float(np.median(plain.fitted.time))
    whole = fit(recordings.rows, Hypothesis((term("load_torque_event", inside, inside + 0.01),)))
    assert np.array_equal(HeldOut.of(recordings, False, True, whole).judge.time, plain.judge.time)
