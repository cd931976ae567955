"""What the search takes up, exchanges and drops, on recordings whose truth is constructed."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.diagnosis import diagnose
from bench.diagnosis.policy import Policy, freedom, worth
from bench.diagnosis.probability import BESIDE_NOISE, Contender
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.search import LIMIT, search, without_impossible
from bench.effects.catalogue import catalogue
from bench.errors import UndeterminedError
from bench.fit.fit import fit
from bench.fit.hypothesis import Term
from bench.fit.rows import Rows
from bench.trace.trace import Trace
from tests.diagnosis.constructed import (
    COULOMB,
    INERTIA,
    RIG,
    SINES,
    UNITS,
    bare,
    likely,
    moved,
    names,
    offset,
    recorded,
    searched,
    sought,
    vibration,
    wave,
)
from tests.diagnosis.off import without

POLICY = Policy()
MOTION = moved(4.0)
WAVES = ("cogging_torque", "torque_ripple", "unbalance", "quadratic_drag", "stribeck_friction")


@pytest.mark.parametrize("seed", [3, 11])
def test_noise_that_takes_its_share_by_chance_is_not_named(seed):
    """Where no effect is, nothing is more than chance: no set of effects is visited at all."""
    without_effect, few = bare(recorded(moved(3.0), seed=seed)), [catalogue()[name] for name in WAVES]
    assert search(without_effect, few, POLICY).visited == (without_effect,)
    assert len(search(without_effect, few, without("by_chance")).visited) > 1


@pytest.mark.parametrize("seed", [0, 1])
def test_what_only_damps_noise_of_the_motion_is_no_coupling(seed):
    """Sines of an encoder, interpolated with an error: a load behind a coupling does not follow it, so squares fall."""
    rng, motion = np.random.default_rng(seed), moved(4.0)
    position = motion.position + 3e-4 * np.sin(256.0 * motion.position) + 1e-6 * rng.normal(size=motion.time.size)
    signals = {"position": position, "current": recorded(motion, seed=seed)["current"]}
    trace = Trace(motion.time, signals, {name: UNITS[name] for name in signals}, "interpolated")
    assert sought(POLICY, trace, ["elastic_coupling"]) == ()
    assert sought(without("only_damps"), trace, ["elastic_coupling"]) == ("elastic_coupling",)


def coupled(share, antiresonance, damping):
    """What a load that is joined by a spring takes more than a rigid one, sine by sine by its transfer function."""

    def torque(motion):
        more = np.zeros_like(motion.time)
        for amplitude, frequency, phase in SINES:
            omega = 2.0 * np.pi * frequency
            s = 1j * omega / antiresonance
            beyond = (1.0 + 2.0 * damping * s) / (1.0 + 2.0 * damping * s + s**2) - 1.0
            turning = np.exp(1j * (omega * motion.time + phase))
            more -= share * INERTIA * amplitude * omega**2 * np.imag(beyond * turning)
        return more

    return torque


def test_a_coupling_beside_something_else_is_no_gap():
    """Where the coupling leaves a remainder a dead zone is tried in its place; its gap is less than contacts yield."""
    trace, effects = recorded(MOTION, coupled(0.6, 100.0, 0.1), vibration(0.02, 11.0)), ["elastic_coupling", "backlash"]
    assert "backlash" not in names(POLICY, trace, effects)


def test_what_no_effect_explains_is_reported():
    trace = recorded(MOTION, vibration(0.01, 3.3))
    others = frozenset(catalogue()) - {"unbalance"}
    found, less = (diagnose(trace, RIG, excluded=others, policy=policy) for policy in (POLICY, without("remains")))
    assert found.verdict == "unexplained_remainder"
    assert [any(one.criterion == "residual" for one in each.objections) for each in (found, less)] == [True, False]


def test_noise_alone_is_no_remainder():
    others = frozenset(catalogue()) - {"unbalance"}
    assert {diagnose(recorded(MOTION, seed=k), RIG, excluded=others).verdict for k in range(3)} == {"nothing_missing"}


def test_rows_that_a_gap_does_not_determine_are_not_saved():
    """A gap that the axis does not have excludes rows near its impacts: their squares are not explained by it."""
    without = bare(recorded(MOTION, coupled(0.6, 100.0, 0.1), vibration(0.02, 11.0)))
    gap = fit(without.rows, without.hypothesis.plus(Term(catalogue()["backlash"], (0.03, 200.0, 0.2, 0.0))))
    sure = gap.determined
    assert not sure.all()
    saved = float(np.sum(without.left[sure] ** 2) - np.sum(gap.left[sure] ** 2))
    assert worth(without, gap) == pytest.approx(saved)
    assert without.squares - gap.squares > 3.0 * saved


def test_a_search_that_its_limit_ends_says_so():
    trace = recorded(MOTION, wave(0.05, 6.0), offset(0.05))
    effects = [catalogue()[name] for name in ("torque_offset", "cogging_torque")]
    cut = search(bare(trace), effects, POLICY, most=1)
    assert (len(cut.last.terms), cut.stopped) == (1, LIMIT)
    whole = search(bare(trace), effects, POLICY, most=2)
    assert (set(whole.last.hypothesis.names), whole.stopped) == ({"torque_offset", "cogging_torque"}, None)


def test_shapes_count_as_numbers_however_they_were_searched():
    """A gap of load, width, frequency and damping of the contact is no cheaper than a lag and a wave together."""
    bare = fit_bare(Rows.of(recorded(MOTION), RIG))
    gap, lag = Term(catalogue()["backlash"], (0.05, 400.0, 0.3, 0.0)), Term(catalogue()["current_loop_lag"], (0.004,))
    wave_of_six = Term(catalogue()["cogging_torque"], (6.0,))
    numbers = [freedom(fit(bare.rows, bare.hypothesis.plus(term))) - freedom(bare) for term in (gap, lag, wave_of_six)]
    assert numbers == [4, 1, 2]


def test_the_policy_decides_whether_a_recording_suffices():
    """What counts as chance decides, too, whether effects would be visible in the noise of a recording."""
    trace = recorded(MOTION, noise=3.0)
    assert Recordings.of(trace, RIG, None, POLICY).rows.effort.size
    with pytest.raises(UndeterminedError, match="would exceed the noise"):
        diagnose(trace, RIG, policy=Policy(chance=1e5))


ECCENTRICITY, PHASE = 0.03, 0.8


def drag(motion):
    return 1e-4 * motion.velocity * np.abs(motion.velocity)


@pytest.fixture(scope="module")
def eccentric():
    """The bare axis where the encoder errs by e*sin(q + phi)."""
    motion = moved()
    trace = recorded(motion)
    error = ECCENTRICITY * np.sin(motion.position + PHASE)
    rate = ECCENTRICITY * np.cos(motion.position + PHASE) * motion.velocity
    signals = {
        **trace.signals,
        "position": trace.signals["position"] + error,
        "velocity": trace.signals["velocity"] + rate,
    }
    return bare(replace(trace, signals=signals))


def test_what_makes_up_for_a_bent_shape_is_not_kept(eccentric):
    """An inertia over position takes what an eccentric encoder leaves whose shape is bent to it."""
    effects = [catalogue()[name] for name in ("position_dependent_inertia", "encoder_eccentricity", "torque_offset")]
    found = search(eccentric, effects, Policy()).last
    assert found.hypothesis.names == ("encoder_eccentricity",)
    true = ECCENTRICITY * np.cos(PHASE), ECCENTRICITY * np.sin(PHASE)
    assert found.terms[0].shape == pytest.approx(true, rel=0.02)


def test_of_several_near_effects_those_are_found_that_leave_noise():
    effects = "quadratic_drag", "cogging_torque", "stribeck_friction", "torque_offset"
    found = searched(Policy(), recorded(moved(), drag, wave(0.02, 7.0)), effects).last
    assert sorted(found.hypothesis.names) == ["cogging_torque", "quadratic_drag"]
    assert found.chi < 1.1


def test_each_effect_is_tried_in_the_place_of_another():
    """A slow axis' torque is friction: a wave of it hardly differs from a wave of torque."""
    trace = recorded(
        moved(20.0, ((6.0, 0.1, 0.3),)), lambda motion: 0.2 * COULOMB * np.sin(motion.position) * motion.sign
    )
    found = likely(Policy(), trace, ["torque_ripple", "position_dependent_friction"]).names
    assert 0.1 < found["position_dependent_friction"] < 0.9
    assert 0.1 < found["torque_ripple"] < 0.9


