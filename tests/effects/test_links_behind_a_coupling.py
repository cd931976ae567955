"""Links behind a soft or loose gear, on which known torque acts: against closed forms and an independent integrator."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.axis_kind import ROTARY
from bench.effects.dead_zone import dead_zone_columns
from bench.effects.elastic_coupling import EFFECT as ELASTIC
from bench.effects.present import Present
from bench.effects.signals import Signals
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.tracking import SoftTracking, run_free
from bench.trace.trace import Trace

PERIOD, MOTOR, LINK, WEIGHT = 1e-3, 0.01, 0.02, 1.2
TIME = PERIOD * np.arange(4000)
#: Of the motor - rad/s.
TURNING = 2.0 * np.pi * 0.8


def moving(weight=WEIGHT):
    """The motor swings about the place where its link hangs, and the link weighs."""
    angle, zero = 0.6 * np.sin(TURNING * TIME), np.zeros(TIME.size)
    speed = 0.6 * TURNING * np.cos(TURNING * TIME)
    sign = np.sign(speed)
    known, slope = ((weight * np.sin(angle), 0), (zero, 1)), weight * np.cos(angle)
    one = Signals(TIME, angle, speed, sign, zero, zero, sign, 1.0, PERIOD, "position")
    return replace(one, known=known, known_slope=slope, link_inertia=LINK)


def swelling(share):
    """The same link, whose inertia other joints change along the log, by a share, as its known momentum has it."""
    still, more = moving(), share * LINK * np.sin(2.0 * np.pi * 0.3 * TIME)
    return replace(still, known=(still.known[0], (more * still.velocity, 1)), known_inertia=more), LINK + more


def swinging(inertia, pushed):
    """Angle (n,) of a link of an inertia (n,) whose gear pushes it with a torque of twist and its rate, by SciPy."""
    rate = np.gradient(inertia, PERIOD)

    def slopes(t, state):
        twist = 0.6 * np.sin(TURNING * t) - state[0]
        faster = 0.6 * TURNING * np.cos(TURNING * t) - state[1]
        heavy, growing = np.interp(t, TIME, inertia), np.interp(t, TIME, rate)
        return state[1], (pushed(twist, faster) - WEIGHT * np.sin(state[0]) - growing * state[1]) / heavy

    start = [0.0, 0.6 * TURNING]
    return solve_ivp(slopes, (0.0, TIME[-1]), start, "LSODA", TIME, rtol=1e-9, atol=1e-11, max_step=2e-4).y[0]


def test_an_elastic_link_is_bent_by_its_weight():
    signals, frequency, damping = moving(), 2.0 * np.pi * 9.0, 0.1
    stiffness, loss = LINK * frequency**2, 2.0 * damping * LINK * frequency
    expected = (
        swinging(np.full(TIME.size, LINK), lambda twist, rate: stiffness * twist + loss * rate) - signals.position
    )
    ((bent, _), *_, (more, order)) = ELASTIC.columns(signals, (frequency, damping))[0]
    later = TIME > 1.0  # what the start rings has died away
    assert bent[later] == pytest.approx(expected[later], abs=2e-3 * np.abs(expected).max())
    assert order == 0
    assert LINK * more == pytest.approx(WEIGHT * np.cos(signals.position) * bent)


@pytest.mark.parametrize("stated", [0.5, 1.0, 2.0])
def test_what_a_link_has_more_in_its_known_torque_swings_with_it(stated):
    """A payload, of which the known torque has the motor's motion: it lags with the rest of the link."""
    signals, frequency, damping, gap = moving(), 2.0 * np.pi * 9.0, 0.1, 0.04
    more = np.full(TIME.size, (1.0 - stated) * LINK)
    (weight, _), _ = signals.known
    other = replace(
        signals, known=((weight, 0), (more * signals.velocity, 1)), known_inertia=more, link_inertia=stated * LINK
    )
    of_stated = np.sqrt(1.0 / stated)
    coupled = frequency * of_stated, damping * of_stated
    pairs = [(ELASTIC.columns(signals, (frequency, damping))[0], ELASTIC.columns(other, coupled)[0])]
    one, two = dead_zone_columns([signals], [(gap, 300.0, 0.4, 0.0)])[0], (gap, 300.0 * of_stated, 0.4 * of_stated, 0.0)
    pairs += zip(one, dead_zone_columns([other], [two])[0], strict=True)
    for expected, found in pairs:
        for (one, _), (two, _) in zip(expected, found, strict=True):
            assert stated * two[50:-50] == pytest.approx(one[50:-50], abs=1e-3 * np.abs(one).max())


