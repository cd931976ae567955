"""A spring makes a free axis an oscillator about its rest position."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.signals import Axis
from tests.effects.axes import FREE, moved, present, signals


@pytest.mark.parametrize("reference", [0.0, 0.3])
def test_free_axis_swings(reference):
    """From the rest position it swings as a sine; from elsewhere it adds a cosine of the distance."""
    spring = present("torsion_spring", reference=reference)
    time, position, _ = signals(moved([spring], 2.0, velocity=10.0))
    omega = np.sqrt(0.02 / FREE.inertia)
    swings = reference + 10.0 / omega * np.sin(omega * time) - reference * np.cos(omega * time)
    np.testing.assert_allclose(position, swings, atol=1e-4)


def test_the_reference_is_where_the_constant_torque_is_that_of_the_spring():
    report = catalogue()["torsion_spring"].report
    assert report((15.0, 4.5), (), Axis(1.0, 0.0, 0.0)) == {"stiffness": 15.0, "reference": pytest.approx(0.3)}
    assert report((0.0, 4.5), (), Axis(1.0, 0.0, 0.0))["reference"] == 0.0
