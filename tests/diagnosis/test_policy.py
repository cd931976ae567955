"""Every rule of the search decides somewhere: with it the outcome is right, with the rule off it is another."""

import numpy as np
import pytest

from bench.diagnosis import policy as rules
from bench.diagnosis import search as searching
from bench.diagnosis.diagnosis import diagnose
from bench.diagnosis.policy import Policy, freedom, worth
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.search import LIMIT, candidates, search
from bench.effects import backlash
from bench.effects.catalogue import catalogue
from bench.errors import UndeterminedError
from bench.fit.fit import fit
from bench.fit.hypothesis import Term
from bench.fit.rows import Rows
from bench.report.verdict import reasons
from bench.trace.trace import Trace
from tests.diagnosis.constructed import (
    INERTIA,
    RIG,
    SINES,
    UNITS,
    bare,
    moved,
    names,
    offset,
    recorded,
    sought,
    vibration,
    wave,
)
from tests.diagnosis.off import without

POLICY = Policy()
MOTION = moved(4.0)
#: The same motion in less than a revolution each way, twice as fast.
SHORT_STROKE = moved(4.0, sines=tuple((0.4 * amplitude, 2.0 * f, phase) for amplitude, f, phase in SINES))
WAVES = ("cogging_torque", "torque_ripple", "unbalance", "quadratic_drag", "stribeck_friction")


def test_no_shape_is_searched_where_the_grid_promises_nothing(monkeypatch):
    """Promising spares work: beside noise alone no shape of any effect is searched."""
    asked, refined = [], searching.refined
    monkeypatch.setattr(searching, "refined", lambda current, term: asked.append(term) or refined(current, term))
    null, few = bare(recorded(MOTION)), [catalogue()[name] for name in WAVES]
    assert search(null, few, POLICY).last is null
    assert asked == []
    search(null, few, without("promises", finalists=99))
    assert len(asked) == len(few)


def test_a_significant_part_of_something_else_is_not_named():
    trace = recorded(MOTION, vibration(0.05, 3.3))
    assert sought(POLICY, trace, WAVES[:3]) == ()
    assert sought(without("accepts"), trace, WAVES[:3]) != ()


@pytest.mark.parametrize("seed", [3, 11])
def test_noise_that_takes_its_share_by_chance_is_not_named(seed):
    """Where no effect is, a quarter of almost nothing above the floor is soon explained."""
    trace = recorded(moved(3.0), seed=seed)
    assert names(POLICY, trace, WAVES) == ()
    assert sought(without("by_chance"), trace, WAVES) == ("torque_ripple",)


@pytest.mark.parametrize("seed", [0, 1])
def test_what_only_damps_noise_of_the_motion_is_no_coupling(monkeypatch, seed):
    """Sines of an encoder, interpolated with an error: a load behind a coupling does not follow it, so squares fall."""
    rng, motion = np.random.default_rng(seed), moved(4.0)
    position = motion.position + 3e-4 * np.sin(256.0 * motion.position) + 1e-6 * rng.normal(size=motion.time.size)
    signals = {"position": position, "current": recorded(motion, seed=seed)["current"]}
    trace = Trace(motion.time, signals, {name: UNITS[name] for name in signals}, "interpolated")
    assert sought(POLICY, trace, ["elastic_coupling"]) == ()
    monkeypatch.setattr(rules, "over_noise", lambda fitted: fitted.rms)
    assert sought(POLICY, trace, ["elastic_coupling"]) == ("elastic_coupling",)


def test_a_torque_that_drives_the_axis_is_no_drag():
    """A torque along the motion, growing with the square of speed: a drag of negative strength fits it."""
    trace = recorded(MOTION, lambda motion: -5e-5 * motion.velocity * np.abs(motion.velocity))
    assert names(POLICY, trace, ["quadratic_drag"]) == ()
    assert sought(without("physical"), trace, ["quadratic_drag"]) == ("quadratic_drag",)


def test_a_name_that_later_ones_make_good_goes():
    """Half a revolution of a spring and a wave of two cycles look like an unbalance until both are there."""
    trace = recorded(SHORT_STROKE, lambda motion: 0.02 * motion.position, wave(0.04, 2.0))
    effects = ["torsion_spring", "unbalance", "cogging_torque", "torque_offset"]
    hidden = {"torsion_spring", "cogging_torque"}
    assert set(names(POLICY, trace, effects)) == hidden
    assert set(sought(without("needs"), trace, effects)) == {*hidden, "unbalance"}


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


