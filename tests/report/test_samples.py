"""Curves on a page: nothing that stands out is lost, nothing is made up, and many samples take little room."""

import base64
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.report.document import Chart, Document, Panel, Section
from bench.report.html import COARSEST, FOLDED, PAGE, html
from bench.report.over_time import STEPS, Grid, Plotted, coarser, numbers_over, time_graph, unpacked


def page_of(*graphs):
    section = Section(key="motion", heading="motion", blocks=graphs)
    return Document(title="t", subject="s", verdict="v", tone="sure", answers={}, sections=(section,))


def recording(samples, models=2):
    """Speed and torque of a motion at 1 kHz with what each of several models leaves of them."""
    time, rng = 1e-3 * np.arange(samples), np.random.default_rng(0)
    speed = 100.0 * np.sin(2.0 * np.pi * time)
    left = [rng.normal(size=samples).astype(np.float32) for _ in range(models)]
    signals = [Plotted("speed", "rad/s", time, speed, left), Plotted("torque", "N*m", time, 0.02 * speed, left)]
    return time, signals


@given(
    values=st.lists(st.floats(-1e6, 1e6) | st.just(float("nan")), min_size=2, max_size=400),
    curves=st.integers(500, 40_000),
)
def test_each_interval_holds_its_lowest_and_highest_value(values, curves):
    values = np.array(values)
    time = 5.0 + 1e-3 * np.arange(values.size)
    grid = Grid.of(time, curves)
    places = grid.places(time)
    packed = grid.samples(places, values)
    low, high = unpacked(packed)
    assert low.size == high.size == grid.count
    for place in range(grid.count):
        own = values[places == place]
        own = own[np.isfinite(own)]
        assert np.isfinite(low[place]) == bool(own.size)
        if own.size:
            assert low[place] == pytest.approx(own.min(), abs=0.51 * packed.scale)
            assert high[place] == pytest.approx(own.max(), abs=0.51 * packed.scale)


def test_a_short_recording_keeps_every_sample():
    time = 1e-3 * np.arange(10_000)
    grid = Grid.of(time, 14)
    assert (grid.single, grid.count, grid.step) == (True, 10_000, pytest.approx(1e-3))
    values = np.random.default_rng(0).normal(size=time.size)
    low, high = unpacked(grid.samples(grid.places(time), values))
    np.testing.assert_array_equal(low, high)
    np.testing.assert_allclose(low, values, atol=np.ptp(values) / STEPS)


def test_a_spike_of_one_sample_in_ten_million_is_seen():
    samples = 2_000_000
    time, values = 1e-3 * np.arange(samples), np.zeros(samples)
    values[1_234_567] = 7.0
    grid = Grid.of(time, 14)
    low, high = unpacked(grid.samples(grid.places(time), values))
    (place,) = np.flatnonzero(high > 6.9)
    assert grid.start + grid.step * place == pytest.approx(1234.567, abs=0.51 * grid.step)
    assert low.max() == 0.0


def test_a_hole_stays_one():
    time = np.concatenate([np.arange(100), np.arange(200, 300)]) * 1e-3
    grid = Grid.of(time, 4)
    low, _ = unpacked(grid.samples(grid.places(time), np.ones(time.size)))
    assert np.isnan(low[100:200]).all()
    assert np.isfinite(low[:100]).all()
    assert np.isfinite(low[200:]).all()


@pytest.mark.parametrize("samples", [10_000, 1_000_000, pytest.param(10_000_000, marks=pytest.mark.slow)])
def test_a_page_stays_small_and_uses_its_room(samples):
    time, signals = recording(samples)
    holdout = time_graph("h", "a", time[:10_000], signals_of(signals, 10_000), "abc")
    size = len(html(page_of(time_graph("r", "a", time, signals, "abc"), holdout)).encode())
    assert 0.6 * PAGE < size < PAGE


def test_longer_intervals_hold_the_lowest_and_highest_of_those_in_them():
    """Of samples and of intervals, holes and a last one that is not full; chosen bins are those of the middle."""
    time, rng = 1e-3 * np.arange(1003), np.random.default_rng(0)
    values = np.where((time > 0.3) & (time < 0.4), np.nan, rng.normal(size=time.size))
    graph = time_graph("r", "a", time, [Plotted("speed", "rad/s", time, values)])
    bins = numbers_over(graph, time, np.arange(time.size) // 10)
    panel = Panel(x_label="x", series=(), bins=bins)
    for times in (4, 12):
        found = coarser(page_of(graph, Chart(title="t", alternative="a", panels=(panel,))), times)
        over, chart = found.blocks
        assert over.step == pytest.approx(times * graph.step)
        assert over.start == pytest.approx(time[:times].mean())
        (low, high), scale = unpacked(over.panels[0].curves[0].samples), over.panels[0].curves[0].samples.scale
        every = [values[k : k + times] for k in range(0, time.size, times)]
        assert low.size == high.size == over.count == len(every)
        for k, own in enumerate(part[np.isfinite(part)] for part in every):
            assert np.isfinite(low[k]) == bool(own.size)
            if own.size:
                assert own.min() - 1.1 * scale < low[k] < own.min() + 0.1 * scale
                assert own.max() - 0.1 * scale < high[k] < own.max() + 1.1 * scale
        chosen = np.frombuffer(base64.b64decode(chart.panels[0].bins), "<i2")
        middles = np.arange(times // 2, time.size, times)
        np.testing.assert_array_equal(chosen[: middles.size], middles // 10)


def signals_of(signals, count):
    """The first samples of signals."""
    return [
        Plotted(one.label, one.unit, one.time[:count], one.values[:count], [left[:count] for left in one.left])
        for one in signals
    ]


def test_many_models_of_a_short_recording_stay_small_too():
    time, signals = recording(10_000, models=7)
    size = len(html(page_of(time_graph("r", "a", time, signals, "abcdefg"))).encode())
    assert size < PAGE


def test_graphs_of_many_recordings_have_an_interval_for_each_three_pixels_unless_the_page_is_too_large_then():
    time, signals = recording(3000)
    graph = time_graph("r", "a", time, signals, "ab")
    for copies, least in ((12, COARSEST), (40, FOLDED)):
        page = html(page_of(*[graph] * copies))
        (count,) = {int(count) for count in re.findall(r'"count":(\d+)', page)}
        assert least <= count < 3000 and len(page.encode()) < PAGE


def test_what_is_left_is_measured_less_modelled():
    time, signals = recording(3000, models=1)
    graph = time_graph("r", "a", time, signals[:1], "a")
    measured, modelled = (unpacked(curve.samples)[0] for curve in graph.panels[0].curves)
    left = unpacked(graph.panels[1].curves[0].samples)[0]
    np.testing.assert_allclose(measured - modelled, left, atol=220.0 / STEPS)


def test_numbers_on_a_page_are_little_endian():
    packed = Grid(0.0, 1.0, 3, True).samples(np.arange(3), np.array([0.0, 0.5, 1.0]))
    raw = base64.b64decode(packed.low)
    assert [int.from_bytes(raw[k : k + 2], "little", signed=True) for k in (0, 2, 4)] == [-32767, 0, 32767]
