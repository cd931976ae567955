"""The search of shapes ends at the least residual, and where a valley does not end within numbers."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.fit import FURTHEST, fit, shaped, together
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows
from tests.diagnosis.constructed import RIG, moved, recorded, wave

EFFECTS = catalogue()
COUPLING, COGGING, STRIBECK = EFFECTS["elastic_coupling"], EFFECTS["cogging_torque"], EFFECTS["stribeck_friction"]


def stribeck(motion):
    return 0.06 * motion.sign * np.exp(-((motion.velocity / 4.0) ** 2))


def test_the_search_of_a_rigid_axis_for_a_coupling_stays_within_numbers():
    rows, term = Rows.of(recorded(moved()), RIG), Term(COUPLING, (100.0, 0.04))
    (found,) = shaped(fit(rows, Hypothesis()), Hypothesis((term,)), 0).hypothesis.terms
    for k, (value, start) in enumerate(zip(found.shape, term.shape, strict=True)):
        assert abs(np.log(value / start)) <= FURTHEST * COUPLING.reach(term.shape, k) * (1.0 + 1e-9)


@pytest.mark.parametrize("start", [1.0, 2.5, 7.0])
def test_one_shape_is_found_from_either_side(start):
    rows = Rows.of(recorded(moved(), stribeck), RIG)
    found = shaped(fit(rows, Hypothesis()), Hypothesis((Term(STRIBECK, (start,)),)), 0)
    assert found.hypothesis.terms[0].shape[0] == pytest.approx(4.0, rel=0.05)
    for beside in (0.98, 1.02):
        near = found.hypothesis.reshaped(0, (beside * found.hypothesis.terms[0].shape[0],))
        assert fit(rows, near).squares > found.squares


def test_shapes_searched_together_end_no_higher_than_one_after_the_other():
    """From shapes off by a tenth: derivatives by steps that a fit resolves, not by those of rounding."""
    rows = Rows.of(recorded(moved(), stribeck, wave(0.05, 6.0, 0.3)), RIG)
    fitted = fit(rows, Hypothesis((Term(STRIBECK, (4.6,)), Term(COGGING, (6.0,)))))
    once = shaped(fit(rows, Hypothesis()), fitted.hypothesis, 0)
    both = together(fitted)
    assert both.squares <= once.squares * (1.0 + 1e-4)
    assert both.squares < fitted.squares
    assert both.hypothesis.terms[0].shape[0] == pytest.approx(4.0, rel=0.05)
