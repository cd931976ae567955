"""Several recordings of one axis as one trace."""

from dataclasses import replace

import numpy as np
import pytest

from bench.errors import InputError
from bench.fit.hypothesis import Hypothesis, lay_out
from bench.fit.rows import Rows
from bench.trace.trace import Trace, join
from tests.fit.motions import RIG, recording


def run_of(seed, **more):
    return replace(recording(np.random.default_rng(seed), duration=2.0, **more), origin=f"run{seed}")


def test_recordings_stand_one_after_the_other_with_a_hole_between():
    first, second = run_of(1), run_of(2)
    joined = join([first, second])
    assert len(joined.segments) == 2
    assert joined.origin == "run1 and run2"
    assert [origin for _, origin in joined.joined] == ["run1", "run2"]
    for part, trace in zip(joined.segments, (first, second), strict=True):
        assert np.array_equal(joined["velocity"][part], trace["velocity"])
        assert joined.time[part] - joined.start_of(part) == pytest.approx(trace.time - trace.time[0])
    assert join([first]) is first


def test_rows_of_joined_recordings_are_those_of_each():
    runs = [run_of(k, position=True) for k in (1, 2)]
    rows = Rows.of(join(runs), RIG)
    alone = [Rows.of(run, RIG, conditioning=rows.conditioning) for run in runs]
    columns = [lay_out(each, Hypothesis()).columns for each in alone]
    assert lay_out(rows, Hypothesis()).columns == pytest.approx(np.concatenate(columns), rel=1e-9, abs=1e-12)
    assert [part.signals.began > 0.0 for part in rows.stretches] == [False, True]
    assert all(part.signals.time[0] == pytest.approx(0.0) for part in rows.stretches)
    assert (np.diff(rows.time) > 0.0).all()


def test_every_recording_has_its_own_phase_of_the_mains():
    runs = [run_of(k) for k in (1, 2)]
    rows = Rows.of(join(runs), RIG)
    laid = lay_out(rows, Hypothesis(hum=(50.0,)))
    late = rows.time > rows.starts[1]
    assert laid.columns.shape[1] == 8
    assert not laid.columns[late, 4:6].any()
    assert not laid.columns[~late, 6:8].any()


def test_the_longest_sample_period_is_taken():
    fine, coarse = run_of(1), run_of(2, period=2e-3)
    joined = join([fine, coarse])
    assert joined.sample_period == pytest.approx(2e-3)
    assert joined["velocity"][joined.segments[0]] == pytest.approx(fine["velocity"][::2], abs=1e-9)
    assert np.array_equal(joined["velocity"][joined.segments[1]], coarse["velocity"])
    assert any("run1 taken every 0.002 s" in note for note in joined.notes)


def test_a_signal_that_one_recording_lacks_is_left_out_and_reported():
    joined = join([run_of(1, position=True), run_of(2)])
    assert "position" not in joined
    assert any("position: omitted" in note for note in joined.notes)


def linear(samples=50):
    return Trace(np.arange(samples) * 1e-3, {"velocity": np.arange(float(samples))}, {"velocity": "m/s"}, "linear")


@pytest.mark.parametrize(
    ("traces", "words"),
    [
        ([], "found none"),
        ([run_of(1), run_of(1)], "the same recording as run1"),
        ([run_of(1), linear()], "linear: velocity"),
    ],
    ids=["none", "twice", "units"],
)
def test_what_does_not_go_together_is_refused(traces, words):
    with pytest.raises(InputError, match=words):
        join(traces)


def test_recordings_stand_ten_periods_apart_whatever_their_own_times():
    def run(start, samples, origin):
        time = start + 0.5 * np.arange(samples)
        return Trace(time, {"velocity": time}, {"velocity": "rad/s"}, origin)

    joined = join([run(100.0, 4, "a"), run(0.0, 3, "b")])
    assert joined.time.tolist() == [100.0, 100.5, 101.0, 101.5, 106.5, 107.0, 107.5]
    assert joined.joined == ((100.0, "a"), (106.5, "b"))
    assert joined["velocity"].tolist() == [100.0, 100.5, 101.0, 101.5, 0.0, 0.5, 1.0]


@pytest.mark.parametrize(("other", "resampled"), [(0.5 * (1 - 0.9e-5), False), (0.5 * (1 - 1.1e-5), True)])
def test_sample_periods_within_a_hundred_thousandth_are_one(other, resampled):
    runs = [
        Trace(period * np.arange(200), {"velocity": sign * np.arange(200.0)}, {"velocity": "rad/s"}, str(period))
        for period, sign in ((0.5, 1.0), (other, -1.0))
    ]
    joined = join(runs)
    assert joined.time_base is not None and joined.time_base.resampled == resampled
    assert np.array_equal(joined["velocity"][200:], -np.arange(200.0)) != resampled
