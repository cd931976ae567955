"""What effects declare of sensors, delays and what is seen is what they do in a simulation.

Asked are all effects that there are, those of other packages too where some are installed.
"""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.effect import Distortion, EncoderFault, Lag
from bench.trace.signals import SI_UNITS
from bench.trace.trace import Trace
from tests.effects.axes import model
from tests.effects.recording import BASE, RECORDED, STEP, every, reported, shape_of

AXIS = model().axis
#: A sine that passes a lag: time - s -, and its angular frequency - rad/s.
TICK, OMEGA = 1e-4, 2.0 * np.pi * 30.0
TIME = TICK * np.arange(10000)
WAVE = np.sin(OMEGA * TIME)


def assert_lags(late, time_constant):
    """The second half of what became of the sine is that behind a first-order lag."""
    half = slice(WAVE.size // 2, None)
    listen = np.exp(-1j * OMEGA * TIME[half])
    gain = np.sum(late[half] * listen) / np.sum(WAVE[half] * listen)
    assert gain == pytest.approx(1.0 / (1.0 + 1j * OMEGA * time_constant), rel=1e-3)


@every
def test_what_it_sees_is_what_a_simulated_sensor_or_drive_does_undone(effect):
    shape = shape_of(effect)
    if isinstance(effect, EncoderFault):
        values = effect.report([], shape, BASE)
        position, velocity = effect.measured(values, RECORDED.position, RECORDED.velocity)
        found = effect.without_fault(replace(RECORDED, position=position, velocity=velocity), shape)
        np.testing.assert_allclose(found.position, RECORDED.position, atol=1e-9)
        np.testing.assert_allclose(found.velocity, RECORDED.velocity, atol=1e-7)
        again = effect.actual(values, position, velocity)
        np.testing.assert_allclose(again, [RECORDED.position, RECORDED.velocity], atol=1e-7)
        return
    if not isinstance(effect, Distortion):
        return
    if isinstance(effect, Lag) and effect.signal == "velocity":
        late = effect.lagging(effect.report([], shape, BASE), RECORDED.velocity, STEP)
        summed = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (late[1:] + late[:-1]))])
        off = (
            effect.without_fault(replace(RECORDED, velocity=late, position=summed), shape).position - RECORDED.position
        )
        assert np.ptp(off) < 1e-3 * np.ptp(summed - RECORDED.position)
        return
    values, found = effect.report([], shape, BASE), effect.without_fault(RECORDED, shape)
    assert isinstance(effect, Lag)
    undo = effect.lagging if effect.signal == "torque" else effect.leading
    acts = undo(values, RECORDED.torque, STEP)
    np.testing.assert_allclose(found.torque, acts, atol=1e-12)


@every
def test_a_delay_is_that_of_the_simulated_signal(effect):
    """A sine that passes it comes out as behind a first-order lag of the declared time."""
    shape, sources = shape_of(effect), ("velocity", "position")
    if not isinstance(effect, Lag) or effect.signal == "current":
        return
    declared = [lag for source in sources for lag in effect.delays(shape, source)]
    twice = [lag for source in sources for lag in effect.delays([2.0 * value for value in shape], source)]
    assert twice == pytest.approx([2.0 * lag for lag in declared])
    assert any(declared)
    assert_lags(effect.lagging(reported(effect), WAVE, TICK), max(declared))


@every
def test_a_lag_of_the_effort_is_that_of_the_recorded_one_and_is_undone(effect):
    """A sine comes out of the recorder as behind a first-order lag of the declared time, and back as it was."""
    if not isinstance(effect, Lag) or effect.signal != "current":
        return
    shape = shape_of(effect)
    *motion, declared = effect.delays(shape, "velocity")
    assert motion == [0.0, 0.0]
    values = effect.report([], shape, BASE)
    late = effect.lagging(values, WAVE, TICK)
    assert_lags(late, declared)
    np.testing.assert_allclose(effect.leading(values, late, TICK)[5000:-1], WAVE[5000:-1], atol=1e-3)


@every
def test_it_mends_the_signal_it_filters_and_no_other(effect):
    if not isinstance(effect, Lag) or effect.signal == "torque":
        return
    assert effect.signal in SI_UNITS
    values = reported(effect)
    spoilt = {"position": RECORDED.position, "current": RECORDED.torque, "velocity": RECORDED.velocity}
    spoilt[effect.signal] = effect.lagging(values, spoilt[effect.signal], STEP)
    units = {"position": "rad", "velocity": "rad/s", "current": "A"}
    mended = effect.corrected(Trace(RECORDED.time, spoilt, units, "reversals"), values)
    for name, true in (("position", RECORDED.position), ("current", RECORDED.torque), ("velocity", RECORDED.velocity)):
        off = np.abs(mended[name] - true)[10:-10].max()
        assert off < 0.02 * np.abs(true).max()
        assert name == effect.signal or off == 0.0


@every
def test_what_changes_the_torque_to_be_explained_is_a_fault_of_a_sensor(effect):
    assert effect.of_measurement or not shows_effort(effect)


def shows_effort(effect):
    """Whether a fit with it explains another torque than the reported one."""
    return (
        isinstance(effect, Distortion)
        and effect.without_fault(RECORDED, shape_of(effect)).effort is not RECORDED.effort
    )
