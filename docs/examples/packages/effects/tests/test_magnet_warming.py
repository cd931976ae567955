from closed_form import TIME, assert_found, diagnosed, torque


def test_it_is_found():
    assert_found(diagnosed(torque() / (1.0 - 0.01 * TIME)), "magnet_warming", rate=0.01)
