"""Lags: those of a recorder, which the axis does not feel; how one is detected; how one of the torque is stepped."""

import numpy as np
import pytest
from scipy.signal import lfilter

from bench.diagnosis.policy import POLICY
from bench.diagnosis.search import search
from bench.effects.catalogue import catalogue
from bench.effects.velocity_filter_lag import EFFECT
from bench.plant.run import run
from bench.plant.sensing import reported_states
from bench.rig.rig import load_rig
from bench.trace.trace import Trace
from tests.diagnosis.constructed import RIG, bare, moved, recorded, wave
from tests.effects.axes import Reversals, model, plant

#: The rig with a drive of 250 us.
TICKING = RIG.model_copy(update={"drive": load_rig("sh30701p").drive})


def test_the_axis_does_not_feel_the_filter_of_its_recorder():
    references = Reversals(0.2).references()
    states = run(plant("current_filter_lag"), references)
    np.testing.assert_array_equal(states.velocity, run(plant(), references).velocity)
    assert np.abs(reported_states(model("current_filter_lag"), states).torque - states.torque).max() > 0.01


def first_order_of(lag):
    """Of a time constant - s."""
    return lambda omega: 1.0 / (1.0 + 1j * omega * lag)


def two_sines(response):
    """Speed of two sines behind a filter of a complex gain by angular frequency, at 1 kHz, with noise of its own."""
    time = 1e-3 * np.arange(8000)
    position, reported = np.zeros_like(time), np.zeros_like(time)
    for speed, omega in ((30.0, 9.0), (12.0, 250.0)):
        position += speed / omega * np.sin(omega * time)
        reported += speed * np.real(response(omega) * np.exp(1j * omega * time))
    rng = np.random.default_rng(0)
    signals = {
        "position": position + 1e-5 * rng.normal(size=time.size),
        "velocity": reported + 0.02 * rng.normal(size=time.size),
    }
    return Trace(time, signals, {"position": "rad", "velocity": "rad/s"}, "two sines")


@pytest.mark.parametrize("first_order", [True, False])
def test_a_lag_of_another_form_is_reported_and_not_mended(first_order):
    """Speed of two sines behind a first-order filter, and behind a mean over 8 ms, which is no such filter at 40 Hz.

    Sine by sine: a filter H(i*w) multiplies amplitude and shifts phase. At 250 rad/s the mean over T, sinc(w*T/2) with
    a delay of T/2, differs from 1/(1 + i*w*T/2) by a tenth.
    """

    def behind_a_mean(omega):
        half = 0.5 * omega * 8e-3
        return np.sin(half) / half * np.exp(-1j * half)

    trace = two_sines(first_order_of(4e-3) if first_order else behind_a_mean)
    found = EFFECT.detect(trace, RIG, 1.5e-3)
    assert found is not None
    assert found.mends == first_order
    assert set(trace.without("velocity").signals) == {"position"}


def test_a_lag_shorter_than_a_sample_is_a_filter_where_the_drive_ticks_faster():
    """Half a sample late is also a difference of recorded positions, whose noise is then in the speed."""
    trace = two_sines(first_order_of(0.5e-3))
    found = EFFECT.detect(trace, TICKING, 1.5e-3)
    assert found is not None
    assert found.values["time_constant"] == pytest.approx(0.5e-3, rel=0.02)
    assert EFFECT.detect(trace, RIG, 1.5e-3) is None  # nothing is known of what differenced it
    assert EFFECT.detect(two_sines(first_order_of(0.14e-3)), TICKING, 1.5e-3) is None  # of a tick
    position = trace["position"]
    differences = np.diff(position, prepend=2.0 * position[0] - position[1]) / trace.sample_period
    assert EFFECT.detect(trace.with_signals({"velocity": differences}, {}), TICKING, 1.5e-3) is None


def test_a_wave_of_position_beside_it_is_where_the_axis_is():
    """Of speed alone position is summed, and behind as well: by half a turn of the wave at the top speed."""
    trace, decay = recorded(moved(), wave(0.06, 12.0)), float(np.exp(-1e-3 / 4e-3))
    late = lfilter([1.0 - decay], [1.0, -decay], trace["velocity"], zi=[decay * trace["velocity"][0]])[0]
    reported = trace.with_signals({"velocity": late}, {}).without("position")
    sought = [catalogue()[name] for name in ("velocity_filter_lag", "current_loop_lag", "cogging_torque")]
    found = search(bare(reported), sought, POLICY).last
    assert sorted(found.hypothesis.names) == ["cogging_torque", "velocity_filter_lag"]
    assert found.chi < 1.1


def test_a_mean_over_the_sample_is_how_a_recorder_averages():
    """Of four ticks of 250 us the middle is 375 us late; a filter of 390 us is none of that."""

    def mean(omega):
        return sum(np.exp(-1j * omega * 250e-6 * tick) for tick in range(4)) / 4.0

    assert EFFECT.detect(two_sines(mean), TICKING, 1.5e-3) is None
    assert EFFECT.detect(two_sines(first_order_of(0.39e-3)), TICKING, 1.5e-3) is not None
