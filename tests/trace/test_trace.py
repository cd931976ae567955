"""What holds of every trace."""

import pickle

import numpy as np
import pytest

from bench.trace.motion import measured_velocity
from bench.trace.trace import Trace


def test_it_travels_to_another_process():
    """All of it, and read-only again."""
    trace = Trace(
        np.arange(3.0),
        {"velocity": np.ones(3)},
        {"velocity": "rad/s"},
        "here",
        {"drive": "x"},
        notes=("y",),
        continues=True,
    )
    copy = pickle.loads(pickle.dumps(trace))
    np.testing.assert_array_equal(copy["velocity"], trace["velocity"])
    assert (copy.units, copy.metadata, copy.origin) == (trace.units, trace.metadata, "here")
    assert (copy.notes, copy.continues, copy.wraps) == (("y",), True, None)
    with pytest.raises(TypeError):
        copy.signals["velocity"] = np.zeros(3)


def test_a_lone_sample_between_holes_goes_as_fast_as_its_neighbours_say():
    """x = t**2: a mean speed between two times is their sum."""
    time = 1e-3 * np.array([0.0, 1.0, 2.0, 3.0, 20.0, 40.0, 41.0, 42.0, 43.0])
    speed = measured_velocity(Trace(time, {"position": time**2}, {"position": "rad"}, "a parabola"))
    assert speed[4] == pytest.approx(0.043)
    np.testing.assert_allclose(speed[[1, 2, 6, 7]], 2.0 * time[[1, 2, 6, 7]], rtol=1e-9)
