"""Models held against each other: exact values, and a run whose torque follows from the equation of motion."""

import math

import numpy as np
import pytest

from bench.axis_kind import ROTARY
from bench.baseline.check import Allowed
from bench.baseline.model import DURATION, compare_models, response
from bench.baseline.state import INSTANTS, Response, State
from bench.comparison.difference import Measured
from bench.plant.axis_model import AxisModel, AxisParameters
from tests.baseline.states import named

J, K_W, K_0 = 2e-3, 1e-3, 0.05
INERTIA = "moment_of_inertia"


def model(inertia=J, effects=(), response=None):
    values = {INERTIA: Measured(inertia, "kg*m**2", 0.0)}
    return State("model", False, values, tuple(effects), rig={"kind": "rotary"}, response=response)


def found(baseline, now):
    checked = compare_models(baseline, now, Allowed.of(None, ROTARY))
    return checked, {one.name: one for one in checked.comparisons}


@pytest.mark.parametrize(("factor", "result"), [(1.0049, "same"), (0.9951, "same"), (1.0051, "changed")])
def test_a_value_has_changed_beyond_its_margin_and_not_below(factor, result):
    checked, comparisons = found(model(), model(J * factor))
    assert (checked.result, comparisons[INERTIA].result) == (result, result)
    assert comparisons[INERTIA].difference.value == pytest.approx(J * (factor - 1.0))
    assert (checked.false_alarm_rate, checked.family) == (0.0, len(checked.comparisons))


def test_angles_go_by_the_shorter_way_round():
    def turned(phase):
        return model(effects=[named("cogging_torque", 0.0, amplitude=0.05, harmonic=6.0, phase=phase)])

    for phase, result in ((0.0 - 0.049, "same"), (2.0 * math.pi + 0.049, "same"), (0.051, "changed")):
        checked, comparisons = found(turned(0.0), turned(phase))
        assert checked.result == result
        assert comparisons["cogging_torque (harmonic 6).phase"].margin == 0.05


def test_an_effect_is_there_or_not():
    other = model(effects=[named("cogging_torque", 0.0, amplitude=0.05, harmonic=6.0, phase=0.0)])
    for before, now, how in ((model(), other, "appeared"), (other, model(), "gone")):
        checked, comparisons = found(before, now)
        assert checked.result == "changed"
        assert comparisons["cogging_torque (harmonic 6)"].effect == how
        assert [len(checked.appeared), len(checked.gone)] == [how == "appeared", how == "gone"]


def test_infinite_values_are_compared_too():
    for before, now, result in ((math.inf, math.inf, "same"), (math.inf, J, "changed"), (J, math.inf, "changed")):
        assert found(model(before), model(now))[0].result == result


def test_a_runs_torque_may_differ_by_a_hundredth_of_its_rms():
    torque = (3.0, -4.0) * (INSTANTS // 2)
    rms = math.sqrt(12.5)
    for share, result in ((0.0099, "same"), (0.0101, "changed")):
        now = Response(J, 50.0, tuple(np.add(torque, share * rms).tolist()))
        checked, comparisons = found(model(response=Response(J, 50.0, torque)), model(response=now))
        assert checked.result == result
        assert comparisons["response_torque"].difference.value == pytest.approx(share * rms)
        assert comparisons["response_torque"].margin == pytest.approx(0.01 * rms)
    assert "response_torque" not in found(model(response=now), model())[1]


def test_a_run_takes_the_torque_of_its_equation_of_motion():
    """Without friction the drive's feed-forward is all: J times the acceleration of two sines, behind the fade-in."""
    axis = AxisModel(AxisParameters(J, K_W, K_0))
    run = response(axis)
    assert (run.inertia, run.acceleration, len(run.torque)) == (J, 3.0 * K_0 / J, INSTANTS)
    assert response(AxisModel(AxisParameters(J, K_W, 1e-4))).acceleration == 50.0
    times = np.linspace(0.0, DURATION, INSTANTS + 1)[1:]
    expected = J * run.acceleration * (0.6 * np.cos(1.6 * np.pi * times) + 0.4 * np.cos(6.2 * np.pi * times))
    frictionless = response(AxisModel(AxisParameters(J)), run).torque
    assert frictionless[3:] == pytest.approx(expected[3:].tolist(), abs=2e-3 * J * run.acceleration)
    assert response(axis, run) == run
    heavier = np.array(response(AxisModel(AxisParameters(2.0 * J)), run).torque)  # but the drive is that of the first
    assert heavier[3:] == pytest.approx(2.0 * expected[3:], abs=0.6 * J * run.acceleration)
    assert np.abs(heavier[3:] - 2.0 * expected[3:]).max() > 0.05 * J * run.acceleration
