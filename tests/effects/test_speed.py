"""What effects cost: counted in steps that Python takes part in, and measured with `-m '' --benchmark-only -s`."""

import mujoco
import numpy as np
import pytest

from bench.plant.run import run
from bench.plant.tracking import SoftTracking, track
from bench.trace.trace import Trace
from tests.calls import calls_of
from tests.effects.axes import AXIS, Reversals, model, plant

SAMPLE_PERIOD = 1e-3
#: A sample is simulated in two steps.
STEPS = 2
NATIVE = ("cogging_torque", "elastic_coupling", "presliding_friction", "quadratic_drag", "torsion_spring")
TICKED = ("stribeck_friction",)
MANY_TICKED = (
    "direction_dependent_friction",
    "friction_warmup",
    "position_dependent_inertia",
    "stribeck_friction",
    "torque_ripple",
)


def recorded(duration):
    times = SAMPLE_PERIOD * np.arange(round(duration / SAMPLE_PERIOD))
    position, velocity, acceleration = Reversals(duration, 20.0).at(times)
    current = AXIS.inertia * acceleration / AXIS.torque_constant
    signals = {"position": position, "velocity": velocity, "current": current}
    return Trace(times, signals, {"position": "rad", "velocity": "rad/s", "current": "A"}, "made up")


def tracked(names, trace):
    return track(SoftTracking(model(*names), trace, AXIS.torque_constant * trace["current"])).velocity


@pytest.mark.parametrize(("names", "each"), [((), 0), (NATIVE, 0), (TICKED, STEPS), (MANY_TICKED, STEPS)], ids=str)
def test_native_effects_leave_all_steps_to_mujoco(names, each):
    trace = recorded(0.2)
    with calls_of(mujoco.mj_step) as steps:
        assert np.isfinite(tracked(names, trace)).all()
    assert len(steps) == pytest.approx(each * len(trace), abs=STEPS)


def test_a_drive_takes_one_step_a_tick():
    references, one = Reversals(0.02).references(), plant(*MANY_TICKED)
    with calls_of(mujoco.mj_step) as steps:
        run(one, references)
    assert len(steps) == len(references.time) * one.substeps


@pytest.mark.slow
@pytest.mark.parametrize("names", [(), NATIVE, TICKED, MANY_TICKED], ids=str)
def test_tracking_a_recording(names, benchmark):
    """13 s at 1 kHz, 26000 steps."""
    assert np.isfinite(benchmark(tracked, names, recorded(13.0))).all()
