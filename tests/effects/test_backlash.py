"""A gap: the motor runs alone through it, then carries the load."""

import numpy as np

from tests.effects.axes import AXIS, FREE, Present, moved, present, signals


def test_motor_runs_alone_through_half_of_the_gap():
    time, position, velocity = signals(moved([present("backlash")], 0.05, torque=0.5))
    alone = position < 0.0099
    np.testing.assert_allclose(velocity[alone], 0.5 * time[alone] / AXIS.rotor_inertia, atol=1e-6)
    assert 10 < alone.sum() < 200


def test_whole_axis_accelerates_once_the_gap_is_closed():
    time, _, velocity = signals(moved([present("backlash")], 1.0, torque=0.5))
    late = time > 0.5
    slope = np.polyfit(time[late], velocity[late], 1)[0]
    np.testing.assert_allclose(slope, 0.5 / FREE.inertia, rtol=1e-3)


def test_contact_need_not_be_given():
    soft = moved([Present.of("backlash", {"gap": 0.02})], 1.0, torque=0.5)
    np.testing.assert_allclose(soft.velocity[-1], 0.5 / FREE.inertia, rtol=5e-3)
