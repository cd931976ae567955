"""Ripple under constant current: kinetic energy is the integral of torque over angle."""

import numpy as np

from bench.effects.effect import Stage
from bench.effects.signals import AxisState
from bench.plant.sensing import remaining
from tests.effects.axes import FREE, VALUES, model, moved, present, signals


def test_work_of_the_motor():
    _, q, velocity = signals(moved([present("torque_ripple")], 0.3, torque=0.3))
    work = 0.3 * (q + 0.15 / 4.0 * (np.cos(-1.0) - np.cos(4.0 * q - 1.0)))
    np.testing.assert_allclose(0.5 * FREE.inertia * velocity**2, work, atol=2e-4 * work.max())


def test_no_current_no_ripple():
    _, _, velocity = signals(moved([present("torque_ripple")], 0.3, velocity=20.0))
    np.testing.assert_allclose(velocity, 20.0, atol=1e-9)


def test_effort_that_remains_after_the_stage_follows_the_position():
    """Along a recording, too, as a held model gets it: M*(1 + A*sin(n*q + phi))."""
    position, effort = np.linspace(-3.0, 5.0, 50), np.linspace(-1.0, 2.0, 50)
    at, values = AxisState(0.0, position, 0.0 * position, effort), VALUES["torque_ripple"]
    factor = 1.0 + values["relative_amplitude"] * np.sin(values["harmonic"] * position + values["phase"])
    np.testing.assert_allclose(remaining(model("torque_ripple"), Stage.COMMUTATION, at), effort * factor, rtol=1e-12)
    np.testing.assert_array_equal(remaining(model("torque_ripple"), Stage.CURRENT_SENSOR, at), effort)