def test_a_coupling_beside_something_else_is_no_gap(monkeypatch):
    """Where the coupling leaves a remainder a dead zone is tried in its place, and explains less.

    Its gap is far smaller than what its contact yields, too, which alone keeps it from being one.
    """
    trace, effects = recorded(MOTION, coupled(0.6, 100.0, 0.1), vibration(0.02, 11.0)), ["elastic_coupling", "backlash"]
    assert sought(without("replaces_by"), trace, effects) == ("elastic_coupling",)
    monkeypatch.setattr(backlash, "OF_YIELDING", 0.0)
    assert sought(POLICY, trace, effects) == ("elastic_coupling",)
    assert sought(without("replaces_by"), trace, effects) == ("backlash",)


def test_what_no_effect_explains_is_reported():
    trace = recorded(MOTION, vibration(0.01, 3.3))
    others = frozenset(catalogue()) - {"unbalance"}
    found, less = (diagnose(trace, RIG, excluded=others, policy=policy) for policy in (POLICY, without("remains")))
    assert found.verdict == "unexplained_remainder"
    assert [any("torque residual" in one for one in reasons(each)) for each in (found, less)] == [True, False]


def test_noise_alone_is_no_remainder():
    others = frozenset(catalogue()) - {"unbalance"}
    assert [diagnose(recorded(MOTION, seed=k), RIG, excluded=others).verdict for k in range(6)] == [
        "nothing_missing"
    ] * 6


def test_few_finalists_are_searched_and_the_best_of_them(monkeypatch):
    current = bare(recorded(MOTION, wave(0.05, 6.0), offset(0.05)))
    tried = candidates(current, catalogue().values())
    promising = [candidate.term for candidate in tried if POLICY.promises(current, candidate.gain)]
    asked, refined = [], searching.refined
    monkeypatch.setattr(searching, "refined", lambda fitted, term: asked.append(term) or refined(fitted, term))
    search(current, list(catalogue().values()), Policy(most=0))
    assert asked == promising[:4]
    assert 4 < len(promising) < len(tried)


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
    cut = search(bare(trace), effects, Policy(most=1))
    assert (len(cut.last.terms), cut.stopped) == (1, LIMIT)
    whole = search(bare(trace), effects, Policy(most=2))
    assert (set(whole.last.hypothesis.names), whole.stopped) == ({"torque_offset", "cogging_torque"}, None)


def test_a_family_of_harmonics_is_one_effect():
    trace = recorded(MOTION, wave(0.05, 6.0), wave(0.05, 9.0, 1.0))
    found = search(bare(trace), [catalogue()["cogging_torque"]], Policy(most=1))
    assert sorted(term.shape for term in found.last.terms) == [(6.0,), (9.0,)]
    assert found.stopped is None
    cut = search(bare(trace), [catalogue()["cogging_torque"]], Policy(members=1))
    assert len(cut.last.terms) == 1
    assert cut.stopped == LIMIT


class OneAtATime(Policy):
    """Lets go of the first effect as soon as there is a second one."""

    def needs(self, fitted, less, index):
        return index != 0


def test_what_is_taken_up_and_let_go_in_turn_ends():
    """Each of two effects is worth taking up beside the other, and the other is let go for it."""
    trace = recorded(MOTION, wave(0.05, 6.0), offset(0.05))
    effects = [catalogue()[name] for name in ("torque_offset", "cogging_torque")]
    found = search(bare(trace), effects, OneAtATime())
    assert [len(step.fitted.terms) for step in found.steps] == [0, 1, 1]
    assert found.stopped is None


def test_what_the_limit_cut_off_is_a_remainder():
    trace = recorded(MOTION, wave(0.05, 6.0), offset(0.05))
    others = frozenset(catalogue()) - {"torque_offset", "cogging_torque"}
    cut = diagnose(trace, RIG, excluded=others, policy=Policy(most=1))
    assert (cut.verdict, cut.stopped) == ("unexplained_remainder", LIMIT)


#: Each of seven waves takes a seventh of what all leave, where an effect needs a quarter.
NUMBERS = (3.0, 5.0, 7.0, 9.0, 11.0, 13.0, 16.0)
SEVEN = [wave(0.02, number) for number in NUMBERS]


def test_many_small_effects_are_named_that_explain_it_together():
    few = ("cogging_torque", "quadratic_drag", "stribeck_friction")
    found = search(bare(recorded(MOTION, *SEVEN)), [catalogue()[name] for name in few], POLICY).last
    assert sorted(term.shape[0] for term in found.terms) == [*NUMBERS]
    assert found.chi < 1.1
    assert len(sought(Policy(nearly_all=0.0), recorded(MOTION, *SEVEN), few)) < 3


def test_small_effects_beside_a_remainder_are_not_named():
    few = ("cogging_torque", "quadratic_drag", "stribeck_friction")
    assert sought(POLICY, recorded(MOTION, *SEVEN, vibration(0.05, 3.3)), few) == ()


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
    with pytest.raises(UndeterminedError, match="would stand out of the noise"):
        diagnose(trace, RIG, policy=Policy(chance=1e5))
