"""Current under limited voltage: closed forms of the winding, and the speed that voltage allows."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.voltage_limit import EFFECT
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from tests.effects.axes import AXIS, WINDING, model

STEP = 1e-3


def flowing(demand, before, velocity, voltage=40.0):
    values = {"voltage": np.array([voltage])}
    arrays = (np.array([float(value)]) for value in (velocity, demand * 0.7, before * 0.7))
    mean, end = EFFECT.flowing(values, model().axis, *arrays, STEP)
    return mean[0] / 0.7, end[0] / 0.7


def test_full_voltage_until_the_demand_is_reached():
    """At rest from zero: i = U/R*(1 - exp(-t/tau)), held once it is what is wanted."""
    tau = AXIS.inductance / AXIS.resistance
    reached = -tau * np.log(1.0 - 2.0 * 4.0 / 40.0)
    rising = 10.0 * (reached - tau * (1.0 - np.exp(-reached / tau)))
    assert flowing(2.0, 0.0, 0.0) == pytest.approx(((rising + 2.0 * (STEP - reached)) / STEP, 2.0))


def test_beyond_the_limit_current_tends_to_what_is_left():
    """The back-EMF of 50 rad/s leaves 5 V of 40, which is 1.25 A in the end."""
    tau = AXIS.inductance / AXIS.resistance
    end = 1.25 * (1.0 - np.exp(-STEP / tau))
    assert flowing(4.0, 0.0, 50.0)[1] == pytest.approx(end)
    assert flowing(-2.0, 0.0, 50.0)[1] == pytest.approx(-2.0)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_at_rest_all_of_the_voltage_drives_what_it_can(direction):
    """12 A through 4 ohm take more than 40 V: 10 A in the end."""
    tau = AXIS.inductance / AXIS.resistance
    end = 10.0 * (1.0 - np.exp(-STEP / tau))
    assert flowing(12.0 * direction, 0.0, 0.0)[1] == pytest.approx(end * direction)


def test_enough_voltage_changes_nothing_but_the_rise():
    assert flowing(2.0, 2.0, 10.0) == pytest.approx((2.0, 2.0))


def test_a_winding_without_inductance_jumps():
    effect = replace(model().axis, winding=replace(WINDING, inductance=0.0))
    one = np.ones(1)
    mean, end = EFFECT.flowing({"voltage": 40.0 * one}, effect, 0.0 * one, 0.7 * one, 0.0 * one, STEP)
    assert (mean[0], end[0]) == pytest.approx((0.7, 0.7))


def behind(standing, lack=10.0, below=30.0, samples=4000):
    """A recording whose last half falls behind its reference, at 36 V for a share of it and below for the rest.

    The first half, at a lower speed, takes more current.
    """
    time, half = 1e-3 * np.arange(samples), samples // 2
    needed, wanted = (np.repeat([first, last], half) for first, last in ((30.0, below), (20.0, 50.0)))
    needed[half : half + round(standing * half)] = 36.0
    speed = wanted - np.repeat([0.0, lack], half)
    current = (needed - WINDING.back_emf_constant * speed) / WINDING.resistance
    columns = {"time [s]": time, "velocity [rad/s]": speed, "current [A]": current}
    return Trace.from_arrays({**columns, "velocity_reference [rad/s]": wanted})


MOTOR = {"torque_constant": f"{AXIS.torque_constant} N*m/A", "resistance": f"{AXIS.resistance} ohm"}
RIG = Rig.of(
    {
        "name": "winding",
        "kind": "rotary",
        "motor": {**MOTOR, "back_emf_constant": f"{WINDING.back_emf_constant} V*s/rad", "peak_current": "8 A"},
    }
)


@pytest.mark.parametrize(("standing", "found"), [(0.53, True), (0.47, False)])
def test_the_voltage_stands_at_its_top_for_half_of_what_is_behind(standing, found):
    detected = EFFECT.detect(behind(standing), RIG, 1.5e-3)
    assert (detected is not None) == found
    assert detected is None or detected.values["voltage"] == pytest.approx(36.0, rel=1e-3)


@pytest.mark.parametrize(("below", "found"), [(36.0 * 0.957, True), (36.0 * 0.953, False)])
def test_within_an_eccentric_encoder_s_share_of_the_top_it_stands_there(below, found):
    assert (EFFECT.detect(behind(0.4, below=below), RIG, 1.5e-3) is not None) == found


@pytest.mark.parametrize(("lack", "found"), [(1.1, True), (0.9, False)])
def test_a_fiftieth_of_the_reference_is_behind(lack, found):
    assert (EFFECT.detect(behind(0.9, lack=lack), RIG, 1.5e-3) is not None) == found


def test_speed_beyond_its_reference_is_not_behind():
    assert EFFECT.detect(behind(0.9, lack=-10.0), RIG, 1.5e-3) is None


@pytest.mark.parametrize(("beyond", "found"), [(240, True), (280, False)])
def test_what_keeps_up_with_more_has_voltage_left(beyond, found):
    """2000 samples are behind; some of those that keep up take 38 V."""
    trace, more = behind(1.0), (38.0 - 30.0) / WINDING.resistance
    current = trace["current"] + np.where(np.arange(len(trace)) < beyond, more, 0.0)
    detected = EFFECT.detect(replace(trace, signals={**trace.signals, "current": current}), RIG, 1.5e-3)
    assert (detected is not None) == found


def test_a_drive_that_gives_all_of_its_current_has_voltage_enough():
    """All of M against a drag d: omega = w*tanh(t/T), w = sqrt(M/d), T = J/sqrt(M*d); it ends at one voltage, too."""
    torque, drag, inertia = 6.0 * AXIS.torque_constant, 1e-3, AXIS.inertia
    time = 1e-3 * np.arange(3000)
    speed = np.sqrt(torque / drag) * np.tanh(time * np.sqrt(torque * drag) / inertia)
    columns = {"time [s]": time, "velocity [rad/s]": speed, "current [A]": np.full(time.size, 6.0)}
    wanted = {"velocity_reference [rad/s]": np.minimum(200.0 * time, 1.2 * speed[-1])}
    assert EFFECT.detect(Trace.from_arrays({**columns, **wanted}), RIG, 1.5e-3) is None


def test_it_is_shown_from_the_rest_before_it_is_first_reached():
    """At rest until 1 s, then running up; 36 V are first needed at 2.5 s, for good."""
    time = 1e-3 * np.arange(8000)
    reference = np.where(time < 1.0, 0.0, 50.0)
    speed = np.interp(time, [1.0, 2.5], [0.0, 40.0])
    current = np.where(time < 2.5, 0.0, (36.0 - WINDING.back_emf_constant * speed) / WINDING.resistance)
    columns = {"time [s]": time, "velocity [rad/s]": speed, "current [A]": current}
    trace = Trace.from_arrays({**columns, "velocity_reference [rad/s]": reference})
    shown = EFFECT.shown_in(trace, RIG, {"voltage": 36.0})
    assert shown.time[[0, -1]] == pytest.approx([0.999, 3.999], abs=1.5e-3)
