"""What effects declare of sensors, delays and what is seen is what they do in a simulation.

Asked are all effects that there are, those of other packages too where some are installed.
"""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.kinds import Sensing
from bench.trace.signals import SI_UNITS
from bench.trace.trace import Trace
from tests.effects.axes import model
from tests.effects.recording import BASE, RECORDED, STEP, differ, every, made, reported, shape_of

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
    if isinstance(effect, Sensing) and effect.overrides("seen"):
        values = effect.report([], shape, BASE)
        position, velocity = effect.seen(values, RECORDED.position, RECORDED.velocity)
        found = effect.see(replace(RECORDED, position=position, velocity=velocity), shape)
        np.testing.assert_allclose(found.position, RECORDED.position, atol=1e-9)
        np.testing.assert_allclose(found.velocity, RECORDED.velocity, atol=1e-7)
        again = effect.unseen(values, position, velocity)
        np.testing.assert_allclose(again, [RECORDED.position, RECORDED.velocity], atol=1e-7)
        return
    hooks = [hook for hook in ("acting_along", "unrecorded") if effect.overrides(hook)]
    assert hooks or not effect.overrides("see")
    for hook in hooks:
        acts = getattr(effect, hook)(effect.report([], shape, BASE), RECORDED.torque, STEP)
        np.testing.assert_allclose(effect.see(RECORDED, shape).torque, acts, atol=1e-12)


@every
def test_a_delay_is_that_of_the_simulated_signal(effect):
    """A sine that passes it comes out as behind a first-order lag of the declared time; without one, nothing lasts."""
    shape, sources = shape_of(effect), ("velocity", "position")
    declared = [lag for source in sources for lag in effect.delays(shape, source)]
    twice = [lag for source in sources for lag in effect.delays([2.0 * value for value in shape], source)]
    assert twice == pytest.approx([2.0 * lag for lag in declared])
    assert any(declared) == effect.overrides("delays")
    hooks = [hook for hook in ("acting_along", "filtered") if effect.overrides(hook)]
    assert hooks or not any(declared)
    for passes in (getattr(effect, hook) for hook in hooks):
        late = passes(reported(effect), WAVE, TICK)
        if any(declared):
            assert_lags(late, max(declared))
        else:
            assert not differ([late], [passes(reported(effect), WAVE[::-1], TICK)[::-1]])


@every
def test_a_lag_of_the_effort_is_that_of_the_recorded_one_and_is_undone(effect):
    """A sine comes out of the recorder as behind a first-order lag of the declared time, and back as it was."""
    shape = shape_of(effect)
    declared = effect.effort_lag(shape)
    assert effect.effort_lag([2.0 * value for value in shape]) == pytest.approx(2.0 * declared)
    hooks = [effect.overrides(hook) for hook in ("effort_lag", "recorded", "unrecorded")]
    assert hooks == [declared > 0.0] * 3
    if not declared:
        return
    values = effect.report([], shape, BASE)
    late = effect.recorded(values, WAVE, TICK)
    assert_lags(late, declared)
    np.testing.assert_allclose(effect.unrecorded(values, late, TICK)[5000:-1], WAVE[5000:-1], atol=1e-3)


@every
def test_what_a_sensor_of_the_current_misreads_is_what_its_columns_explain(effect):
    """Reported less acting effort is the columns' sum, so far as it is small; nothing else of a sensor has columns."""
    if not isinstance(effect, Sensing):
        return
    assert effect.overrides("acted") == effect.overrides("columns")
    if effect.overrides("columns"):
        values = reported(effect)
        acts = effect.acted(values, AXIS, RECORDED.effort, RECORDED.time)
        np.testing.assert_allclose(made(effect), RECORDED.effort - acts, atol=1e-12)


@every
def test_it_mends_the_signal_it_declares_faulty_and_no_other(effect):
    assert bool(effect.faulty_signal) == effect.overrides("corrected")
    if not effect.faulty_signal:
        return
    assert effect.faulty_signal in SI_UNITS
    values = reported(effect)
    spoilt = {"position": RECORDED.position, "current": RECORDED.torque, "velocity": RECORDED.velocity}
    spoilt[effect.faulty_signal] = effect.filtered(values, spoilt[effect.faulty_signal], STEP)
    units = {"position": "rad", "velocity": "rad/s", "current": "A"}
    mended = effect.corrected(Trace(RECORDED.time, spoilt, units, "reversals"), values)
    for name, true in (("position", RECORDED.position), ("current", RECORDED.torque), ("velocity", RECORDED.velocity)):
        off = np.abs(mended[name] - true)[10:-10].max()
        assert off < 0.02 * np.abs(true).max()
        assert name == effect.faulty_signal or off == 0.0


@every
def test_kind_says_whether_a_sensor_errs(effect):
    """Of the motion, or of the torque that the balance is to explain."""
    wrong = effect.see(RECORDED, shape_of(effect)).effort is not RECORDED.effort
    assert effect.kind == ("measurement" if isinstance(effect, Sensing) or wrong else "physics")
