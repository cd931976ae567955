"""What terms see of each other's strengths is brought in line, whether it creeps or swings from fit to fit."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term, extrapolated
from bench.fit.rows import Rows
from tests.fit.motions import RIG, Truth, recording

#: Time constant of the warm-up - s.
DECAYS = 2.0
DIRECTION, WARMUP = catalogue()["direction_dependent_friction"], catalogue()["friction_warmup"]


def asked_for(*levels: float) -> Hypothesis:
    return Hypothesis(tuple(Term(DIRECTION, (), (level,)) for level in levels))


@pytest.mark.parametrize("slope", [-2.0, -0.6, 0.3, 0.7])
def test_levels_that_answer_in_a_line_are_found_in_three_fits(slope):
    """x -> end + slope*(x - end) comes to its end, which fits alone would only near, or flee."""
    end = np.array([1.5, -0.4])

    def found(asked: Hypothesis) -> Hypothesis:
        return asked_for(*(end + slope * (np.array([term.level[0] for term in asked.terms]) - end)))

    first = asked_for(1.2, -0.3)
    second = extrapolated(first, found(first), None)
    assert second == found(first)  # nothing is known yet of how it moves
    third = extrapolated(second, found(second), (first, found(first)))
    assert [term.level[0] for term in third.terms] == pytest.approx(end.tolist(), rel=1e-9)


def test_what_answers_with_other_terms_is_taken_as_it_is():
    one, two = asked_for(1.0), asked_for(1.0, 2.0)
    assert extrapolated(one, two, (one, one)) == two


@pytest.mark.parametrize("amplitude", [0.2, 1.0])
def test_frictions_that_scale_each_other_are_found_exactly(amplitude):
    """A warm-up that is much of all friction, of an axis that is dry in one direction by far more than in the other."""
    truth, share = Truth(coulomb=0.02), -0.6
    plain = recording(np.random.default_rng(5), truth, torque_noise=0.0, velocity_noise=0.0, position=True)
    cold = amplitude * np.exp(-plain.time / DECAYS)
    sign, speed = np.sign(plain["velocity"]), plain["velocity"]
    more = truth.coulomb * ((sign + share) * (1.0 + cold) - sign) + truth.viscous * cold * speed
    trace = plain.with_signals({"current": plain["current"] + more / 0.8}, {})
    found = fit(Rows.of(trace, RIG), Hypothesis((Term(DIRECTION), Term(WARMUP, (DECAYS,)))))
    assert found.base.coulomb == pytest.approx(truth.coulomb, rel=2e-3)
    assert found.strengths(0)[0] / found.base.coulomb == pytest.approx(2.0 * share, rel=2e-3)
    assert found.strengths(1)[0] / found.base.coulomb == pytest.approx(amplitude, rel=2e-3)
