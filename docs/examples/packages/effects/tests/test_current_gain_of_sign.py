import numpy as np
from closed_form import assert_found, diagnosed, torque


def test_it_is_found():
    true = torque()
    reported = true / (1.0 + 0.02 * np.sign(true))
    assert_found(diagnosed(reported), "current_gain_of_sign", gain_difference=0.02)
