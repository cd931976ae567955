"""MuJoCo with each effect against the independent integrator: under the same drive, along its references, and weakly
coupled to its recording.

Printed: RMS difference of velocity, and of the torque that the drive reports, beside what the effect changes in them.
"""

import numpy as np
import pytest

from bench.arrays import rms
from bench.effects.present import Present
from bench.errors import InputError
from bench.plant.axis_model import AxisModel
from bench.plant.run import run
from bench.plant.sensing import reported_states
from bench.plant.tracking import SoftTracking, follow_references, track, track_all
from bench.rig.rig import load_rig
from bench.trace.trace import Trace
from bench.validation.independent.rig import write_rig
from tests.effects.axes import AXIS, PERIOD, model, plant
from tests.effects.conftest import CASES, MOTION

#: Share of what an effect changes that the two may differ by; contact begins and ends between MuJoCo's steps.
SHARE = {("backlash",): 0.04}
#: What the bare axis may differ by: MuJoCo ends the step of a reversal with friction against the new direction.
FLOOR = {"velocity": 0.002, "measured_velocity": 0.002, "measured_position": 5e-5}
#: Ticks of a sample, as a drive would record it: 1 ms.
EVERY = 8
#: Gap that weak coupling leaves - rad/s: the reversals between two samples, at which a recorded current jumps.
LEFT = 0.06
FAINT = Present.of("position_dependent_friction", {"relative_amplitude": 1e-12})
REFERENCES = ("position_reference", "velocity_reference")


@pytest.mark.parametrize("case", CASES, ids=" + ".join)
def test_same_motion(case, truths):
    bench = plant(*case)
    states = run(bench, MOTION.references())
    seen = reported_states(bench.model, states)
    bare, true = truths[()], truths[case]
    found = {"velocity": states.velocity, "measured_velocity": seen.velocity, "measured_position": seen.position}
    for name, values in found.items():
        off, changed = rms(values - true[name]), rms(true[name] - bare[name])
        print(f"{' + '.join(case)}: {name} {off:.1e} of {changed:.3g}")
        assert off < FLOOR[name] + SHARE.get(case, 0.01) * changed
    off = rms((seen.torque - AXIS.torque_constant * true["current"])[:-1])
    changed = AXIS.torque_constant * rms(true["current"] - bare["current"])
    print(f"{' + '.join(case)}: torque {off:.1e} of {changed:.3g} N*m")
    # the independent current is that of a moment, the bench's the mean of a step
    assert off < 0.0005 + (0.05 if "voltage_limit" in case else SHARE.get(case, 0.01)) * changed


def recording(signals, *left_out):
    """Samples of the independent axis with its references."""
    time = PERIOD * np.arange(signals["velocity"].size)[::EVERY]
    position, velocity, _ = MOTION.at(time)
    columns = {
        "position": ("rad", signals["measured_position"][::EVERY]),
        "velocity": ("rad/s", signals["measured_velocity"][::EVERY]),
        "current": ("A", signals["current"][::EVERY]),
        "position_reference": ("rad", position),
        "velocity_reference": ("rad/s", velocity),
    }
    kept = {name: column for name, column in columns.items() if name not in left_out}
    values, units = ({name: column[k] for name, column in kept.items()} for k in (1, 0))
    return Trace(time, values, units, "independent")


@pytest.fixture
def rig(tmp_path):
    write_rig(AXIS, tmp_path / "rig.toml")
    return load_rig(tmp_path / "rig.toml")


def follows(axis, trace, rig):
    """RMS velocity gap along the references - rad/s."""
    return rms(follow_references(axis, trace, rig).velocity - trace["velocity"])


@pytest.mark.parametrize(
    "name",
    ["voltage_limit", "elastic_coupling", "current_loop_lag", "encoder_eccentricity", "velocity_filter_lag"],
)
def test_along_references_an_effect_closes_the_gap(name, truths, rig):
    trace = recording(truths[name,])
    before, after = follows(model(), trace, rig), follows(model(name), trace, rig)
    print(f"{name}: {before:.3f} -> {after:.3f} rad/s")
    assert after < 0.03
    assert after < 0.1 * before


@pytest.mark.parametrize(
    "left_out", [(), ("position_reference",), ("velocity_reference",), ("position", "position_reference")]
)
def test_any_reference_will_do(left_out, truths, rig):
    assert follows(model(), recording(truths[()], *left_out), rig) < 0.03


def test_holes_and_no_references_are_reported(truths, rig):
    trace = recording(truths[()])
    with pytest.raises(InputError, match="contains no references"):
        follow_references(model(), recording(truths[()], *REFERENCES), rig)
    gone = np.r_[0:100, 200 : len(trace)]
    holed = Trace(trace.time[gone], {n: v[gone] for n, v in trace.signals.items()}, dict(trace.units), "holed")
    with pytest.raises(InputError, match="holes"):
        follow_references(model(), holed, rig)


def coupled(axis: AxisModel, trace: Trace, misalignment=-PERIOD / 2.0):
    """An axis weakly coupled to a recording; the current belongs to the middle of the tick that its sample begins."""
    return SoftTracking(axis, trace, AXIS.torque_constant * trace["current"], misalignment)


def tracks(axis, trace):
    """RMS velocity gap of an axis weakly coupled to a recording - rad/s."""
    return rms(track(coupled(axis, trace)).velocity - trace["velocity"])


@pytest.mark.parametrize("case", CASES, ids=" + ".join)
def test_weakly_coupled_an_effect_closes_the_gap(case, truths):
    trace = recording(truths[case])
    after, before = tracks(model(*case), trace), tracks(model(), trace)
    print(f"{' + '.join(case) or 'none'}: {before:.3f} -> {after:.3f} rad/s")
    assert after < LEFT * (2.5 if "backlash" in case else 1.0)
    # what flows is what was recorded: a voltage limit leaves no gap here
    assert case in ((), ("voltage_limit",)) or after < 0.35 * before


def test_without_position_the_velocity_is_enough(truths):
    assert tracks(model("torque_offset"), recording(truths["torque_offset",], "position")) < LEFT


def test_natively_and_step_by_step_alike(truths):
    """A friction that varies by next to nothing makes every step tick."""
    trace, native = recording(truths["cogging_torque",]), model("cogging_torque")
    ticked = native.with_effects([*native.effects, FAINT])
    assert ticked.ticked
    both = (track(coupled(axis, trace, 0.0)).velocity for axis in (ticked, native))
    np.testing.assert_allclose(*both, atol=1e-6)


@pytest.mark.parametrize("case", [(), ("stribeck_friction",), ("velocity_filter_lag",), ("encoder_eccentricity",)])
def test_position_is_reported_as_the_sensor_has_it(case, truths):
    trace = recording(truths[case])
    held = coupled(model(*case), trace)
    found, (again,) = track(held), track_all([held])
    np.testing.assert_array_equal(found.velocity, again.velocity)
    assert np.abs(found.position - trace["position"]).max() < 0.01
