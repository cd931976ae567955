"""Intervals hold the truth over rich and poor motions; docs/validate.md has the table of many more recordings."""

import numpy as np
import pytest

from bench.validation.plan import Plan
from bench.validation.validate import validate

#: Motions of a kind that intervals were too narrow on.
POOR = ("very slow", "one sine", "one trapezoid, one way")


@pytest.mark.slow
def test_intervals_cover_over_all_motions():
    runs = validate(Plan(1), 320).runs
    for quantity in ("inertia", "viscous", "coulomb"):
        inside = [one.inside(0.95) for run in runs for one in run.scored if one.quantity == quantity]
        print(f"\n{quantity}: {np.mean(inside):.1%} of {len(inside)} inside", end="")
        assert np.mean(inside) > 0.92
    for motion in POOR:
        those = [one for run in runs if run.motion == motion for one in run.scored if one.quantity == "inertia"]
        assert np.mean([one.inside(0.95) for one in those]) > 0.85
