import math

import numpy as np
import pytest
import scipy.signal

from bench.errors import UndeterminedError
from bench.trace.motion import _coherence, condition, known_column, measured_velocity, moving
from bench.trace.trace import Trace, less_known, with_known


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(("samples", "window"), [(72, 16), (999, 64), (20_000, 1024)])
def test_coherence_is_scipys(samples, window, order):
    rng = np.random.default_rng(samples)
    source = np.cumsum(rng.normal(size=samples))
    effort = np.gradient(source) + rng.normal(size=samples)
    frequency, coherence = _coherence([(source, effort)], 1e-3, order)
    expected = scipy.signal.coherence(np.diff(source, order), effort[order:], fs=1e3, nperseg=window)
    np.testing.assert_allclose(frequency, expected[0][1:-1], rtol=1e-12)
    np.testing.assert_allclose(coherence, expected[1][1:-1], atol=1e-12)


def test_a_signal_that_never_changes_shares_nothing():
    _, coherence = _coherence([(np.zeros(500), np.random.default_rng(0).normal(size=500))], 1e-3, 1)
    assert not coherence.any()


PERIOD = 1e-3
TIME = PERIOD * np.arange(60_000)


def recorded(seed=0, **noise):
    """Position - rad - and velocity - rad/s - of a servo's motion with white noise, and a torque that follows it."""
    rng = np.random.default_rng(seed)
    position, velocity, torque = 0.0, 0.0, 0.0
    for amplitude, omega in ((30.0, 9.0), (10.0, 31.0), (4.0, 70.0)):
        position = position - amplitude / omega * np.cos(omega * TIME)
        velocity = velocity + amplitude * np.sin(omega * TIME)
        torque = torque + 2e-3 * amplitude * omega * np.cos(omega * TIME)
    clean = {"position": position, "velocity": velocity}
    signals = {name: clean[name] + scale * rng.normal(size=TIME.size) for name, scale in noise.items()}
    units = {"position": "rad", "velocity": "rad/s"}
    trace = Trace(TIME, signals, {name: units[name] for name in signals}, "closed form")
    return trace, torque + 5e-3 * rng.normal(size=TIME.size)


@pytest.mark.parametrize(("position_noise", "source"), [(0.85e-4, "position"), (1.15e-4, "velocity")])
def test_the_source_is_the_one_whose_noise_makes_less_of_the_acceleration(position_noise, source):
    """The second derivative's gain over the first's is sqrt(3/2)/width, of the least width 1.5 ms: 816/s."""
    trace, effort = recorded(velocity=0.0816, position=position_noise)
    found = condition(trace, effort, 30.0)
    assert found.source == source
    assert found.source_noise == pytest.approx({"position": position_noise, "velocity": 0.0816}[source], rel=0.03)
    assert found.effort_noise == pytest.approx(5e-3, rel=0.03)


@pytest.mark.parametrize(("signal", "noise", "order"), [("velocity", 0.05, 0), ("position", 1e-4, 1)])
def test_thresholds_are_those_of_the_noise_of_the_speed(signal, noise, order):
    """(x[k + 1] - x[k - 1])/(2*T) has sqrt(2)/(2*T) times the noise of x.

    Parseval: (j*omega)**k*G leaves a variance of T*Gamma(k + 1/2)/(2*pi*width**(2*k + 1)).
    """
    found = condition(*recorded(**{signal: noise}), 30.0)
    assert found.order == order
    assert found.source_noise == pytest.approx(noise, rel=0.03)
    assert found.speed_noise == pytest.approx(found.source_noise / (np.sqrt(2.0) * PERIOD) ** order)
    assert found.sign_threshold == 4.0 * found.speed_noise
    width = found.filter.width
    assert width == pytest.approx(np.sqrt(np.log(2.0)) / (2.0 * np.pi * 30.0))
    for k in (0, 1, 2):
        power = PERIOD * math.gamma(k + 0.5) / (2.0 * np.pi * width ** (2 * k + 1))
        assert found.filter.noise_gain(k) == pytest.approx(np.sqrt(power))


def test_the_cutoff_is_where_effort_and_acceleration_share_half_of_their_power():
    """Acceleration's power over the effort's noise is 4*exp(-(f/40 Hz)**2): one at 40*sqrt(ln(4)) = 47.1 Hz."""
    rng, samples = np.random.default_rng(7), 120_000
    frequency = np.fft.rfftfreq(samples, PERIOD)
    white = np.fft.rfft(rng.normal(size=samples))
    shaped = white * 2.0 * np.exp(-0.5 * (frequency / 40.0) ** 2)
    omega = np.maximum(2.0 * np.pi * frequency, 2.0 * np.pi * 0.5)
    velocity = np.fft.irfft(shaped / (1j * omega), samples)
    trace = Trace(PERIOD * np.arange(samples), {"velocity": velocity}, {"velocity": "rad/s"}, "shaped")
    effort = np.fft.irfft(shaped, samples) + rng.normal(size=samples)
    found = condition(trace, effort)
    assert found.filter.cutoff == pytest.approx(40.0 * np.sqrt(np.log(4.0)), rel=0.08)
    assert found.coherence == pytest.approx(0.8, abs=0.08)


