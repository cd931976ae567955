"""Friction that grows with torque: less acceleration than the torque would give."""

from dataclasses import replace

import numpy as np

from tests.effects.axes import FREE, moved, present, signals


def test_acceleration_under_torque():
    dry = replace(FREE, coulomb_friction=0.06)
    time, _, velocity = signals(moved([present("load_dependent_friction")], 0.1, torque=1.0, parameters=dry))
    np.testing.assert_allclose(velocity, (1.0 - 0.06 - 0.12) * time / FREE.inertia, atol=1e-6)
