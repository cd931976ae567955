import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline, PchipInterpolator

from bench.trace.in_si import Clock, SampledSignal
from bench.trace.time_base import interpolate, regular


def clock(time, tick=1.0):
    """Sample times given in units of `tick` seconds."""
    recorded = np.asarray(time, dtype=float)
    return Clock(recorded * tick, recorded, tick, lambda sample: f"file: sample {sample}")


def one(time, tick=1.0, values=None):
    """A velocity alone on a clock."""
    return {
        "velocity": SampledSignal(clock(time, tick), np.arange(len(time), dtype=float) if values is None else values)
    }


@pytest.mark.parametrize(("period", "tick"), [(1 / 3, 1e-3), (1.5, 1e-3), (16.0 / 3.0, 1e-3), (62.5, 1e-6)])
def test_times_rounded_to_the_files_digits_are_the_line_they_were_rounded_from(period, tick):
    """A period of a third of a ms printed as 0.333, 0.667, 1.000, or of 1.5 ms printed as 0, 2, 3, 4, 6 ms."""
    decimals = 3 if period < 1 else 0
    stamps = np.round(period * np.arange(4000), decimals)
    found = regular(one(stamps, tick))
    assert not found.time_base.resampled and found.time_base.interpolated == 0
    assert found.time_base.sample_period == pytest.approx(period * tick, rel=1e-6)
    np.testing.assert_allclose(np.diff(found.time), period * tick, rtol=1e-6)
    assert np.array_equal(found.signals["velocity"], np.arange(4000))


def test_missing_samples_are_interpolated_and_counted_and_measured_ones_stay():
    every = np.arange(2000)
    kept = np.delete(every, [100, 700, 1500])
    found = regular(one(kept, 1e-3, np.sin(kept / 50.0)))
    assert found.time_base.interpolated == 3 and found.time_base.holes == ()
    assert not found.time_base.resampled
    assert np.array_equal(found.signals["velocity"][kept], np.sin(kept / 50.0))
    np.testing.assert_allclose(found.signals["velocity"], np.sin(every / 50.0), atol=2e-4)


def test_jitter_is_reported_and_resampled_onto_a_regular_base():
    rng = np.random.default_rng(1)
    time = np.sort(np.arange(3000) * 1e-3 + rng.uniform(-0.3e-3, 0.3e-3, 3000))
    found = regular(one(time, values=np.sin(2 * np.pi * 5.0 * time)))
    assert found.time_base.resampled
    assert found.time_base.jitter == pytest.approx(np.abs(np.diff(time) / np.median(np.diff(time)) - 1).max(), abs=0.01)
    np.testing.assert_allclose(np.diff(found.time), found.time_base.sample_period, rtol=1e-9)
    np.testing.assert_allclose(found.signals["velocity"], np.sin(2 * np.pi * 5.0 * found.time), atol=3e-4)
    assert any("jitter" in note for note in found.notes)


def test_duplicates_are_dropped_and_counted():
    time = np.repeat(np.arange(300), 2)[:400] * 1e-3
    found = regular(one(time, values=np.repeat(np.arange(300.0), 2)[:400]))
    assert found.time_base.duplicates == 200
    assert np.array_equal(found.signals["velocity"], np.arange(200.0))
    assert found.notes == ("200 samples dropped because the recording already has a sample at that time",)


def test_few_duplicates_with_other_values_keep_the_first():
    time = np.insert(np.arange(500), 250, 249) * 1e-3
    found = regular(one(time))
    assert found.time_base.duplicates == 1
    assert found.signals["velocity"][248:252].tolist() == [248.0, 249.0, 251.0, 252.0]


def test_a_faster_signal_is_taken_at_the_velocitys_times():
    slow, fast = clock(np.arange(200) * 1e-3), clock(np.arange(800) * 0.25e-3)
    signals = {"current": (fast, np.sin(20.0 * fast.time)), "velocity": (slow, np.cos(20.0 * slow.time))}
    found = regular({name: SampledSignal(*of) for name, of in signals.items()})
    assert found.time is slow.time
    assert list(found.signals) == ["current", "velocity"]
    np.testing.assert_allclose(found.signals["current"], np.sin(20.0 * found.time), atol=1e-6)


