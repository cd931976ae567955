"""Motion that judges: the holdout where it is of this axis, else the last third, apart from what is fitted."""

import numpy as np
import pytest

from bench.diagnosis.model import HeldOut
from bench.diagnosis.recordings import Recordings
from tests.diagnosis.constructed import RIG, moved, recorded

RECORDING, OTHER = recorded(moved(3.0)), recorded(moved(2.5), seed=1)


@pytest.fixture(scope="module")
def recordings():
    return Recordings.of(RECORDING, RIG, OTHER)


def test_a_trusted_holdout_judges_what_the_whole_recording_fits(recordings):
    held_out = HeldOut.of(recordings, True, True)
    assert (held_out.fitted, held_out.judge) == (recordings.rows, recordings.holdout_rows)
    assert (held_out.recorded.trace, held_out.seen.trace) == (OTHER, RECORDING)


@pytest.mark.parametrize("holdout", [None, OTHER])
def test_without_a_trusted_holdout_the_last_third_judges_the_rest(recordings, holdout):
    """Rows closer to the split than the filter reaches, 4 widths or so, are made of both sides and in neither."""
    held_out = HeldOut.of(Recordings.of(RECORDING, RIG, holdout), False, True)
    smooth = recordings.rows.conditioning.filter
    split, reach, time = 2.0 / 3.0 * 2.999, smooth.margin * 1e-3, recordings.rows.time
    assert reach > 3.0 * smooth.width
    assert held_out.fitted.time == pytest.approx(time[time < split - reach])
    assert held_out.judge.time == pytest.approx(time[time >= split + reach])
    assert held_out.recorded.trace is held_out.seen.trace is RECORDING
    assert np.array_equal(held_out.recorded.judged, RECORDING.time >= split)
    assert np.array_equal(held_out.seen.judged, RECORDING.time < split)
