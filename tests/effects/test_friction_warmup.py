"""Friction that decays: speed falls by its integral over time."""

from dataclasses import replace

import numpy as np

from tests.effects.axes import FREE, Present, moved, signals

VALUES = {"relative_amplitude": 1.5, "time_constant": 0.3}


def test_dry_friction():
    dry = replace(FREE, coulomb_friction=0.06)
    time, _, velocity = signals(moved([Present.of("friction_warmup", VALUES)], 0.5, velocity=60.0, parameters=dry))
    lost = 0.06 / FREE.inertia * (time + 1.5 * 0.3 * (1.0 - np.exp(-time / 0.3)))
    np.testing.assert_allclose(velocity, 60.0 - lost, atol=1e-5)


def test_viscous_friction_has_its_share():
    viscous = replace(FREE, viscous_friction_coefficient=2e-3)
    effect = Present.of("friction_warmup", {**VALUES, "viscous_share": 0.5})
    time, _, velocity = signals(moved([effect], 0.5, velocity=60.0, parameters=viscous))
    rate = 2e-3 / FREE.inertia * (time + 0.5 * 1.5 * 0.3 * (1.0 - np.exp(-time / 0.3)))
    np.testing.assert_allclose(velocity, 60.0 * np.exp(-rate), rtol=1e-5)