@given(
    st.integers(2, 200),
    st.floats(1e-5, 10.0),
    st.floats(-1e3, 1e3),
    st.lists(st.tuples(st.integers(0, 200), st.floats(3.0, 50.0)), max_size=3),
)
def test_regular_segments_pass_whatever_their_holes(count, period, start, holes):
    time = start + period * np.arange(count)
    for after, length in holes:
        time[min(after, count) :] += length * period
    steps, signals = np.diff(time), one(time, values=np.random.default_rng(count).normal(size=count))
    found = regular(signals)
    if np.median(steps) < 1.5 * period:  # with holes in the majority there is no telling them from the rate
        assert found.time_base.sample_period == pytest.approx(period, rel=1e-6)
        starts = time[:-1][steps > 2.5 * period]
        assert [start for start, _ in found.time_base.holes] == pytest.approx(starts.tolist())
        assert not found.time_base.resampled
        if not found.time_base.interpolated:
            assert found.time is signals["velocity"].clock.time
            assert found.signals["velocity"] is signals["velocity"].values
    assert (np.diff(found.time) > 0).all()


def test_why_interpolation_is_by_akima():
    """RMS error on a smooth run, noise kept, and overshoot at a current step, from 1 kHz samples jittering by 30 %."""
    rng = np.random.default_rng(5)
    time = np.sort(np.arange(4000) * 1e-3 + rng.uniform(-0.3e-3, 0.3e-3, 4000))
    at, noise = np.arange(10, 3990) * 1e-3, rng.normal(size=4000)
    methods = {
        "linear": lambda values: np.interp(at, time, values),
        "pchip": lambda values: PchipInterpolator(time, values)(at),
        "akima": lambda values: interpolate(at, time, values),
        "cubic spline": lambda values: CubicSpline(time, values)(at),
    }
    error, kept, overshoot = {}, {}, {}
    for name, method in methods.items():
        error[name] = float(np.sqrt(np.mean((method(_speed(time)) - _speed(at)) ** 2)))
        kept[name] = float(method(noise).std() / noise.std())
        overshoot[name] = float(np.abs(method(np.sign(_speed(time)))).max() - 1.0)
        print(f"{name}: error {error[name]:.1e} rad/s, noise {kept[name]:.3f}, overshoot {overshoot[name]:.1%}")
    assert error["akima"] < error["pchip"] < 0.5 * error["linear"]
    assert overshoot["akima"] < 1e-9 < 0.05 < overshoot["cubic spline"]
    assert abs(kept["akima"] - 1.0) < abs(kept["pchip"] - 1.0) < abs(kept["linear"] - 1.0)


@pytest.mark.parametrize(("unit", "largest"), [(1.0, 1e308), (1e-60, 1e200)])
def test_numbers_near_the_largest_of_a_float_stay_finite(unit, largest):
    time = unit * np.cumsum(1.0 + 0.5 * np.random.default_rng(0).random(50))
    values = np.where(np.arange(50) % 10 == 5, largest, 0.0)
    assert np.isfinite(interpolate(np.linspace(time[0], time[-1], 300), time, values)).all()


def _speed(time):
    return 100.0 * np.sin(2 * np.pi * 3.0 * time) + 5.0 * np.sin(2 * np.pi * 40.0 * time)


@pytest.mark.parametrize(("late", "apart"), [(0.3, True), (0.001, False)])
def test_values_of_as_many_instants_between_the_leading_ones_are_not_theirs(late, apart):
    """A ramp that a second clock takes later, by a share of a period or by no more than the last digit of the times."""
    times, ramp = 1.001 * np.arange(400), np.arange(400.0)
    found = regular({**one(times, 1e-3), "current": SampledSignal(clock(times + late, 1e-3), ramp)})
    expected = ramp - late / 1.001 if apart else ramp
    np.testing.assert_allclose(found.signals["current"][5:-5], expected[5:-5], atol=1e-6)


@pytest.mark.parametrize("jitter", [0.0, 0.1])
def test_nothing_is_placed_between_the_neighbours_of_an_unknown_value(jitter):
    """Regular samples around it stay as they were measured; interpolated ones between these would be made of it."""
    steps = 1e-3 * (1.0 + jitter * np.random.default_rng(0).uniform(-1.0, 1.0, 4000))
    time, unknown = np.cumsum(steps), np.arange(4000) % 100 == 50
    found = regular({"velocity": SampledSignal(clock(time), np.where(unknown, 1e3, 1.0), unknown)})
    assert found.time_base.resampled == (jitter > 0.0)
    for before, after in zip(time[np.flatnonzero(unknown) - 1], time[np.flatnonzero(unknown) + 1], strict=True):
        assert not ((found.time > before + 2.0 * jitter * 1e-3) & (found.time < after - 2.0 * jitter * 1e-3)).any()
    assert found.time.size >= 4000 - (3 if jitter else 1) * np.count_nonzero(unknown)
    assert len(found.time_base.holes) == np.count_nonzero(unknown)