def test_a_result_is_weighed_against_itself_without_each_of_its_effects():
    trace = recorded(moved(), wave(0.03, 3.0), drag)
    found = searched(Policy(), trace, ["cogging_torque", "quadratic_drag"])
    assert sorted(found.last.hypothesis.names) == ["cogging_torque", "quadratic_drag"]
    assert any(not fitted.terms for fitted in found.visited)
    assert not next(iter(found.shares))


def test_a_pair_of_which_neither_explains_much_alone_is_found():
    """Two waves that cancel each other in most of a short travel: each alone takes little."""
    short = moved(6.0, ((1.2, 0.43, 0.3), (0.4, 1.31, 1.1), (0.1, 2.9, 2.0)))
    trace = recorded(short, lambda motion: 0.06 * motion.position, wave(-0.066, 1.0))
    found = searched(Policy(), trace, ["torsion_spring", "unbalance", "torque_offset", "quadratic_drag"]).last
    assert sorted(found.hypothesis.names) == ["torsion_spring", "unbalance"]
    assert found.chi < 1.1


def test_decoys_are_visited_and_never_the_result():
    trace = recorded(moved(2.0), lambda motion: 0.05 * np.sin(2.0 * np.pi * 3.3 * motion.time))
    found = searched(Policy(), trace, ["torsion_spring", "cogging_torque", "load_torque_event"])
    decoys = [fitted for fitted in found.visited if any(term.effect.decoy for term in fitted.terms)]
    assert any(fitted.chi < 1.1 for fitted in decoys)
    assert not any(term.effect.decoy for term in found.last.terms)


def test_what_the_last_effect_makes_impossible_leaves():
    """A spring that pushes away from its reference is none; with the wave that is there, none is needed."""
    motion = moved()
    pushed = bare(recorded(motion, wave(0.02, 7.0), lambda motion: -1e-3 * motion.position))
    spring, cogging = (catalogue()[name] for name in ("torsion_spring", "cogging_torque"))
    both = fit(pushed.rows, pushed.hypothesis.with_terms([Term(spring), Term(cogging, (7.0,))]))
    assert not Policy().physical(both)
    assert without_impossible(both, Policy()).hypothesis.names == ("cogging_torque",)


@pytest.mark.parametrize(("residual", "remains"), [(1.11, False), (1.13, True)])
def test_more_than_noise_remains_from_1_12_times_the_noise_of_the_best_set_on(residual, remains):
    over = float(np.log1p((residual**2 - 1.0) / BESIDE_NOISE))
    assert Contender(bare(recorded(moved())), 0.0, over, 0.0, 0, outside=False).remains(Policy()) is remains
