"""What is left unexplained is described by its shape."""

import numpy as np
import pytest

from bench.diagnosis.where import Where
from bench.report.gap import shape

ANGLE = np.linspace(0.0, 6.2, 48)
AXIS = np.linspace(0.0, 0.02, 48)


def left(coordinate, unit, centres, means, region=None):
    return Where(coordinate, region or (float(centres.min()), float(centres.max())), unit, 0.4, centres, means)


BUMP = np.exp(-(((ANGLE - 2.0) / 0.1) ** 2))
NOISE = np.random.default_rng(0).normal(size=48)


@pytest.mark.parametrize(
    ("account", "expected"),
    [
        (left("position", "m", AXIS, np.sin(2.0 * np.pi * AXIS / 2.5e-3) + 0.2 * NOISE), "a wave of 0.0025 m"),
        (left("position", "rad", ANGLE, BUMP, (1.9, 2.1)), "at one position, between 1.9 and 2.1 rad"),
        (left("position", "rad", ANGLE, NOISE), "it changes with position, most between 0 and 6.2 rad"),
        (left("reversal", "s", ANGLE, BUMP, (0.0, 0.05)), "spikes at each breakaway, within 0.05 s of a reversal"),
        (left("velocity", "rad/s", ANGLE - 3.1, BUMP, (-0.2, 0.2)), "around standstill, between −0.2 and 0.2 rad/s"),
        (left("time", "s", ANGLE, 0.1 * ANGLE + 0.02 * NOISE), "it grows with time"),
        (left("time", "s", ANGLE, 1.0 - 0.1 * ANGLE), "it fades with time"),
        (left("time", "s", ANGLE, BUMP, (1.9, 2.1)), "at one time, between 1.9 and 2.1 s"),
        (left("frequency", "Hz", ANGLE, BUMP, (37.0, 39.0)), "an oscillation of 38 Hz"),
        (
            left("direction", "dimensionless", np.array([-1.0, 1.0]), np.array([-1.0, 1.0])),
            "it differs between the directions",
        ),
    ],
)
def test_what_is_left_has_a_shape(account, expected):
    assert shape(account).replace("\N{NO-BREAK SPACE}", " ") == expected
