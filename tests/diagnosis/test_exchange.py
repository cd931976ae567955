"""The search leaves a wrong first effect: it exchanges it, drops it, and weighs what else may be present."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import BESIDE_NOISE, Contender
from bench.diagnosis.search import search, without_impossible
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Term
from tests.diagnosis.constructed import COULOMB, bare, likely, moved, recorded, searched, wave

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
