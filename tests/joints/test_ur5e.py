"""A UR5e whose six joints hide something each: one command tells it all, and the model that it writes moves as the arm.

The log is of the Newton-Euler equations written out; `python -m tests.studies.robot --help` measures other motions.
"""

import numpy as np
import pytest

from tests.studies.robot import measured, table


@pytest.mark.slow
def test_play_in_the_first_gear_is_called_nothing_else(tmp_path):
    """It shakes all links where no encoder is: residuals are above noise, true values are within their intervals."""
    found = measured(tmp_path, play=0.01)
    print(f"\n{table(found)}")
    for joint, one in found["joints"].items():
        assert not one["named"], joint
        assert one["verdict"] == "unexplained_remainder", joint
        assert all(one["inside"].values()), joint


@pytest.mark.slow
def test_every_joint_and_what_it_carried_is_determined_and_the_model_moves_as_the_true_one(tmp_path):
    """Free for a second, from what the sensors say; RMS over joints, as one of them sticks or slips by chance."""
    figures = measured(tmp_path)
    print(f"\n{table(figures)}")
    for joint, one in figures["joints"].items():
        assert one["named"] == one["hidden"], joint
        assert abs(one["off"]["armature"]) < 0.01, joint
        assert abs(one["off"]["viscous_friction_coefficient"]) < 0.03, joint
        assert abs(one["off"]["coulomb_friction_torque"]) < 0.03, joint
    assert not figures["links"]
    assert abs(figures["payload"]["mass"]) < 0.02
    assert figures["payload"]["centre"] < 5e-3
    found, true = (np.array(figures["free"][kind]) for kind in ("found", "true"))
    assert np.median(found / true) < 1.2
    assert np.linalg.norm(found) < 1.2 * np.linalg.norm(true)
