"""Friction that varies with angle: kinetic energy falls by its integral."""

from dataclasses import replace

import numpy as np

from tests.effects.axes import FREE, moved, present, signals


def test_energy_falls_by_the_integral_of_friction():
    dry = replace(FREE, coulomb_friction=0.06)
    _, q, velocity = signals(moved([present("position_dependent_friction")], 0.5, velocity=40.0, parameters=dry))
    lost = 0.06 * (q + 0.6 * (np.cos(0.7) - np.cos(q + 0.7)))
    np.testing.assert_allclose(0.5 * FREE.inertia * (40.0**2 - velocity**2), lost, atol=2e-5)
    assert velocity[-1] > 0.0
