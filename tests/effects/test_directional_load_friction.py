"""Friction that follows motor and load apart: driving a weight up takes more than holding back what goes down."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.name import alike
from bench.diagnosis.policy import POLICY
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.effects.catalogue import catalogue
from bench.effects.present import Present
from bench.effects.signals import Axis
from bench.fit.fit import fit
from bench.fit.hypothesis import Term
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from tests.effects.axes import FREE, VALUES, moved, present, signals
from tests.recorded import QUIET

NAME = "directional_load_friction"


@pytest.mark.parametrize("torque", [1.5, 0.4])
def test_acceleration_of_a_weight_that_is_driven_and_of_one_that_drives(torque):
    """Up under more, down under less than the weight: the closed form of the equation on either side."""
    dry, weight, values = replace(FREE, coulomb_friction=0.06), 0.8, VALUES[NAME]
    up = 1.0 if torque > weight else -1.0
    load = Present.of("torque_offset", {"torque": weight})
    time, _, velocity = signals(moved([present(NAME), load], 0.1, torque, velocity=5.0 * up, parameters=dry))
    friction = 0.06 + values["motor_coefficient"] * abs(torque + values["load_ratio"] * weight)
    exact = 5.0 * up + (torque - weight - up * friction) * time / FREE.inertia
    np.testing.assert_allclose(velocity, exact, atol=1e-6)


def test_without_a_load_it_is_load_dependent_friction():
    dry = replace(FREE, coulomb_friction=0.06)
    same = Present.of("load_dependent_friction", {"load_friction_coefficient": VALUES[NAME]["motor_coefficient"]})
    motions = [signals(moved([each], 0.1, 1.0, parameters=dry))[2] for each in (present(NAME), same)]
    np.testing.assert_array_equal(*motions)


def test_the_coefficient_of_the_load_is_determined_beside_that_of_the_motor():
    found = catalogue()[NAME].report([0.2], (3.0,), Axis(1.0, 0.0, 0.0))
    assert found == {"motor_coefficient": 0.2, "load_ratio": 3.0, "load_coefficient": pytest.approx(0.6)}


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
