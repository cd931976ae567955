"""What is named of torques that a test adds: no more than the search takes up, and often less, as something else is
likelier. The truth may be no effect, or one that the search may not try.
"""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from bench.diagnosis.policy import Policy
from bench.effects.catalogue import catalogue
from bench.effects.effect import Coupling
from bench.fit.rows import Rows
from tests.diagnosis.constructed import (
    COULOMB,
    RIG,
    SINES,
    VISCOUS,
    judged,
    likely,
    moved,
    named,
    names,
    offset,
    only_during,
    recorded,
    searched,
    vibration,
    wave,
)
from tests.diagnosis.off import without

POLICY = Policy()
LONG, MOTION = moved(), moved(4.0)
OTHER = moved(4.0, sines=tuple((amplitude, 1.1 * f, phase + 1.0) for amplitude, f, phase in SINES))
#: The same motion in less than a revolution each way, twice as fast.
SHORT_STROKE = moved(4.0, sines=tuple((0.4 * amplitude, 2.0 * f, phase) for amplitude, f, phase in SINES))
EVENT = ("load_torque_event",)
RIGID = [name for name, effect in catalogue().items() if not isinstance(effect, Coupling)]
FEW = ("cogging_torque", "quadratic_drag", "stribeck_friction")
FRICTION = ("direction_dependent_friction", "torque_offset")
#: Each of seven waves takes a seventh of the residual, less than its two numbers cost by themselves.
NUMBERS = (3.0, 5.0, 7.0, 9.0, 11.0, 13.0, 16.0)
SEVEN = [wave(0.02, number) for number in NUMBERS]


def spring(motion):
    return 0.01 * motion.position


def drag(motion):
    return 1e-4 * motion.velocity * np.abs(motion.velocity)


def stribeck(motion):
    return 0.06 * motion.sign * np.exp(-((motion.velocity / 4.0) ** 2))


def bump(motion):
    return 0.06 * np.exp(-0.5 * (np.angle(np.exp(1j * motion.position)) / 0.5) ** 2)


def wandering(torque, seed=7):
    """A torque of that RMS - N*m - that changes at random within a tenth of a second or so."""
    wander = gaussian_filter1d(np.random.default_rng(seed).normal(size=MOTION.time.size), 120)
    return lambda motion: torque * (wander - wander.mean()) / wander.std()


def friction_beyond(level):
    """More in one direction than the other, by a constant and by a little that goes with speed."""
    return lambda motion: level * COULOMB + 0.3 * VISCOUS * np.abs(motion.velocity)


#: Motion, torques, what the search may try, and what is named.
NAMED = {
    "a name that explains another part is not contested": (
        LONG, [vibration(0.02, 0.9), wave(0.06, 6.0)], RIGID, {"cogging_torque"},
    ),
    "two waves of one period stay where no single one replaces them": (
        MOTION, [lambda m: 0.3 * m.sign * 0.08 * np.sin(m.position), wave(0.06, 1.0, 1.0)], RIGID,
        {"position_dependent_friction", "unbalance"},
    ),
    "waves of several numbers are a series": (
        LONG, [wave(0.03, 1.0), wave(0.03, 6.0, 1.0), wave(0.03, 12.0, 2.0)], RIGID, {"unbalance", "cogging_torque"},
    ),
    "friction that differs by more than a constant is no offset": (
        MOTION, [lambda m: 0.05 + 5e-4 * np.abs(m.velocity)], RIGID, {"direction_dependent_friction"},
    ),
    "what is beyond friction is a load": (LONG, [friction_beyond(1.5)], FRICTION, {"torque_offset"}),
    "friction may differ by half of itself": (
        LONG, [friction_beyond(0.5)], FRICTION, {"direction_dependent_friction"},
    ),
    "half of what wanders may pass for an event and is none": (MOTION, [wandering(0.1)], RIGID, set()),
    "a spring and two cycles look like an unbalance until both are there": (
        SHORT_STROKE, [lambda m: 0.02 * m.position, wave(0.04, 2.0)],
        ["torsion_spring", "unbalance", "cogging_torque", "torque_offset"], {"torsion_spring", "cogging_torque"},
    ),
    "six effects, of which an offset is the reference of the spring": (
        MOTION, [wave(0.04, 6.0, 0.3), wave(0.06, 1.0, 1.0), offset(0.05), stribeck, spring, drag], RIGID,
        {"cogging_torque", "quadratic_drag", "stribeck_friction", "torsion_spring", "unbalance"},
    ),
    "an event shorter than the filter resolves": (LONG, [only_during(0.5, 2.0, 2.004)], EVENT, set()),
    "an event that the filter resolves": (LONG, [only_during(0.5, 2.0, 2.04)], EVENT, {*EVENT}),
}  # fmt: skip


