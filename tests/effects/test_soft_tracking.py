"""A model weakly coupled to a recording of the independent axis: the effect closes the velocity gap."""

import numpy as np
import pytest

from bench.effects.present import Present
from bench.plant.axis_model import AxisModel
from bench.plant.tracking import SoftTracking, track, track_all
from bench.trace.trace import Trace
from tests.effects.axes import AXIS, PERIOD, model
from tests.effects.conftest import CASES

EVERY = 8
#: Gap that is left, rad/s: the reversals between two samples, at which a recorded current jumps.
LEFT = 0.06
FAINT = Present.of("position_dependent_friction", {"relative_amplitude": 1e-12})


@pytest.fixture(scope="module")
def recordings(truths):
    return {case: recording(signals) for case, signals in truths.items()}


def recording(signals, position=True):
    """Every eighth tick, as a drive would record it: 1 ms."""
    kept = {"velocity": signals["measured_velocity"][::EVERY], "current": signals["current"][::EVERY]}
    if position:
        kept["position"] = signals["measured_position"][::EVERY]
    units = {"velocity": "rad/s", "current": "A", "position": "rad"}
    times = PERIOD * EVERY * np.arange(kept["velocity"].size)
    return Trace(times, kept, {name: units[name] for name in kept}, "independent")


def velocity_of(axis: AxisModel, trace: Trace, misalignment=0.0):
    """Velocity of an axis held to a recording - rad/s - (n,)."""
    return track(SoftTracking(axis, trace, AXIS.torque_constant * trace["current"], misalignment)).velocity


def gap(axis: AxisModel, trace: Trace) -> float:
    """RMS velocity gap - rad/s; the current belongs to the middle of the tick that begins with its sample."""
    simulated = velocity_of(axis, trace, misalignment=-PERIOD / 2.0)
    return float(np.sqrt(np.mean((simulated - trace["velocity"]) ** 2)))


@pytest.mark.parametrize("case", CASES, ids=" + ".join)
def test_effect_closes_the_gap(case, recordings):
    after, before = gap(model(*case), recordings[case]), gap(model(), recordings[case])
    print(f"{' + '.join(case) or 'none'}: {before:.3f} -> {after:.3f} rad/s")
    assert after < LEFT * (2.5 if "backlash" in case else 1.0)
    # what flows is what was recorded: a voltage limit leaves no gap here
    assert case in ((), ("voltage_limit",)) or after < 0.35 * before


def test_without_position_the_velocity_holds_the_model(recordings):
    trace = recordings["torque_offset",]
    blind = Trace(trace.time, {n: trace[n] for n in ("velocity", "current")}, dict(trace.units), "independent")
    assert gap(model("torque_offset"), blind) < LEFT


def test_natively_and_step_by_step_alike(recordings):
    """A friction that varies by next to nothing makes every step tick."""
    trace = recordings["cogging_torque",]
    native = model("cogging_torque")
    ticked = native.with_effects([*native.effects, FAINT])
    assert ticked.ticked
    np.testing.assert_allclose(velocity_of(ticked, trace), velocity_of(native, trace), atol=1e-6)


@pytest.mark.parametrize("case", [(), ("stribeck_friction",), ("velocity_filter_lag",), ("encoder_eccentricity",)])
def test_position_is_reported_as_the_sensor_has_it(case, recordings):
    trace = recordings[case]
    held = SoftTracking(model(*case), trace, AXIS.torque_constant * trace["current"], -PERIOD / 2.0)
    found, (again,) = track(held), track_all([held])
    np.testing.assert_array_equal(found.velocity, again.velocity)
    assert np.abs(found.position - trace["position"]).max() < 0.01
