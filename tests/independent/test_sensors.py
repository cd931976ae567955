"""Sensors: noise has the size, colour and hum it says, and a recording does not depend on its neighbours."""

from dataclasses import replace

import numpy as np
import pytest

from bench.validation.independent.effects import CoggingTorque, CurrentLoopLag
from bench.validation.independent.references import Motion, multisine, slow_reversals
from bench.validation.independent.sensors import Noise, NoiseStream, Sensors, rounded
from bench.validation.independent.simulate import simulate
from tests.independent.axes import PLAIN


def _drawn(noise, period=1e-3, count=100_000):
    stream = NoiseStream(noise, period, np.random.default_rng(2))
    time = period * np.arange(count)
    return time, np.concatenate([stream.at(part) for part in np.array_split(time, 7)])


def test_white_noise_is_white():
    _, noise = _drawn(Noise(white=0.3))
    assert noise.std() == pytest.approx(0.3, rel=0.01)
    assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 0.015


def test_coloured_noise_forgets_in_its_correlation_time():
    _, noise = _drawn(Noise(coloured=0.3, correlation_time=4e-3))
    assert noise.std() == pytest.approx(0.3, rel=0.03)
    for lag in (1, 4, 8):
        assert np.corrcoef(noise[lag:], noise[:-lag])[0, 1] == pytest.approx(np.exp(-lag / 4.0), abs=0.03)


def test_hum_is_a_line_at_its_frequency():
    time, noise = _drawn(Noise(hum=0.2, hum_phase=0.5))
    assert np.abs(noise - 0.2 * np.sin(2 * np.pi * 50.0 * time + 0.5)).max() < 1e-12


def test_rounding():
    assert rounded(np.array([0.26, -0.26, 0.1]), 0.25).tolist() == [0.25, -0.25, 0.0]
    assert rounded(np.array([0.26, -0.26, 0.1]), 0.0).tolist() == [0.26, -0.26, 0.1]


@pytest.fixture(scope="module")
def trio():
    rng = np.random.default_rng(7)
    axes = [replace(PLAIN, top_speed=100.0, name=f"axis {k}") for k in range(3)]
    motions = [
        Motion((slow_reversals([2.0 + k], 0.05, 0.01), multisine(20.0, 600.0, 0.12 + 0.02 * k, rng))) for k in range(3)
    ]
    noisy = Noise(white=0.02, coloured=0.02, hum=0.02, resolution=0.01)
    sensors = [
        Sensors(sample_period=1e-3, velocity=noisy, current=noisy, velocity_noise_fed_back=True),
        Sensors(sample_period=0.5e-3, encoder_resolution=2 * np.pi / 4096, current_age=1),
        Sensors(sample_period=2e-3, velocity=noisy, position_recorded=False),
    ]
    effects = [[], [CoggingTorque(0.05, 6.0)], [CurrentLoopLag(2e-3)]]
    return axes, motions, effects, sensors


def test_a_recording_does_not_depend_on_others_recorded_with_it(trio):
    together = simulate(*trio, seed=5)
    first = simulate(*([part[0]] for part in trio), seed=5)[0]
    for name, values in first.trace.signals.items():
        assert (together[0].trace[name] == values).all(), name


def test_recordings_hold_what_the_sensors_say(trio):
    noisy, coarse, sparse = simulate(*trio, seed=5)
    assert [r.trace.sample_period for r in (noisy, coarse, sparse)] == pytest.approx([1e-3, 0.5e-3, 2e-3])
    assert set(sparse.trace.signals) == {"velocity", "current", "velocity_reference"}
    assert set(noisy.trace.signals) == {*sparse.trace.signals, "position", "position_reference"}
    counts = coarse.trace["position"] / (2 * np.pi / 4096)
    assert np.abs(counts - np.round(counts)).max() < 1e-6
    assert (coarse.trace["velocity"] == coarse.true["velocity"]).all()
    steps = noisy.trace["velocity"] / 0.01
    assert np.abs(steps - np.round(steps)).max() < 1e-6
    assert np.std(noisy.trace["velocity"] - noisy.true["measured_velocity"]) == pytest.approx(0.0316, rel=0.15)
    for recorded in (noisy, coarse):
        assert np.abs(recorded.true["velocity"] - recorded.trace["velocity_reference"]).max() < 5.0


def test_age_shifts_the_reported_current_by_one_control_period(trio):
    axes, motions, _, _ = (part[:1] for part in trio)
    now, before = (
        simulate(axes, motions, [[]], [Sensors(sample_period=250e-6, current_age=age)])[0].trace["current"]
        for age in (0, 1)
    )
    assert (now[:-1] == before[1:]).all()


def test_sampling_between_control_ticks_is_refused():
    with pytest.raises(ValueError, match="no multiple"):
        simulate([PLAIN], [Motion((slow_reversals([2.0], 0.05, 0.01),))], [[]], [Sensors(sample_period=0.3e-3)])
