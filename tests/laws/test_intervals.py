"""Width of intervals and of noise floors, against closed forms of white noise: neither too narrow nor too wide."""

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from bench.diagnosis.diagnosis import shaken
from bench.diagnosis.recordings import Recordings
from bench.fit.fit import fit
from bench.fit.frequency_response import response_of
from bench.fit.hypothesis import Hypothesis
from bench.fit.identify import identify
from bench.plant.tracking import holding_cascade
from tests.fit.motions import NAMES, RIG, Truth, recording

NOISE, PERIOD = 0.02, 1e-3


@pytest.mark.parametrize("duration", [4.0, 20.0])
def test_errors_under_white_noise_are_those_of_least_squares(duration):
    """s**2*(X'X)**-1 of the motion without noise: no narrower, and half again as wide by samples lost at turns."""
    truth, shares = Truth(), []
    for seed in range(6):
        noisy, quiet = (
            recording(np.random.default_rng(seed), truth, duration, torque_noise=noise, velocity_noise=noise / 20.0)
            for noise in (NOISE, 0.0)
        )
        omega = quiet["velocity"]
        alpha = np.gradient(omega, quiet.time)
        late = truth.inertia * np.gradient(alpha, quiet.time)
        columns = np.column_stack([alpha, omega, np.sign(omega), late])
        expected = NOISE * np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))[: len(NAMES)]
        found = identify(noisy, RIG, 60.0)
        shares.append([found[name].std_error for name in NAMES] / expected)
    print(f"\nstandard errors over those of least squares, {duration:g} s: {np.mean(shares, axis=0)}")
    assert np.min(shares) > 1.0
    assert np.max(shares) < 1.5


def two_masses(rng, antiresonance, damping=0.02, motor=1e-3, load=2e-3, samples=20_000):
    """Torque and speed of a motor with a load behind a spring, by its transfer function, with noise of the speed."""
    torque = 0.4 * rng.normal(size=samples)
    s, omega = 2j * np.pi * np.fft.rfftfreq(samples, PERIOD)[1:], 2.0 * np.pi * antiresonance
    spring = load * (omega**2 + 2.0 * damping * omega * s)
    behind = load * s**2 + spring
    admittance = np.append(0.0, behind / (motor * load * s**3 + (motor + load) * spring * s + 2e-3 * behind))
    speed = np.fft.irfft(np.fft.rfft(torque) * admittance, samples)
    return torque, speed + 0.5 * rng.normal(size=samples)


def test_resonances_scatter_as_their_intervals_say():
    """Over recordings of the same two masses; half the distance of two lines is in the interval, not in the scatter."""
    truth, values, errors = 41.3, [], []
    for seed in range(24):
        found = response_of([two_masses(np.random.default_rng(seed), truth)], PERIOD)
        assert found is not None
        both = found.antiresonance, found.resonance
        line = np.diff(found.frequency).min()
        values.append([one.value for one in both])
        errors.append([np.sqrt((one.ci95[1] - one.ci95[0]) ** 2 - line**2) / 2.0 / 1.96 for one in both])
    scatter = np.std(values, axis=0) / np.median(errors, axis=0)
    print(f"\nscatter of antiresonance and resonance over their standard error: {scatter}")
    assert scatter == pytest.approx(np.ones(2), abs=0.4)
    assert np.mean(values, axis=0) == pytest.approx(truth * np.sqrt([1.0, 3.0]), rel=2e-3)


@pytest.mark.parametrize("bandwidth", [5.0, 40.0])
def test_noise_of_torque_shakes_a_tracked_model_as_its_loop_lets_it(bandwidth):
    """Stationary variance of the loop's speed under white noise of a power s**2*T: A*P + P*A' + b*b' = 0."""
    trace = recording(np.random.default_rng(0), duration=3.0, torque_noise=NOISE)
    fitted = fit(Recordings.of([trace], RIG, None).rows, Hypothesis(()))
    inertia = fitted.base.inertia
    loop = holding_cascade(inertia, PERIOD, bandwidth)
    outer, middle, integral = loop.position_gain, loop.velocity_gain / inertia, loop.integral_gain / inertia
    matrix = np.array([[0.0, 1.0, 0.0], [-outer * middle, -middle, -integral], [outer, 1.0, 0.0]])
    enters = np.array([[0.0], [1.0 / inertia], [0.0]])
    variance = solve_continuous_lyapunov(matrix, -enters @ enters.T * NOISE**2 * PERIOD)[1, 1]
    assert shaken(fitted, bandwidth) == pytest.approx(np.sqrt(variance), rel=0.15)
