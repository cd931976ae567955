"""A motor with inertia, viscous and Coulomb friction along a prescribed motion, from closed form."""

import numpy as np

from tests.sines import sines


def drive(inertia, viscous, coulomb, constant, seconds=8.0, period=2e-3, turns=1.0, seed=1):
    """Times - s -, position - rad -, velocity - rad/s - and current - A -, each (n,); noise only in the current."""
    time = np.arange(0.0, seconds, period)
    position, velocity, acceleration = turns * sines(time, [(6.0, 0.6, 0.0), (2.0, 1.3, 0.7), (0.6, 2.9, 2.0)])
    torque = inertia * acceleration + viscous * velocity + coulomb * np.sign(velocity)
    noise = 2e-3 * np.std(torque) * np.random.default_rng(seed).standard_normal(time.size)
    return time, position, velocity, (torque + noise) / constant
