"""From which share of its own on a quantity counts as determined, at and beside the borders."""

import numpy as np
import pytest

from bench.axis_kind import COULOMB, INERTIA, OFFSET, ROTARY, VISCOUS
from bench.errors import UndeterminedError
from bench.fit.determined import left_open, require_inertia
from bench.fit.hypothesis import BASE
from bench.fit.solution import NormalEquations

NAMES = (*BASE, OFFSET)
PLACES = len(NAMES)


def equations(gram, rows=1000, noise=None):
    """Normal equations of one block: `gram` (5, 5) a row."""
    whole = np.asarray(gram, dtype=float)[None] * rows
    none = np.zeros((PLACES, PLACES))
    return NormalEquations(
        NAMES, whole, np.zeros((1, PLACES)), np.ones(1), np.array([rows]), none if noise is None else noise
    )


def alike(first, second, share):
    """Columns of unit power, of which two share all but `share` of their power, and the direction is even."""
    gram = np.eye(PLACES)
    gram[first, second] = gram[second, first] = np.sqrt(1.0 - share)
    return gram


@pytest.mark.parametrize("share", [0.5, 0.02, 0.008])
def test_the_share_is_what_the_others_do_not_explain(share):
    assert equations(alike(0, 1, share)).independent_shares((INERTIA, VISCOUS))[0] == pytest.approx(share)


def test_noise_of_a_column_is_no_share_of_it():
    noise = np.diag([0.75, 0.0, 0.0, 0.0, 0.0])
    assert equations(np.eye(PLACES), noise=noise).independent_shares((INERTIA, VISCOUS))[0] == pytest.approx(0.25)


@pytest.mark.parametrize(("share", "sure"), [(0.0105, True), (0.0095, False)])
def test_a_quantity_needs_one_per_cent_of_its_own(share, sure):
    found = equations(alike(0, 1, share))
    assert left_open(found, ROTARY) == (frozenset() if sure else {INERTIA, VISCOUS, COULOMB, OFFSET})
    friction = equations(alike(1, 2, share))
    assert left_open(friction, ROTARY) == (frozenset() if sure else {VISCOUS, COULOMB})


def test_what_is_not_shown_has_its_plain_reason_first():
    with pytest.raises(UndeterminedError, match=r": it hardly accelerates: only 0\.9\d? % of what would show it"):
        require_inertia(equations(alike(0, 1, 0.009)), ROTARY)


def test_noise_is_the_reason_where_it_alone_hides_the_acceleration():
    noise = np.diag([1.0, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(UndeterminedError, match=r"100 % of the measured acceleration's power is noise") as refused:
        require_inertia(equations(np.eye(PLACES), noise=noise), ROTARY)
    assert "hardly accelerates" not in str(refused.value) and "finer" in refused.value.record


@pytest.mark.parametrize(("rows", "sure"), [(100, True), (99, False)])
def test_it_takes_twenty_rows_a_column(rows, sure):
    found = equations(np.eye(PLACES), rows=rows)
    if sure:
        require_inertia(found, ROTARY)
    else:
        with pytest.raises(UndeterminedError, match=r"only 99 filtered samples .* 100 are needed"):
            require_inertia(found, ROTARY)


@pytest.mark.parametrize(
    ("weaker", "side"), [(0.021, None), (0.019, "forward"), (0.981, "backward"), (0.979, None), (0.5, None)]
)
def test_one_way_is_less_than_two_per_cent_the_other_way(weaker, side):
    gram = np.eye(PLACES)
    gram[2, 4] = gram[4, 2] = 1.0 - 2.0 * weaker
    assert equations(gram).one_way == side