def test_a_standing_elastic_link_starts_where_its_weight_bends_it():
    signals = replace(moving(), position=np.full(TIME.size, 0.5), velocity=np.zeros(TIME.size))
    known = ((np.full(TIME.size, 0.7), 0), (np.zeros(TIME.size), 1))
    (bent, _), *_ = ELASTIC.columns(replace(signals, known=known, known_slope=0.0), (60.0, 0.01))[0]
    assert bent == pytest.approx(-0.7 / (LINK * 60.0**2))


@pytest.mark.parametrize(("share", "near"), [(0.0, 0.02), (0.3, 0.05)])
def test_a_loose_link_falls_from_one_side_of_its_gap_to_the_other_as_slowly_as_it_is_heavy(share, near):
    (signals, inertia), gap, frequency, damping = swelling(share), 0.04, 300.0, 0.4

    def pushed(twist, rate):
        deep = twist - np.clip(twist, -0.5 * gap, 0.5 * gap)
        return LINK * (frequency**2 * deep + 2.0 * damping * frequency * rate * (deep != 0.0))

    expected = swinging(inertia, pushed) - signals.position
    (((loose, _), *_),) = dead_zone_columns([signals], [(gap, frequency, damping, 0.0)])[0]
    assert np.abs(loose * LINK / inertia - expected)[TIME > 0.3].max() < near * gap


def test_the_motor_feels_the_inertia_that_the_link_has():
    signals, inertia = swelling(0.05)
    stiffness, loss = LINK * (2.0 * np.pi * 9.0) ** 2, 0.3

    def pushed(twist, rate):
        return stiffness * twist + loss * rate

    expected = swinging(inertia, pushed) - signals.position
    torque = pushed(-expected, -np.gradient(expected, PERIOD))
    column = ELASTIC.columns(signals, (2.0 * np.pi * 9.0, loss / (2.0 * LINK * 2.0 * np.pi * 9.0)))[0]
    felt = LINK * np.gradient(signals.velocity, PERIOD) + signals.carried
    for values, order in column:
        for _ in range(order):
            values = np.gradient(values, PERIOD)
        felt = felt + LINK * values
    assert np.abs(felt - torque)[1000:-10].max() < 0.02 * np.abs(torque).max()


@pytest.mark.parametrize("gap", [0.0, 0.04])
def test_a_link_starts_on_the_flank_on_which_it_lies(gap):
    signals, frequency = replace(moving(), position=np.full(TIME.size, 0.5), velocity=np.zeros(TIME.size)), 300.0
    known = ((np.full(TIME.size, 0.7), 0), (np.zeros(TIME.size), 1))
    (((loose, _), *_),) = dead_zone_columns([replace(signals, known=known)], [(gap, frequency, 0.4, 0.0)])[0]
    assert loose == pytest.approx(-0.5 * gap - 0.7 / (LINK * frequency**2), abs=0.01 * (gap + 1e-3))


@pytest.mark.parametrize("drag", [0.0, 1e-4])
def test_the_held_model_has_known_torque_on_its_link(drag):
    """Free for half a second, native or stepped: two masses integrated by SciPy."""
    stiffness, loss, pull = 80.0, 0.05, 0.6 * np.sin(9.0 * TIME)
    effort = 0.8 * np.cos(5.0 * TIME)

    def slopes(t, state):
        motor, ahead, speed, rate = state
        through = stiffness * (motor - ahead) + loss * (speed - rate)
        driving = 0.8 * np.cos(5.0 * t) - drag * speed * abs(speed) - through
        return speed, rate, driving / MOTOR, (through - 0.6 * np.sin(9.0 * t)) / LINK

    true = solve_ivp(slopes, (0.0, TIME[-1]), np.zeros(4), "LSODA", TIME, rtol=1e-9, atol=1e-11).y
    effects = [Present.of("elastic_coupling", {"stiffness": stiffness, "damping": loss})]
    if drag:
        effects.append(Present.of("quadratic_drag", {"quadratic_drag": drag}))
    model = AxisModel(AxisParameters(MOTOR + LINK, 0.0, 0.0, 0.0, MOTOR, ROTARY), tuple(effects))
    units = {"position": "rad", "velocity": "rad/s"}
    trace = Trace(TIME, {"position": true[0], "velocity": true[2]}, units, "log")
    held = SoftTracking(model, trace, effort, known=pull)
    (found,) = run_free(held, [slice(0, 500)])
    assert found.velocity == pytest.approx(true[2, :500], abs=0.01 * np.abs(true[2, :500]).max())
