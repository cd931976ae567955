"""Numbers by hand at the borders on which reading a recording decides: wraps, empty cells, counted samples."""

from contextlib import nullcontext

import numpy as np
import pytest

from bench.errors import InputError
from bench.trace.candidates import candidates
from bench.trace.channel import Channel, Recording, split_label
from bench.trace.choose import GivenOptions
from bench.trace.trace import assemble, require_plausible
from bench.trace.wraps import period_of


def recording(**columns):
    """A table of columns; a column's unit stands after two underscores, with `_` for `/`."""
    labels = {key: key.replace("__", " [").replace("_", "/") + "]" * ("__" in key) for key in columns}
    channels = (Channel(*split_label(labels[key]), np.asarray(v, dtype=float), "file") for key, v in columns.items())
    return Recording(tuple(channels), "table", "file")


COUNT = np.arange(40.0)
WRAPS = GivenOptions(position_period=10.0)


def assembled(columns, trace=None, refused=None):
    """The trace of columns; None where they are refused in these words."""
    with pytest.raises(InputError, match=refused) if refused else nullcontext():
        return assemble(columns, trace)


@pytest.mark.parametrize(
    ("step", "speed", "refused"),
    [
        *((step, {}, None) for step in (1.0, 4.4, -4.4)),
        (4.6, {}, r"sample 1, .*moves by half of its period 10 from one sample to the next"),
        (4.6, {"velocity__rad_s": 0 * COUNT + 4.6}, None),
    ],
)
def test_a_position_that_moves_by_045_periods_a_sample_needs_a_speed(step, speed, refused):
    trace = assembled(recording(time__s=COUNT, position__rad=np.mod(step * COUNT, 10.0), **speed), WRAPS, refused)
    if trace is not None:
        np.testing.assert_allclose(np.diff(trace["position"]), step, atol=1e-12)


@pytest.mark.parametrize(("even", "odd"), [(-1.0, 11.4), (1.0, -11.4), (14.6, 14.6), (20.0, 9.2)])
def test_the_mean_of_the_speeds_at_both_ends_tells_how_far_it_moved(even, odd):
    """0.5*(-1 + 11.4) rad/s over 1 s is 5.2 rad of a period of 10: one end alone would say -1 or 11.4 rad."""
    step = 0.5 * (even + odd)
    speed = np.where(COUNT % 2 == 0, even, odd)
    trace = assemble(recording(time__s=COUNT, position__rad=np.mod(step * COUNT, 10.0), velocity__rad_s=speed), WRAPS)
    np.testing.assert_allclose(np.diff(trace["position"]), step, atol=1e-12)
    assert trace.wraps is not None and trace.wraps.period == 10.0
    assert trace.wraps.count == pytest.approx(abs(39 * step / 10.0), abs=1.0)


@pytest.mark.parametrize(("off", "is_turn"), [(2.9e-3, True), (-2.9e-3, True), (3.1e-3, False), (-3.1e-3, False)])
def test_a_period_within_3_permille_of_a_turn_is_one_where_counts_are_coarse(off, is_turn):
    """One count of the file is worth 0.1 rad, so that the jumps' own doubt would allow for more."""
    count, period = np.arange(200.0), 2.0 * np.pi * (1.0 + off)
    position = Channel("position", "0.1 rad", 10.0 * np.mod(0.1 * count, period), "file")
    trace = assemble(Recording((Channel("time", "s", count, "file"), position), "table", "file"))
    assert trace.wraps is not None
    assert trace.wraps.period == pytest.approx(2.0 * np.pi if is_turn else period, rel=1e-9)


@pytest.mark.parametrize(("longest", "wraps"), [(3.5, False), (3.2, True)])
def test_a_jump_less_than_three_times_the_longest_other_step_is_no_wrap(longest, wraps):
    """From 0 to 10 and again from 0, a jump of 10, with one step of another length on the way."""
    way = np.concatenate([np.arange(0.0, 5.0), np.arange(4.0 + longest, 10.0), [10.0]])
    position = np.concatenate([way, way])
    trace = assemble(recording(time__s=np.arange(position.size), position__rad=position))
    assert (trace.wraps is not None) == wraps


def test_an_empty_cell_takes_its_own_sample_and_no_other():
    """1.2 ms printed in whole ms: the line through them misses the printed times by up to 0.4 ms, a third of a period.

    The sample whose cell is empty goes although it stands that far off; its neighbours, two thirds off, stay.
    """
    count = np.arange(400.0)
    values, empty = count.copy(), [7, 103, 202]
    values[empty] = np.nan
    trace = assemble(recording(time__ms=np.rint(1.2 * count), velocity__rad_s=count, current__A=values))
    assert trace["velocity"].tolist() == np.delete(count, empty).tolist()
    assert trace.time_base is not None
    assert [duration for _, duration in trace.time_base.holes] == pytest.approx([2.4e-3] * 3, rel=1e-3)


