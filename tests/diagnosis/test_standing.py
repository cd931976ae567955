"""What acts while the axis hardly moves or rests: where an event begins, what no friction is, and what nobody knows."""

import numpy as np
import pytest

from bench.diagnosis.diagnosis import diagnose
from bench.diagnosis.policy import Policy
from bench.diagnosis.search import physical_form
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from tests.diagnosis.constructed import (
    COULOMB,
    RIG,
    Motion,
    bare,
    moved,
    names,
    offset,
    only_during,
    recorded,
    searched,
    wave,
)

CREEP = 0.4  # rad/s, a hundredth of the other speeds


def held(start: float, stop: float, creep: float = CREEP) -> Motion:
    """A swing that creeps forward from one instant to another - s, rad/s."""
    whole = moved(6.0)
    pace = np.where((whole.time >= start) & (whole.time < stop), 0.0, whole.velocity)
    smooth = np.hanning(201) / np.hanning(201).sum()
    velocity = np.convolve(np.pad(pace, 100, mode="edge"), smooth, mode="valid") + creep
    acceleration = np.gradient(velocity, whole.time)
    return Motion(whole.time, np.cumsum(velocity) * 1e-3, velocity, acceleration, np.sign(velocity))


def test_an_event_begins_where_it_begins_however_long_the_axis_crept_before():
    """Rows where it creeps speak for no event, but where several windows differ there alone they decide."""
    trace = recorded(held(1.5, 3.2), only_during(0.06, 3.1, 3.9))
    found = searched(Policy(), trace, ["load_torque_event"]).last
    assert found.terms[0].shape == pytest.approx((3.1, 3.9), abs=5e-3)
    assert found.strengths(0)[0] == pytest.approx(0.06, rel=0.03)


def test_a_holdout_tells_when_an_event_began_while_the_axis_stood():
    """From 2.0 s on, and it stood from 1.5 to 3.2: a holdout that moves then does not speak against one from 3.2."""
    trace = recorded(held(1.5, 3.2, creep=0.0), only_during(0.06, 2.0, 3.9))
    holdout = recorded(moved(6.0), only_during(0.06, 2.0, 3.9), seed=1)
    assert names(Policy(), trace, ["load_torque_event"], holdout) == ("load_torque_event",)
    apart = recorded(moved(6.0), only_during(0.06, 0.5, 3.9), seed=1)
    assert names(Policy(), trace, ["load_torque_event"], apart) == ()


@pytest.mark.parametrize(("level", "named"), [(1.5, False), (4.0, True)])
def test_an_event_while_the_axis_creeps_is_what_no_static_friction_takes(level, named):
    """Beside Coulomb friction, of which static friction is three times as much at most."""
    trace = recorded(held(1.5, 3.2), only_during(level * COULOMB, 2.0, 2.6))
    found = searched(Policy(), trace, ["load_torque_event"]).last
    assert [term.effect.name for term in found.terms] == ["load_torque_event"] * named
    if named:
        assert found.terms[0].shape == pytest.approx((2.0, 2.6), abs=5e-3)


def test_an_offset_that_passed_for_friction_stays_an_offset_beside_a_later_name():
    """Beside much friction a constant torque is friction by direction; where a later name takes it, a load."""
    trace = recorded(moved(), offset(1.2 * COULOMB), wave(0.02, 7.0))
    effects = [catalogue()[name] for name in ("torque_offset", "direction_dependent_friction", "cogging_torque")]
    by_direction, cogging = Term(effects[1]), Term(effects[2], (7.0,))
    wrong = fit(bare(trace).rows, Hypothesis((by_direction, cogging)))
    assert not Policy().physical(wrong)
    assert physical_form(wrong, effects, Policy()).hypothesis.names == ("torque_offset", "cogging_torque")
    assert physical_form(wrong, effects[1:], Policy()) is wrong


def until(seconds, position, velocity, acceleration, after):
    """A motion over time that stops after so many seconds at a steady speed, and lasts 4 s more."""
    time = 1e-3 * np.arange(round((seconds + 4.0) * 1e3), dtype=np.float64)
    moving = time < seconds
    speed = np.where(moving, velocity(time), after)
    angle = np.where(moving, position(time), position(seconds) + after * (time - seconds))
    return Motion(time, angle, speed, np.where(moving, acceleration(time), 0.0), np.sign(speed))


def test_what_is_held_out_at_rest_judges_no_torque():
    """Six pushes in one direction over cogging, then rest."""
    w = 2.0 * np.pi
    pushed = until(
        6.0,
        lambda t: 30.0 * (t - np.sin(w * t) / w),
        lambda t: 30.0 * (1.0 - np.cos(w * t)),
        lambda t: 30.0 * w * np.sin(w * t),
        after=0.0,
    )
    trace = recorded(pushed, lambda motion: 0.03 * np.sin(6.0 * motion.position) * (motion.time < 6.0), noise=0.3)
    found = diagnose(trace, RIG)
    assert found.names == ["cogging_torque"]
    assert found.effects[0].parameters["harmonic"].value == 6


def test_where_an_axis_creeps_nothing_speaks_for_an_event():
    """Motion both ways, then 0.4 rad/s while friction takes a torque that is not its own."""
    a, b = 2.0 * np.pi, 6.6 * np.pi
    creeping = until(
        6.0,
        lambda t: -30.0 / a * np.cos(a * t) - 12.0 / b * np.cos(b * t),
        lambda t: 30.0 * np.sin(a * t) + 12.0 * np.sin(b * t),
        lambda t: 30.0 * a * np.cos(a * t) + 12.0 * b * np.cos(b * t),
        after=CREEP,
    )
    trace = recorded(creeping, only_during(0.05, 6.0, 10.0), noise=0.3).without("position")
    others = frozenset(catalogue()) - {"load_torque_event"}
    assert diagnose(trace, RIG, excluded=others).names == []
