"""An eccentric mass trades kinetic for potential energy."""

import numpy as np

from tests.effects.axes import FREE, moved, present, signals


def test_energy_is_kept():
    _, position, velocity = signals(moved([present("unbalance")], 2.0, velocity=20.0))
    energy = 0.5 * FREE.inertia * velocity**2 - 0.2 * np.cos(position - 0.5)
    np.testing.assert_allclose(energy, energy[0], atol=2e-5)
    assert np.ptp(velocity) > 5.0


def test_it_falls_to_where_the_mass_hangs_lowest():
    """Released a little beside its equilibrium at q = 0.5, it swings about it at sqrt(A/J)."""
    time, position, _ = signals(moved([present("unbalance")], 1.0, position=0.51))
    np.testing.assert_allclose(position - 0.5, 0.01 * np.cos(np.sqrt(0.2 / FREE.inertia) * time), atol=1e-5)
