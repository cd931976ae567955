"""Inertia that varies with angle: kinetic energy is kept."""

import numpy as np

from tests.effects.axes import FREE, moved, present, signals


def test_kinetic_energy_is_kept():
    _, position, velocity = signals(moved([present("position_dependent_inertia")], 1.0, velocity=20.0))
    inertia = FREE.inertia * (1.0 + 0.1 * np.sin(2.0 * position + 0.4))
    energy = 0.5 * inertia * velocity**2
    np.testing.assert_allclose(energy, energy[0], rtol=1e-3)
    assert np.ptp(velocity) > 1.5