def test_where_samples_are_interpolated_an_empty_cell_takes_all_within_a_period_of_it():
    """Of a sample 0.2 late, the places 0.2 before and 0.8 behind; of one 0.2 early, those 0.8 before and 0.2 behind."""
    time = np.arange(500.0)
    time[[253, 403]] += [0.2, -0.2]
    values = np.cos(time / 40.0)
    values[[253, 403]] = np.nan
    trace = assemble(recording(time__s=time, velocity__rad_s=np.sin(time / 40.0), current__A=values))
    assert trace.time_base is not None and trace.time_base.resampled
    assert trace.time.tolist() == np.delete(np.arange(500.0), [253, 254, 402, 403]).tolist()


def test_a_sample_index_counts_by_its_usual_step_whatever_is_lost():
    """Every second sample was kept and 20 in a row lost: the step is 2, whatever the mean says."""
    index = np.delete(2.0 * np.arange(100.0), np.arange(40, 60))
    trace = assemble(recording(sample=index, velocity__rad_s=index), GivenOptions(sample_period=1e-3))
    np.testing.assert_allclose(trace.time, 0.5e-3 * index, rtol=1e-12)
    assert trace.time_base is not None
    assert trace.time_base.holes == (pytest.approx((0.039, 0.021)),)


def test_a_sample_index_that_stands_is_refused_where_it_does():
    index = np.array([0.0, 1.0, 2.0, 2.0, 3.0])
    with pytest.raises(InputError, match=r"sample 3.*does not increase"):
        assemble(recording(sample=index, velocity__rad_s=index), GivenOptions(sample_period=1e-3))


@pytest.mark.parametrize(("lost", "refused"), [(2, None), (3, "found 3 of 40 times empty; allowed: 5 % of them")])
def test_times_may_be_empty_in_one_of_twenty_rows(lost, refused):
    time = np.where((COUNT >= 5) & (5 + lost > COUNT), np.nan, COUNT)
    trace = assembled(recording(time__s=time, velocity__rad_s=COUNT), None, refused)
    if trace is not None:
        np.testing.assert_allclose(trace.time, COUNT, rtol=1e-12)


@pytest.mark.parametrize(("lost", "note"), [(2, "a hole each"), (3, "is given in 37 of 40 rows")])
def test_a_signal_in_fewer_than_19_of_20_rows_is_sampled_there(lost, note):
    values = np.where(np.isin(COUNT, 10 + np.arange(lost)), np.nan, COUNT)
    trace = assemble(recording(time__s=COUNT, velocity__rad_s=COUNT, current__A=values))
    assert [words for words in ("a hole each", "is given in 37 of 40 rows") if words in " ".join(trace.notes)] == [note]


ANOTHER = r"rig's .trace. has sample_period = 0\.001 s"


@pytest.mark.parametrize(("step", "refused"), [(1.019e-3, None), (1.022e-3, ANOTHER), (0.978e-3, ANOTHER)])
def test_the_rigs_sample_period_and_the_files_times_agree_within_2_percent(step, refused):
    given = GivenOptions(sample_period=1e-3)
    trace = assembled(recording(time__s=step * COUNT, velocity__rad_s=COUNT), given, refused)
    assert trace is None or trace.sample_period == pytest.approx(step)


@pytest.mark.parametrize(("others", "refused"), [(1, None), (2, "2 of 100 samples repeat the time of another one")])
def test_one_sample_in_a_hundred_may_repeat_a_time_with_another_value(others, refused):
    time = np.arange(100.0)
    time[50 : 50 + others] -= others
    trace = assembled(recording(time__s=np.sort(time), velocity__rad_s=np.arange(100.0)), None, refused)
    assert trace is None or trace.time_base.duplicates == 1


@pytest.mark.parametrize(("lost", "hole"), [(1, False), (2, True)])
def test_one_lost_sample_is_filled_and_two_are_a_hole(lost, hole):
    kept = np.delete(np.arange(200.0), np.arange(90, 90 + lost))
    trace = assemble(recording(time__ms=10.0 * kept, velocity__rad_s=kept))
    assert trace.time_base is not None
    assert (len(trace.time_base.holes), trace.time_base.interpolated) == ((1, 0) if hole else (0, 1))
    assert len(trace.segments) == 1 + hole


