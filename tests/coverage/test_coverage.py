"""Intervals hold the truth on poor motions too; `python -m tests.coverage` makes the table of many more."""

import numpy as np
import pytest

from tests.coverage.draw import recordings
from tests.coverage.run import of_nulls
from tests.coverage.table import Outcome, markdown

#: Motions of a kind that intervals were too narrow on.
POOR = ("very slow", "one sine", "one trapezoid, one way")


def test_an_outcome_is_inside_by_its_interval():
    assert Outcome(0.9, 1.0).inside(0.95)
    assert not Outcome(0.9, 1.0).inside(0.8)
    table = markdown("t", {"m": (2, {"J": [Outcome(0.1, 0.3)], "K_w": [], "K_0": []})})
    assert "| m | 2 | J | 1 | 100.0% | 100.0% | 100.0% | 10 | 3.00 |" in table
    assert "| m | 2 | K_w | 0 | - | - | - | - | - |" in table


@pytest.mark.slow
def test_intervals_cover_over_all_motions():
    found = {name: of_nulls(runs)[1] for name, runs in recordings(60, 1, 6.0).items()}
    for quantity in ("J", "K_w", "K_0"):
        outcomes = [one for group in found.values() for one in group[quantity]]
        share = np.mean([one.inside(0.95) for one in outcomes])
        print(f"\n{quantity}: {share:.1%} of {len(outcomes)} inside", end="")
        assert share > 0.93
    for name in POOR:
        assert np.mean([one.inside(0.95) for one in found[name]["J"]]) > 0.85
