"""A recorder's filter on the current: the axis does not feel it, and it takes no name from what the axis has."""

import numpy as np
import pytest

from bench.effects.current_filter_lag import EFFECT
from bench.plant.run import run
from bench.plant.sensing import reported_states
from tests.effects.axes import PERIOD, VALUES, Reversals, model, plant
from tests.effects.damaged import AXIS, SECONDS, SINGLES, diagnosed, filtered, inertia_holds, late, names

NAME = "current_filter_lag"
#: Of a recursive filter of one sample's time constant: the mean of its impulse response, 1/(e - 1) samples - s.
DELAY = 1e-3 / (np.e - 1.0)


def test_lags_a_ramp_and_is_undone():
    time = PERIOD * np.arange(400)
    found = EFFECT.lagging({"time_constant": 2e-3}, 100.0 * time, PERIOD)
    np.testing.assert_allclose(found, 100.0 * (time - 2e-3 * (1.0 - np.exp(-time / 2e-3))), atol=1e-9)
    wave = np.sin(2.0 * np.pi * 5.0 * PERIOD * np.arange(4000))
    back = EFFECT.leading(VALUES[NAME], EFFECT.lagging(VALUES[NAME], wave, PERIOD), PERIOD)
    np.testing.assert_allclose(back[100:-1], wave[100:-1], atol=1e-3)


def test_the_axis_does_not_feel_it():
    references = Reversals(0.2).references()
    states = run(plant(NAME), references)
    np.testing.assert_array_equal(states.velocity, run(plant(), references).velocity)
    assert np.abs(reported_states(model(NAME), states).torque - states.torque).max() > 0.01


@pytest.mark.slow  # the lag by itself is among `test_diagnosed.py`
@pytest.mark.parametrize("single", [None, *SINGLES])
def test_a_filter_of_a_millisecond_keeps_the_names_of_singles(single):
    found = diagnosed(single or "null", filtered, 2.0 * SECONDS)
    assert names(found) == {NAME, single} - {None}
    (lag,) = [effect.parameters["time_constant"] for effect in found.effects if effect.name == NAME]
    assert lag.value == pytest.approx(DELAY, abs=AXIS.control_period)
    assert inertia_holds(found)


@pytest.mark.parametrize("single", [None, *(pytest.param(name, marks=pytest.mark.slow) for name in SINGLES)])
def test_half_a_millisecond_late_is_no_backlash(single):
    found = diagnosed(single or "null", late)
    assert names(found) - {NAME} == {single} - {None}
    assert inertia_holds(found)
