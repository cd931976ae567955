"""The independent axis with every effect, and with effects that meet, simulated once for all tests."""

import pytest

from tests.effects import axes
from tests.effects.axes import VALUES, Reversals, truth
from tests.kept import kept

MOTION = Reversals(0.6)
#: Levels of friction that multiply, torque that is made in turns, sensors on a coupling.
TOGETHER = [
    ("direction_dependent_friction", "position_dependent_friction", "stribeck_friction"),
    ("friction_warmup", "load_dependent_friction", "torque_offset"),
    ("current_loop_lag", "torque_constant_saturation", "torque_ripple"),
    ("presliding_friction", "stribeck_friction"),
    ("elastic_coupling", "unbalance", "velocity_filter_lag"),
    ("encoder_eccentricity", "velocity_filter_lag", "voltage_limit"),
    ("current_filter_lag", "current_gain_asymmetry", "current_loop_lag"),
    ("directional_load_friction", "torsion_spring", "unbalance"),
    ("presliding_friction", "stribeck_friction", "direction_dependent_friction", "friction_warmup"),
    ("presliding_friction", "direction_dependent_friction"),
]
CASES = [(), *((name,) for name in VALUES), *TOGETHER]


@pytest.fixture(scope="session")
def truths():
    """True and measured signals at every tick of MOTION, by the names of the effects."""
    found = kept(lambda: truth(CASES, MOTION), __file__, str(axes.__file__))
    return dict(zip(CASES, found, strict=True))
