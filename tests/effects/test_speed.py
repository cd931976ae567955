"""What effects cost, printed; the limits are wide, for machines that others use too."""

import time

import numpy as np
import pytest

from bench.plant.run import run
from bench.plant.track_effects import track_effects
from bench.trace.trace import Trace
from tests.effects.axes import AXIS, Reversals, model, plant

DURATION, SAMPLE_PERIOD = 13.0, 1e-3
NATIVE = ("cogging_torque", "elastic_coupling", "presliding_friction", "quadratic_drag", "torsion_spring")
TICKED = ("stribeck_friction",)
MANY_TICKED = (
    "direction_dependent_friction",
    "friction_warmup",
    "position_dependent_inertia",
    "stribeck_friction",
    "torque_ripple",
)


@pytest.mark.parametrize(("names", "most"), [((), 1.0), (NATIVE, 1.5), (TICKED, 4.0), (MANY_TICKED, 8.0)], ids=str)
def test_tracking_a_recording(names, most):
    """13 s at 1 kHz, 26000 steps."""
    times = SAMPLE_PERIOD * np.arange(round(DURATION / SAMPLE_PERIOD))
    position, velocity, acceleration = Reversals(DURATION, 20.0).at(times)
    current = AXIS.inertia * acceleration / AXIS.torque_constant
    signals = {"position": position, "velocity": velocity, "current": current}
    trace = Trace(times, signals, {"position": "rad", "velocity": "rad/s", "current": "A"}, "made up")
    start = time.perf_counter()
    track_effects(model(*names), trace, AXIS.torque_constant * current)
    took = time.perf_counter() - start
    print(f"{len(names)} effects ({', '.join(names) or 'none'}): {took:.2f} s, {took / 0.026:.1f} us a step")
    assert took < most


def test_many_axes_cost_little_more_than_one():
    references = Reversals(0.2).references()
    start = time.perf_counter()
    run([plant(*MANY_TICKED)] * 100, [references] * 100)
    took = time.perf_counter() - start
    each = 1e6 * took / (100 * len(references.time))
    print(f"100 axes with {len(MANY_TICKED)} ticked effects: {each:.1f} us an axis and step")
    assert each < 30.0
