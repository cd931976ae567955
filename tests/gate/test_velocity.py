"""Speed against the derivative of position."""

import numpy as np
import pytest

from bench.gate import velocity
from bench.gate.check import Seen
from bench.trace.trace import Trace
from tests.gate.damage import changed


@pytest.mark.parametrize("factor", [0.16, 0.5, 0.6, 6.0, -1.0, 0.88, 1.12, 180.0 / np.pi, 1e-20, 1e20])
def test_a_speed_of_another_scale_fails(sound, rig, factor):
    found = velocity.is_derivative(Seen(changed(sound, velocity=factor * sound["velocity"]), rig))
    assert found.status == "fail"
    assert float(found.found.split()[2]) == pytest.approx(factor, rel=1e-3)


@pytest.mark.parametrize(
    ("seen", "status"),
    [
        (lambda speed: 0.99 * speed, "pass"),
        (lambda speed: 1.05 * speed, "warn"),
        (lambda speed: 0.94 * speed, "warn"),
        (lambda speed: speed + 2.0, "pass"),  # an offset is no other scale
        (lambda speed: speed[::-1].copy(), "fail"),  # of another axis
    ],
)
def test_a_speed_that_is_off(sound, rig, seen, status):
    assert velocity.is_derivative(Seen(changed(sound, velocity=seen(sound["velocity"])), rig)).status == status


@pytest.mark.parametrize("lag", [0.5e-3, 2e-3, 20e-3])
def test_a_filtered_speed_is_late_and_no_other_scale(sound, rig, lag):
    alpha = np.exp(-sound.sample_period / lag)
    late = np.zeros(len(sound))
    for k in range(1, len(sound)):
        late[k] = alpha * late[k - 1] + (1.0 - alpha) * sound["velocity"][k]
    found = velocity.is_derivative(Seen(changed(sound, velocity=late), rig))
    assert found.status == "pass"


def test_a_standstill_compares_nothing(sound, rig):
    rng = np.random.default_rng(0)
    still = changed(sound, velocity=rng.normal(scale=0.02, size=len(sound)), position=np.zeros(len(sound)))
    assert velocity.is_derivative(Seen(still, rig)).status == "not_applicable"


@pytest.mark.parametrize(
    ("ratio", "remainder", "status"),
    [
        (1.019, 0.0, "pass"),
        (1.021, 0.0, "warn"),
        (0.981, 0.39, "pass"),
        (0.979, 0.39, "warn"),
        (1.099, 0.0, "warn"),
        (1.101, 0.0, "fail"),
        (0.901, 0.0, "warn"),
        (0.899, 0.0, "fail"),
        (1.0, 0.41, "fail"),
        (1.5, 0.41, "fail"),
    ],
)
def test_ratio_and_remainder_are_judged_by_their_borders(ratio, remainder, status):
    found = velocity.judged(ratio, 0.0, remainder)
    assert found.status == status
    assert ("not the same motion" in found.found) == (remainder > 0.4)


def test_ratio_lag_and_offset_of_a_motion_in_closed_form_are_found():
    """0.7*(v - T*dv/dt) of a sine, held against itself: (1 - j*w*T)*(1 + j*w*T) = 1 + (w*T)**2."""
    time = 1e-3 * np.arange(4000)
    position, speed, rate = np.sin(3.0 * time), 3.0 * np.cos(3.0 * time), -9.0 * np.sin(3.0 * time)
    seen = {"position": position, "velocity": 0.7 * (speed - 5e-3 * rate) + 0.4}
    trace = Trace(time, seen, {"position": "rad", "velocity": "rad/s"}, "sine")
    ratio, lag, remainder = velocity.compared(Seen(trace))
    assert ratio == pytest.approx(0.7 * (1.0 + 0.015**2), rel=1e-5)
    assert lag == pytest.approx(5e-3, rel=1e-3)
    assert remainder < 1e-4
