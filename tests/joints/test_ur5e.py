"""A UR5e whose six joints hide something each: one command tells it all, and the model that it writes moves as the arm.

The log is of the Newton-Euler equations written out; `python -m tests.studies.robot --help` measures other motions.
"""

import numpy as np
import pytest

from tests.studies.robot import measured, table


@pytest.fixture(scope="module")
def loose(tmp_path_factory):
    """Of the same arm whose first gear has play, which shakes all its links where no encoder is."""
    found = measured(tmp_path_factory.mktemp("loose"), play=0.01)
    print(f"\n{table(found)}")
    return found


@pytest.mark.slow
def test_play_in_the_first_gear_is_called_nothing_else(loose):
    """That what is left is more than noise is said of every joint, and all true values are inside their intervals."""
    for joint, one in loose["joints"].items():
        assert not one["named"], joint
        assert one["verdict"] == "unexplained_remainder", joint
        assert all(one["inside"].values()), joint


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    """Of the study, which run once."""
    found = measured(tmp_path_factory.mktemp("ur5e"))
    print(f"\n{table(found)}")
    return found


@pytest.mark.slow
def test_every_joint_is_named_and_nothing_else(figures):
    for joint, one in figures["joints"].items():
        assert one["named"] == one["hidden"], joint
    assert not figures["links"]


@pytest.mark.slow
def test_armature_and_friction_are_determined(figures):
    for joint, one in figures["joints"].items():
        assert abs(one["off"]["armature"]) < 0.01, joint
        assert abs(one["off"]["viscous_friction_coefficient"]) < 0.03, joint
        assert abs(one["off"]["coulomb_friction_torque"]) < 0.03, joint


@pytest.mark.slow
def test_what_it_carried_is_determined(figures):
    assert abs(figures["payload"]["mass"]) < 0.02
    assert figures["payload"]["centre"] < 5e-3


@pytest.mark.slow
def test_the_model_moves_as_the_true_one(figures):
    """Free for a second, from what the sensors say; RMS over joints, as one of them sticks or slips by chance."""
    found, true = (np.array(figures["free"][kind]) for kind in ("found", "true"))
    assert np.median(found / true) < 1.2
    assert np.linalg.norm(found) < 1.2 * np.linalg.norm(true)