@pytest.mark.parametrize("case", NAMED)
def test_what_is_named(case):
    motion, torques, may, expected = NAMED[case]
    assert {*names(POLICY, recorded(motion, *torques), may)} == expected


#: The same where nothing is named that the search takes up, and the rule without which it does.
TAKEN_UP = {
    "a vibration in step with the motion is no spring": (
        LONG, [vibration(0.05, 0.43)], RIGID, None, {"torsion_spring"},
    ),
    "a wave of acceleration is no ripple": (
        LONG, [lambda m: 2e-4 * m.acceleration * np.sin(3.0 * m.position)],
        [name for name in RIGID if name != "position_dependent_inertia"], None, {"torque_ripple"},
    ),
    "a wave that goes with the square of speed is not two": (
        MOTION, [lambda m: 5e-5 * m.velocity**2 * np.sin(2.0 * m.position + 0.7)], RIGID, None,
        {"position_dependent_inertia", "torque_ripple"},
    ),
    "a bump at one angle is no series of waves": (LONG, [bump], RIGID, None, {"cogging_torque"}),
    "a torque that drives the axis is no drag": (
        MOTION, [lambda m: -5e-5 * m.velocity * np.abs(m.velocity)], ["quadratic_drag"], "physical", {"quadratic_drag"},
    ),
    "a jolt at the start is no warm-up": (
        MOTION, [lambda m: 3.0 * np.exp(-m.time / 0.05) * np.sign(m.velocity)], ["friction_warmup"], "physical",
        {"friction_warmup"},
    ),
    "small effects beside a remainder": (MOTION, [*SEVEN, vibration(0.05, 3.3)], FEW, None, set()),
}  # fmt: skip


@pytest.mark.parametrize("case", TAKEN_UP)
def test_what_the_search_takes_up_is_not_named(case):
    motion, torques, may, rule, up = TAKEN_UP[case]
    trace = recorded(motion, *torques)
    found = searched(POLICY, trace, may)
    assert named(judged(found, POLICY)) == ()
    ends = found if rule is None else searched(without(rule), trace, may)
    assert up <= {*ends.last.hypothesis.names}


def test_many_small_effects_are_named_that_explain_it_together():
    found = searched(POLICY, recorded(MOTION, *SEVEN), FEW).last
    assert sorted(term.shape[0] for term in found.terms) == [*NUMBERS]
    assert found.chi < 1.1


def test_friction_that_differs_by_a_constant_is_an_offset():
    """Of one number, where a difference has two."""
    found = searched(POLICY, recorded(MOTION, offset(0.05)), RIGID)
    assert named(judged(found, POLICY)) == found.last.hypothesis.names == ("torque_offset",)


def test_of_names_beside_a_large_remainder_an_event_goes_first():
    """Most of the torque is cogging; what wanders beside it speaks against an event, and not against cogging."""
    kept = names(POLICY, recorded(MOTION, wandering(0.06), wave(0.3, 6.0)), RIGID)
    assert "cogging_torque" in kept
    assert "load_torque_event" not in kept


@pytest.mark.parametrize(("during", "expected"), [(None, EVENT), ((1.0, 1.5), EVENT), ((2.5, 3.0), ())])
def test_an_event_may_be_lacking_in_the_holdout_or_at_its_time_and_at_no_other(during, expected):
    trace = recorded(MOTION, only_during(0.08, 1.0, 1.5))
    holdout = recorded(OTHER, *([] if during is None else [only_during(0.08, *during)]), seed=1)
    assert names(POLICY, trace, EVENT, holdout) == expected


def test_a_spring_that_is_not_hookes_gets_no_name():
    """A torque that bends over the travel, as of a cable: nearest is friction by direction, or an event."""
    trace = recorded(LONG, lambda motion: 0.06 * np.cos(0.16 * motion.position))
    found = likely(POLICY, trace, ["direction_dependent_friction", "current_offset_drift", "load_torque_event"])
    assert found.none > 0.9


def test_the_shortest_event_is_that_of_the_filter():
    """Of 4 ms through a filter of 2 ms, torque and duration are one number: a larger one, half as long, looks alike."""
    assert 0.004 < 2.355 * Rows.of(recorded(LONG), RIG).conditioning.filter.width < 0.04
