"""What an effect takes for itself, and what it does not: each border from both sides, by the sentence behind it."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.effect import Coupling
from bench.effects.signals import Axis
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from tests.effects.recording import SCOPES

#: 8 s, through a filter of 2 ms, over a travel of 60 rad, at 100 rad/s at most.
SCOPE = replace(SCOPES[0], duration=8.0, width=2e-3, travel=60.0, top_speed=100.0, one_way=False)
BASE = Axis(inertia=1e-3, viscous=8e-4, coulomb=0.05)


def effect(name):
    return catalogue()[name]


@pytest.mark.parametrize(
    ("name", "strengths", "shapes"),
    [
        ("torque_constant_drift", ([0.0374], [0.0376]), ((), ())),  # 0.3 over 8 s
        ("torque_constant_drift", ([-0.0374], [-0.0376]), ((), ())),
        ("current_gain_asymmetry", ([0.0999], [0.1001]), ((), ())),  # two shunts of 5 %
        ("current_gain_asymmetry", ([-0.0999], [-0.1001]), ((), ())),
        ("stribeck_friction", ([0.08], [0.08]), ((19.9,), (20.1,))),  # a rise within a fifth of the top speed
        ("presliding_friction", ([0.05, 0.0],) * 2, ((10.01 / 60.0,), (9.99 / 60.0,))),  # ten times the travel
        ("load_torque_event", ([0.1],) * 2, ((1.0, 1.00472), (1.0, 1.0047))),  # 2.355 widths
        ("load_torque_event", ([0.1],) * 2, ((1.0, 5.79), (1.0, 5.81))),  # 0.6 of 8 s
        # 0.005 of what 6 N*m bend 1e3 N*m/rad
        ("backlash", ([1e-3],) * 2, ((3.01e-5, 1e3, 0.2, 0.0), (2.99e-5, 1e3, 0.2, 0.0))),
    ],
)
def test_plausible(name, strengths, shapes):
    verdicts = [effect(name).plausible([s], [shape], SCOPE) for s, shape in zip(strengths, shapes, strict=True)]
    assert verdicts == [True, False]
    assert not effect(name).plausible(strengths, shapes, SCOPE)


@pytest.mark.parametrize(
    ("name", "inside", "outside", "shape"),
    [
        ("load_dependent_friction", [0.699], [0.701], ()),  # torque would explain itself
        ("presliding_friction", [0.0251, 0.0], [0.0249, 0.0], (20.0,)),  # Coulomb friction within a factor of two
        ("presliding_friction", [0.0999, 0.0], [0.1001, 0.0], (20.0,)),
        ("elastic_coupling", [2.01e-5], [1.99e-5], (100.0, 0.1)),  # 0.02 to 0.98 of the inertia behind it
        ("elastic_coupling", [9.79e-4], [9.81e-4], (100.0, 0.1)),
        ("backlash", [2.01e-5], [1.99e-5], (0.02, 1257.0, 0.2, 0.0)),
        ("stribeck_friction", [1e-6], [-1e-6], (5.0,)),
        ("friction_warmup", [1e-6, 0.0], [-1e-6, 0.0], (3.0,)),
        ("torque_constant_saturation", [0.333], [0.334], ()),  # torque rises with current up to the peak
        ("position_dependent_friction", [0.0749, 0.0], [0.0751, 0.0], ()),  # 1.5 of Coulomb friction
        ("direction_dependent_friction", [0.0999, 0.0], [0.1001, 0.0], ()),  # of either direction: 0 to twice K_0
        ("position_dependent_inertia", [0.0, 0.999e-3], [0.0, 1.001e-3], (2.0,)),
    ],
)
def test_physical(name, inside, outside, shape):
    assert effect(name).physical(inside, shape, BASE)
    assert not effect(name).physical(outside, shape, BASE)


@pytest.mark.parametrize(("rise", "coulomb", "sure"), [(0.08, 0.06, True), (0.08, 0.0, False), (0.0, 0.06, False)])
def test_a_rise_is_one_of_dry_friction_that_there_is_at_any_speed(rise, coulomb, sure):
    assert effect("stribeck_friction").physical([rise], [5.0], Axis(1e-3, 0.0, coulomb)) is sure


def test_a_coupling_rings_and_one_that_hardly_does_is_passed_through_only():
    elastic = effect("elastic_coupling")
    assert isinstance(elastic, Coupling)
    assert elastic.physical([5e-4], (100.0, 0.99), BASE)
    assert not elastic.physical([5e-4], (100.0, 1.01), BASE)
    assert elastic.credible((100.0, 0.49))
    assert not elastic.credible((100.0, 0.51))


@pytest.mark.parametrize(
    ("name", "share"),
    [
        ("torque_offset", 0.0),
        ("current_offset_drift", 0.8),  # above 3/4, which of a constant torque time takes
        ("torque_constant_drift", 0.85),  # above 27/32, which of a change at half time it takes
    ],
)
def test_share_that_an_effect_needs_as_others_imitate_it(name, share):
    assert effect(name).needed == share


RIG = Rig.of(
    {
        "name": "lag",
        "kind": "rotary",
        "motor": {"torque_constant": "0.8 N*m/A", "peak_current": "8 A", "rotor_inertia": "5e-4 kg*m**2"},
    }
)


def lagging(lag, noise=0.0, other=0.0):
    """A sine of 3 Hz whose reported speed lags by a time, and errs by another sine of its own."""
    time, omega = 1e-3 * np.arange(8000), 2.0 * np.pi * 3.0
    position = 20.0 / omega * np.sin(omega * time)
    velocity = 20.0 * np.real(np.exp(1j * omega * time) / (1.0 + 1j * omega * lag))
    velocity += other * np.sin(0.37 * omega * time)
    rng = np.random.default_rng(5)
    signals = {
        "position": position + 1e-6 * rng.normal(size=8000),
        "velocity": velocity + noise * rng.normal(size=8000),
    }
    return Trace(time, signals, {"position": "rad", "velocity": "rad/s"}, "a sine")


@pytest.mark.parametrize(("lag", "found"), [(0.65e-3, True), (0.55e-3, False)])
def test_a_lag_shorter_than_0_6_samples_is_how_a_drive_differences(lag, found):
    assert (effect("velocity_filter_lag").detect(lagging(lag, 1e-3), RIG, 1.5e-3) is not None) == found


@pytest.mark.parametrize(("share", "found"), [(0.72, True), (0.68, False)])
def test_a_lag_explains_seven_tenths_of_the_disagreement(share, found):
    """RMS of the lag's part: 20*omega*T/sqrt(2); what else disagrees has (1 - share)/share of its squares."""
    lag = 2e-3
    part = 20.0 * 2.0 * np.pi * 3.0 * lag
    other = part * np.sqrt((1.0 - share) / share)
    assert (effect("velocity_filter_lag").detect(lagging(lag, 1e-3, other), RIG, 1.5e-3) is not None) == found
