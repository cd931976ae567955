"""What acts while the axis hardly moves: where an event begins, what no friction is, and what nobody knows."""

import numpy as np
import pytest

from bench.diagnosis.policy import Policy
from bench.diagnosis.search import physical_form, search
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from tests.diagnosis.constructed import (
    COULOMB,
    VISCOUS,
    Motion,
    bare,
    likely,
    moved,
    names,
    offset,
    only_during,
    recorded,
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
    found = search(bare(trace), [catalogue()["load_torque_event"]], Policy()).last
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
    found = search(bare(trace), [catalogue()["load_torque_event"]], Policy()).last
    assert [term.effect.name for term in found.terms] == ["load_torque_event"] * named
    if named:
        assert found.terms[0].shape == pytest.approx((2.0, 2.6), abs=5e-3)


@pytest.mark.parametrize(("level", "name"), [(1.5, "torque_offset"), (0.5, "direction_dependent_friction")])
def test_friction_never_drives(level, name):
    """What is beyond friction is a load: with it as a difference one direction would have none left."""
    trace = recorded(moved(), lambda motion: level * COULOMB + 0.3 * VISCOUS * np.abs(motion.velocity))
    assert names(Policy(), trace, ["direction_dependent_friction", "torque_offset"])[0] == name


def test_a_spring_that_is_not_hookes_gets_no_name():
    """A torque that bends over the travel, as of a cable: nearest is friction by direction, or an event."""
    trace = recorded(moved(), lambda motion: 0.06 * np.cos(0.16 * motion.position))
    found = likely(Policy(), trace, ["direction_dependent_friction", "current_offset_drift", "load_torque_event"])
    assert found.none > 0.9


def test_an_offset_that_passed_for_friction_stays_an_offset_beside_a_later_name():
    """Beside much friction a constant torque is friction by direction; where a later name takes it, a load."""
    trace = recorded(moved(), offset(1.2 * COULOMB), wave(0.02, 7.0))
    effects = [catalogue()[name] for name in ("torque_offset", "direction_dependent_friction", "cogging_torque")]
    by_direction, cogging = Term(effects[1]), Term(effects[2], (7.0,))
    wrong = fit(bare(trace).rows, Hypothesis((by_direction, cogging)))
    assert not Policy().physical(wrong)
    assert physical_form(wrong, effects, Policy()).hypothesis.names == ("torque_offset", "cogging_torque")
    assert physical_form(wrong, effects[1:], Policy()) is wrong
