"""Cogging trades kinetic for magnetic energy, n times a revolution."""

import numpy as np

from tests.effects.axes import FREE, Present, moved, present, signals


def test_energy_is_kept():
    _, position, velocity = signals(moved([present("cogging_torque")], 1.0, velocity=20.0))
    energy = 0.5 * FREE.inertia * velocity**2 - 0.08 / 6.0 * np.cos(6.0 * position + 1.1)
    np.testing.assert_allclose(energy, energy[0], atol=2e-5)


def test_harmonics_add():
    """Two effects of one name are two harmonics."""
    two = [Present.of("cogging_torque", {"amplitude": 0.05, "harmonic": n}) for n in (4.0, 18.0)]
    _, position, velocity = signals(moved(two, 1.0, velocity=20.0))
    energy = 0.5 * FREE.inertia * velocity**2 - sum(0.05 / n * np.cos(n * position) for n in (4.0, 18.0))
    np.testing.assert_allclose(energy, energy[0], atol=5e-5)
