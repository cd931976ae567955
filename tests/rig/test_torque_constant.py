"""kT(Iq) of the SH30701P: closed form, both datasheet points exact, even, flat at zero, inverse."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.rig.motor import TorqueConstant

SH30701P = TorqueConstant.from_datasheet(1.4, 1.8, 3.5, 5.7)


def test_both_datasheet_points_are_met_exactly():
    assert SH30701P.torque(np.array([1.8, 5.7])) == pytest.approx([1.4, 3.5], rel=1e-15)


def test_it_is_even_flat_at_zero_and_falls_and_torque_turns_sign():
    current = np.linspace(0.0, 5.7, 200)
    assert SH30701P(current) == pytest.approx(SH30701P(-current), rel=0.0)
    assert SH30701P.torque(-current) == pytest.approx(-SH30701P.torque(current), rel=1e-15)
    assert (np.diff(SH30701P(current)) < 0.0).all()
    low, step = SH30701P(np.array([0.0, 1e-4]))
    assert abs(step - low) < 1e-10


@given(st.floats(-5.7, 5.7))
def test_current_is_the_inverse_of_torque(current):
    assert SH30701P.current(SH30701P.torque(np.array([current])))[0] == pytest.approx(current, abs=1e-12)


def test_a_constant_torque_constant_inverts_too():
    assert TorqueConstant(0.5).current(np.array([2.0])) == pytest.approx([4.0])
