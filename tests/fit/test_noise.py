"""What the sensors' noise becomes in the torque balance, against closed forms."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import BASE, Hypothesis, Term, lay_out
from bench.fit.rows import Rows
from bench.fit.solution import Floor
from tests.fit.motions import RIG, recording

OMEGA = np.array([0.0, 100.0, 400.0])
NONE = np.zeros(3)


def theta_of(layout, **values):
    """Coefficients (p,) of a layout: J, K_w, K_0, misalignment, and the one strength of a term."""
    theta = np.zeros(layout.owners.size)
    for name in BASE:
        theta[layout.owners == name] = values.get(name, 0.0)
    theta[layout.owners == 0] = values.get("strength", 0.0)
    return theta


def power(rows, hypothesis, source, **values):
    layout = lay_out(rows, hypothesis)
    theta = theta_of(layout, **values)
    return Floor(rows, hypothesis, layout, theta, np.zeros_like(layout.effort)).power(OMEGA, source)


def test_noise_of_the_effort_passes_its_misalignment_and_that_of_the_speed_inertia_and_friction():
    rows = Rows.of(recording(np.random.default_rng(0)), RIG)
    effort = rows.conditioning.effort_noise**2
    late = 1.0 + (1e-3 * OMEGA) ** 2
    np.testing.assert_allclose(power(rows, Hypothesis(), NONE, misalignment=1e-3), effort * late)
    moved = power(rows, Hypothesis(), np.full(3, 4.0), inertia=2e-3, viscous=0.3) - effort
    np.testing.assert_allclose(moved, 4.0 * ((2e-3 * OMEGA) ** 2 + 0.3**2))


def test_the_floor_of_a_plain_axis_is_the_filtered_noise_of_both_sensors():
    """s_M**2*G_0**2 + (J*s_w*G_1)**2 + (K_w*s_w*G_0)**2, G_k the filter's gains for white noise."""
    fitted = fit(Rows.of(recording(np.random.default_rng(2), torque_noise=0.02, velocity_noise=0.3), RIG), Hypothesis())
    conditioning, base = fitted.rows.conditioning, fitted.base
    gains = [conditioning.filter.noise_gain(order) for order in (0, 1)]
    parts = (
        conditioning.effort_noise * gains[0],
        base.inertia * conditioning.source_noise * gains[1],
        base.viscous * conditioning.source_noise * gains[0],
    )
    assert fitted.noise.white == pytest.approx(np.sqrt(np.sum(np.square(parts))), rel=2e-3)
    assert parts[1] > 0.3 * parts[0]


@pytest.mark.parametrize("period", [1e-3, 1.0 / 16000.0], ids=["1 kHz", "16 kHz"])
@pytest.mark.parametrize("shape", [(150.0, 0.01), (150.0, 0.3), (600.0, 0.002)], ids=str)
def test_noise_that_passes_a_coupling_is_that_of_a_dense_sum_over_its_resonance(period, shape):
    """At D = 0.01 its peak is 3 rad/s wide, in a band of 3,000 or 50,000 rad/s; the sum takes a tenth of a width."""
    rows = Rows.of(recording(np.random.default_rng(3), duration=2.0, period=period), RIG)
    hypothesis = Hypothesis((Term(catalogue()["elastic_coupling"], shape),))
    layout, smooth, source = lay_out(rows, hypothesis), rows.conditioning.filter, rows.conditioning.source_noise**2
    omega = np.arange(0.0, np.pi / period, 0.1 * shape[0] * shape[1])
    passed = period / np.pi * np.exp(-((omega * smooth.width) ** 2))
    s = 1j * omega / shape[0]
    transfer = -(s**2) / (1.0 + 2.0 * shape[1] * s + s**2)
    behind = np.trapezoid(source * passed * omega**2 * np.abs(transfer) ** 2, omega)
    assert layout.noise[-1, -1] == pytest.approx(behind, rel=2e-3)
    theta = theta_of(layout, inertia=1e-3, viscous=1e-4, strength=6e-4)
    kinetic = 1j * omega * (1e-3 + 6e-4 * transfer) + 1e-4
    power = rows.conditioning.effort_noise**2 + source * np.abs(kinetic) ** 2
    floor = Floor(rows, hypothesis, layout, theta, np.zeros_like(layout.effort)).white
    assert floor == pytest.approx(np.sqrt(np.trapezoid(passed * power, omega)), rel=2e-3)