def test_the_cutoff_is_raised_until_nine_tenths_of_the_rows_are_kept():
    """Signs of 0.1 s each; the narrowest filter of 1.5 ms loses 2*3.1*1.5 = 9.3 ms of each, and keeps 90.7.

    Nine tenths of that are left by a width of (100 - 81.63)/6.2 = 2.96 ms, on the search's steps of 10 % one of 2.90.
    """
    speed = np.where(np.arange(60_000) // 100 % 2, 20.0, -20.0)
    noise = np.random.default_rng(8).normal(size=60_000)
    trace = Trace(TIME, {"velocity": speed + 0.05 * noise}, {"velocity": "rad/s"}, "square")
    found = condition(trace, np.zeros(60_000))  # coherent nowhere
    widest = 1.5e-3 * 1.1 ** np.floor(np.log(2.963 / 1.5) / np.log(1.1))
    assert found.filter.width == pytest.approx(widest, rel=1e-9)


def test_only_stretches_of_a_tenth_of_the_fastest_ones_speed_count_as_moving():
    time = np.concatenate([np.arange(5000) * 1e-3, 10.0 + np.arange(5000) * 1e-3, 20.0 + np.arange(5000) * 1e-3])
    wave = np.sin(30.0 * np.arange(5000) * 1e-3)
    speeds = {"velocity": np.concatenate([10.0 * wave, 1.05 * wave, 0.95 * wave])}
    trace = Trace(time, speeds, {"velocity": "rad/s"}, "three")
    assert moving(trace, "velocity", 100) == [slice(0, 5000), slice(5000, 10_000)]


def test_a_recording_of_fewer_than_eight_margins_carries_no_answer():
    """The least width of 1.5 periods reaches 9 samples to each side."""
    velocity = np.sin(np.arange(72.0))
    for samples in (71, 72):
        trace = Trace(PERIOD * np.arange(samples), {"velocity": velocity[:samples]}, {"velocity": "rad/s"}, "short")
        if samples < 72:
            with pytest.raises(UndeterminedError, match="the longest stretch without a hole has 71 samples"):
                condition(trace, velocity[:samples], 30.0)
        else:
            condition(trace, velocity, 30.0)


def test_known_torque_is_taken_off_with_its_momentums_rate():
    """3 N*m and a momentum of 2*t N*m*s leave 10 - 3 - 2 = 5 N*m, on both sides of a hole."""
    time = np.concatenate([np.arange(50.0), 100.0 + np.arange(50.0)])
    trace = Trace(time, {"velocity": time}, {"velocity": "rad/s"}, "known")
    jump = np.where(time < 60.0, 0.0, 1000.0)  # across the hole, which is nobody's rate
    known = with_known(trace, np.full(100, 3.0), 2.0 * time + jump, "N*m")
    assert less_known(known, np.full(100, 10.0)) == pytest.approx(5.0)
    assert less_known(trace, np.full(100, 10.0)) == pytest.approx(10.0)
    (torque, first), (momentum, second) = known_column(known, slice(0, 50))
    assert (first, second) == (0, 1) and torque[0] == 3.0 and momentum[1] == 2.0


def test_coherence_is_that_of_what_is_not_known():
    trace, effort = recorded(velocity=0.05)
    torque = np.random.default_rng(9).normal(scale=20.0, size=TIME.size)
    known = with_known(trace, torque, np.zeros(TIME.size), "N*m")
    assert condition(known, effort + torque).coherence == pytest.approx(condition(trace, effort).coherence, abs=1e-6)
    assert condition(trace, effort + torque).coherence < 0.5


def test_a_lone_sample_between_holes_goes_as_fast_as_its_neighbours_say():
    """x = t**2: a mean speed between two times is their sum."""
    time = 1e-3 * np.array([0.0, 1.0, 2.0, 3.0, 20.0, 40.0, 41.0, 42.0, 43.0])
    speed = measured_velocity(Trace(time, {"position": time**2}, {"position": "rad"}, "a parabola"))
    assert speed[4] == pytest.approx(0.043)
    np.testing.assert_allclose(speed[[1, 2, 6, 7]], 2.0 * time[[1, 2, 6, 7]], rtol=1e-9)
