"""What the sensors' noise becomes in the torque balance, against closed forms."""

import numpy as np
import pytest

from bench.fit.fit import fit
from bench.fit.hypothesis import BASE, Hypothesis, lay_out
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
