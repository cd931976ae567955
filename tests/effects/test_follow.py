"""Under its drive, along the references of a recording of the independent axis, a model with its effect moves alike."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.plant.tracking import follow_references
from bench.rig.rig import load_rig
from bench.trace.trace import Trace
from bench.validation.independent.rig import write_rig
from tests.effects.axes import AXIS, PERIOD, model
from tests.effects.conftest import MOTION

EVERY = 8
UNITS = {
    "position": "rad",
    "velocity": "rad/s",
    "current": "A",
    "position_reference": "rad",
    "velocity_reference": "rad/s",
}


@pytest.fixture
def rig(tmp_path):
    write_rig(AXIS, tmp_path / "rig.toml")
    return load_rig(tmp_path / "rig.toml")


def recording(signals, *left_out):
    time = PERIOD * np.arange(signals["velocity"].size)[::EVERY]
    reference = MOTION.at(time)
    kept = {
        "position": signals["measured_position"][::EVERY],
        "velocity": signals["measured_velocity"][::EVERY],
        "current": signals["current"][::EVERY],
        "position_reference": reference[0],
        "velocity_reference": reference[1],
    }
    kept = {name: values for name, values in kept.items() if name not in left_out}
    return Trace(time, kept, {name: UNITS[name] for name in kept}, "independent")


def gap(axis, trace, rig):
    return float(np.sqrt(np.mean((follow_references(axis, trace, rig).velocity - trace["velocity"]) ** 2)))


@pytest.mark.parametrize(
    "case",
    [
        ("voltage_limit",),
        ("elastic_coupling",),
        ("current_loop_lag",),
        ("encoder_eccentricity",),
        ("velocity_filter_lag",),
    ],
)
def test_effect_closes_the_gap(case, truths, rig):
    trace = recording(truths[case])
    before, after = gap(model(), trace, rig), gap(model(*case), trace, rig)
    print(f"{case[0]}: {before:.3f} -> {after:.3f} rad/s")
    assert after < 0.03
    assert after < 0.1 * before


@pytest.mark.parametrize(
    "left_out", [(), ("position_reference",), ("velocity_reference",), ("position", "position_reference")]
)
def test_any_reference_will_do(left_out, truths, rig):
    assert gap(model(), recording(truths[()], *left_out), rig) < 0.03


def test_no_reference_is_reported(truths, rig):
    with pytest.raises(InputError, match="contains no references"):
        follow_references(model(), recording(truths[()], "position_reference", "velocity_reference"), rig)


def test_holes_are_reported(truths, rig):
    trace = recording(truths[()])
    gone = np.r_[0:100, 200 : len(trace)]
    holed = Trace(trace.time[gone], {n: trace[n][gone] for n in UNITS}, dict(trace.units), "holed")
    with pytest.raises(InputError, match="holes"):
        follow_references(model(), holed, rig)
