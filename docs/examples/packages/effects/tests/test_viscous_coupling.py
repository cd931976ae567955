import numpy as np
from closed_form import TIME, assert_found, diagnosed, motion, torque

LOAD, TIME_CONSTANT = 1e-3, 0.03


def test_it_is_found():
    speed, acceleration = motion()
    settled, _ = motion(lambda s: 1.0 / (1.0 + TIME_CONSTANT * s))
    load_speed = settled - settled[0] * np.exp(-TIME / TIME_CONSTANT)  # it starts at rest, as the motor does
    dragged = LOAD * ((speed - load_speed) / TIME_CONSTANT - acceleration)
    assert_found(diagnosed(torque() + dragged), "viscous_coupling", drag=LOAD / TIME_CONSTANT)
