"""Friction that follows motor and load apart: driving a weight up takes more than holding back what goes down."""

import numpy as np
import pytest

from bench.diagnosis.name import alike
from bench.diagnosis.policy import POLICY
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Term
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from tests.recorded import QUIET

NAME = "directional_load_friction"


@pytest.mark.parametrize(("amplitude", "also"), [(0.004, (NAME,)), pytest.param(0.2, (), marks=pytest.mark.slow)])
def test_friction_by_the_motors_torque_may_be_by_the_loads_beside_a_small_load(amplitude, also):
    """Of the independent integrator: no friction by the load's torque, which a small load does not tell."""
    hidden = KINDS["load_dependent_friction"](0.1), KINDS["unbalance"](amplitude, 0.4)
    trace = QUIET.record({"both": hidden}, random_motion(QUIET.axis, np.random.default_rng(3), 6.0), 3)["both"]
    recordings = Recordings.of(trace, QUIET.rig, None)
    terms = Term(catalogue()["load_dependent_friction"]), Term(catalogue()["unbalance"])
    bare = fit_bare(recordings.rows)
    fitted = fit(bare.rows, bare.hypothesis.with_terms(terms))
    assert fitted.strengths(0)[0] == pytest.approx(0.1, rel=0.05)
    assert [alike(fitted, index, POLICY) for index in range(2)] == [also, ()]
