"""Less torque per ampere at high current."""

import numpy as np
import pytest

from tests.effects.axes import AXIS, FREE, moved, present, signals


@pytest.mark.parametrize("torque", [0.5, -3.0])
def test_acceleration(torque):
    states = moved([present("torque_constant_saturation")], 0.05, torque=torque)
    time, _, velocity = signals(states)
    made = torque * (1.0 - 0.2 * (torque / AXIS.peak_torque) ** 2)
    np.testing.assert_allclose(velocity, made * time / FREE.inertia, atol=1e-9)
    np.testing.assert_array_equal(states.torque[:-1], torque)
