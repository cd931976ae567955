"""Where a residual sits: its share by coordinate, what chance makes of one, its spectrum; and a load behind a gap."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.signal
from scipy.interpolate import CubicSpline

from bench.axis_kind import INERTIA, ROTARY
from bench.diagnosis.recordings import fit_bare
from bench.diagnosis.where import BINS, LEAST, _account, _welch, bins_of, by_chance, coordinates, where
from bench.effects.dead_zone import load_positions
from bench.effects.signals import Signals
from bench.fit.rows import Rows
from bench.rig.given import recordings_of
from bench.trace.filter import GaussianFilter

PERIOD = 1e-3


def signals(position, velocity):
    count = position.size
    sign = np.sign(velocity)
    zero = np.zeros(count)
    return Signals(np.arange(count) * PERIOD, position, velocity, sign, zero, zero, sign, 1.0, PERIOD)


@pytest.mark.parametrize("spring", [0.0, 900.0])
def test_a_load_thrown_across_the_gap_is_the_contacts_equation_integrated(spring):
    """With a spring of its own, too, and without."""
    time, gap, frequency, damping = np.arange(3000) * PERIOD, 0.05, 300.0, 0.4
    position = 0.8 * np.sin(6.0 * time) ** 3
    twenty = 20
    fine, halves = CubicSpline(time, position), np.arange(3000 * 2 * twenty) * PERIOD / (2 * twenty)
    motor, rate = fine(halves).tolist(), fine(halves, 1).tolist()
    x, v, expected, step = position[0], 0.0, np.empty(3000), PERIOD / twenty

    def force(k, x, v):
        penetration = motor[k] - x - max(-0.5 * gap, min(motor[k] - x, 0.5 * gap))
        closing = (rate[k] - v) * (penetration != 0.0)
        return frequency**2 * penetration + 2.0 * damping * frequency * closing - spring * x

    for k in range(3000 * twenty):
        if k % twenty == 0:
            expected[k // twenty] = x
        middle = v + 0.5 * step * force(2 * k, x, v)
        x, v = x + step * middle, v + step * force(2 * k + 1, x + 0.5 * step * v, middle)
    found = load_positions([position], PERIOD, np.array([[gap, frequency, damping, spring]]))[0][:, 0]
    assert found == pytest.approx(expected, abs=0.01 * gap)


def test_a_gap_of_two_directions_belongs_to_direction():
    rng = np.random.default_rng(0)
    sign = np.sign(rng.normal(size=4000))
    gap = 3.0 + 0.5 * sign + 0.1 * rng.normal(size=4000)
    rows = SimpleNamespace(
        time=np.arange(4000) * PERIOD, conditioning=SimpleNamespace(filter=GaussianFilter(1e-6, PERIOD))
    )
    fitted = SimpleNamespace(residual=gap, left=gap, rows=rows)
    account = _account(("direction", sign, "dimensionless", sign), fitted, [])
    assert account.centres == pytest.approx([-1.0, 1.0])
    assert account.share == pytest.approx(0.25 / 0.26, abs=0.01)


@pytest.mark.parametrize("of", [lambda time: time, lambda time: np.sin(7.0 * time)])
def test_smoothed_white_noise_has_as_much_between_bins_as_its_autocovariance_says(of):
    """Smoothed by a Gaussian of width w, white noise correlates as exp(-(tau/(2*w))**2)."""
    time, width = np.arange(2000) * PERIOD, 5.0 * PERIOD
    covariance = np.exp(-(((time[:, None] - time) / (2.0 * width)) ** 2))
    index = bins_of(of(time))
    member = (index[:, None] == np.arange(index.max() + 1)).astype(float)
    means = member / member.sum(axis=0) - 1.0 / time.size
    between = float(np.sum(member.sum(axis=0) * np.einsum("ib,ij,jb->b", means, covariance, means)))
    total = time.size - covariance.sum() / time.size
    rows = SimpleNamespace(time=time, conditioning=SimpleNamespace(filter=SimpleNamespace(width=width)))
    found = by_chance(index, np.ones(index.max() + 1, dtype=bool), rows)
    assert found == pytest.approx(between / total, rel=1e-3)
    assert found > 5.0 * index.max() / time.size  # of independent rows


@pytest.mark.parametrize("seed", range(3))
def test_noise_belongs_to_no_coordinate(seed):
    """White noise on the torque, smoothed over seven rows, has no share beyond chance; its strongest band has some."""
    rng, time = np.random.default_rng(seed), np.arange(12000) * PERIOD
    turned = sum(a / w * np.sin(w * time + p) for a, w, p in ((20.0, 3.1, 0.0), (8.0, 8.2, 1.0), (4.0, 13.2, 2.0)))
    velocity = np.gradient(turned, PERIOD)
    torque = 2e-3 * np.gradient(velocity, PERIOD) + 0.01 * velocity + 0.1 * np.sign(velocity)
    torque = torque + 0.05 * rng.normal(size=time.size)
    rig, (trace,) = recordings_of({"time": time, "position": turned, "velocity": velocity, "torque": torque}, None)
    shares = {one.coordinate: one.share for one in where(fit_bare(Rows.of(trace, rig, near=True)), ROTARY, "N*m")}
    assert max(share for coordinate, share in shares.items() if coordinate != "frequency") < 0.02


def test_a_sine_has_turned_as_long_ago_as_its_last_crest():
    time = np.arange(4000) * PERIOD
    position, velocity = 3.0 - np.cos(4.0 * time), 4.0 * np.sin(4.0 * time + 1e-3)
    rows = SimpleNamespace(time=time, values=lambda of: of(signals(position, velocity)))
    fitted = SimpleNamespace(
        rows=rows, columns=np.ones((4000, 1)), owners=np.array([INERTIA]), effort=time, left=0.0 * time
    )
    since = {name: values for name, values, *_ in coordinates(fitted, ROTARY, "N*m")}["reversal"]
    assert since == pytest.approx(np.mod(time + 0.25e-3, np.pi / 4.0), abs=1.1 * PERIOD)


@pytest.mark.parametrize(("size", "length"), [(5000, 1024), (700, 700), (701, 701)])
def test_the_gap_s_spectrum_is_welch_s(size, length):
    values = np.random.default_rng(3).normal(size=size) + 2.0
    expected_by_scipy = scipy.signal.welch(values, 40.0, nperseg=length)
    for found, expected in zip(_welch(values, 40.0, length), expected_by_scipy, strict=True):
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("rows", [LEAST, 100, 570, 5000])
def test_every_bin_of_a_short_recording_contains_enough_rows(rows):
    index = bins_of(np.random.default_rng(1).normal(size=rows))
    assert np.bincount(index).min() >= LEAST - 1
    assert 1 <= np.unique(index).size <= BINS
