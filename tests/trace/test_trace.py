"""What holds of every trace."""

import pickle

import numpy as np
import pytest

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