def test_a_foreign_clock_is_known_within_its_own_ends_and_holes():
    """The current is sampled every 2 s from 10 s to 80 s, with nothing from 30 s to 50 s; half a sample is allowed."""
    every, own = np.arange(100.0), np.r_[10.0:31.0:2.0, 50.0:81.0:2.0]
    clock, foreign = (Channel("t", "s", time, "file") for time in (every, own))
    speed = Channel("velocity", "rad/s", every, "file", time=clock)
    current = Channel("current", "A", 2.0 * own, "file", time=foreign)
    trace = assemble(Recording((speed, current), "container", "file"))
    assert trace.time.tolist() == [*np.arange(10.0, 31.0), *np.arange(50.0, 81.0)]
    np.testing.assert_allclose(trace["current"], 2.0 * trace.time, atol=1e-9)


@pytest.mark.parametrize(
    ("span", "refused"), [(10.05, None), (10.2, r"spans 10\.2, more than its period 10; allowed: a position_period")]
)
def test_a_position_that_spans_more_than_its_period_does_not_wrap_by_it(span, refused):
    columns = recording(time__s=COUNT, position__rad=np.linspace(0.0, span, COUNT.size))
    trace = assembled(columns, WRAPS, refused)
    assert trace is None or np.ptp(trace["position"]) == pytest.approx(span)


def test_an_inverted_temperature_is_inverted_from_its_absolute_zero():
    columns = recording(time__s=COUNT, velocity__rad_s=COUNT, warmth=0.0 * COUNT + 20.0)
    trace = assemble(columns, {"temperature": "-warmth [degC]"})
    assert trace["temperature"] == pytest.approx(-293.15)


@pytest.mark.parametrize(("other", "derivative"), [(0.45, True), (0.52, False)])
def test_a_column_that_correlates_by_09_with_anothers_rate_is_its_derivative(other, derivative):
    """A share k of another sine beside the rate leaves a correlation of 1/sqrt(1 + k**2): 0.912 and 0.887."""
    time = np.arange(4000.0)
    angle, rate = -np.cos(time / 100.0) * 100.0, np.sin(time / 100.0)
    found = candidates(recording(t=time, a=angle, b=rate + other * np.sin(time / 37.0)).channels)
    guesses = {channel.name: guess.signal for channel, guess in found.items() if channel.name != "t"}
    assert guesses == ({"a": "position", "b": "velocity"} if derivative else {})


@pytest.mark.parametrize(
    ("top", "refused"),
    [
        *((sign * top, None) for sign in (1.0, -1.0) for top in (0.0, 1.1e-30, 0.99e8)),
        (1.01e8, "found 1.01e\\+08 rad/s at 39 s"),
        (-1.01e8, "found -1.01e\\+08 rad/s at 39 s"),
        *((sign * 0.9e-30, "nothing beyond 9e-31") for sign in (1.0, -1.0)),
    ],
)
def test_magnitudes_that_no_axis_has(top, refused):
    """A velocity beyond 1e8 rad/s, and one whose square underflows; one that is zero throughout is another's matter."""
    trace = assemble(recording(time__s=COUNT, velocity__rad_s=top * (COUNT == 39.0)))
    with pytest.raises(InputError, match=refused) if refused else nullcontext():
        require_plausible(trace)


def jumping(period, noise, seed=0):
    """A position that turns on evenly inside a period, and where it jumps."""
    on = 0.01 * period * np.arange(2000)
    position = np.mod(on, period) + noise * np.random.default_rng(seed).standard_normal(on.size)
    return position, np.flatnonzero(np.abs(np.diff(position)) > 0.5 * period)


@pytest.mark.parametrize("power", [8, 12, 16])
def test_a_register_holds_a_power_of_two_of_counts(power):
    count = 1e-3
    found = period_of(*jumping(count * 2.0**power, 0.2 * count), count)
    assert found == count * 2.0**power


def test_a_period_without_a_known_count_is_the_turn_that_is_nearest_or_as_measured():
    assert period_of(*jumping(2.0 * np.pi, 1e-3)) == 2.0 * np.pi
    assert period_of(*jumping(1.7, 1e-4)) == pytest.approx(1.7, rel=1e-3)


@pytest.mark.parametrize(("short", "alike"), [(0.01, True), (0.3, False)])
def test_jumps_of_which_one_is_shorter_have_no_period(short, alike):
    position, places = jumping(1.7, 0.0)
    turn = slice(places[3] + 1, places[4] + 1)
    position[turn] = np.maximum(position[turn], short * 1.7)
    assert (period_of(position, places) is not None) is alike
