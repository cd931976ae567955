"""Speed against the derivative of position."""

import numpy as np
import pytest

from bench.gate import velocity
from tests.gate.damage import changed


@pytest.mark.parametrize("factor", [0.16, 0.5, 0.6, 6.0, -1.0, 0.88, 1.12, 180.0 / np.pi, 1e-20, 1e20])
def test_a_speed_of_another_scale_fails(sound, rig, factor):
    _, found = velocity.check(changed(sound, velocity=factor * sound["velocity"]), rig)
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
    assert velocity.check(changed(sound, velocity=seen(sound["velocity"])), rig)[1].status == status


@pytest.mark.parametrize("lag", [0.5e-3, 2e-3, 20e-3])
def test_a_filtered_speed_is_late_and_no_other_scale(sound, rig, lag):
    alpha = np.exp(-sound.sample_period / lag)
    late = np.zeros(len(sound))
    for k in range(1, len(sound)):
        late[k] = alpha * late[k - 1] + (1.0 - alpha) * sound["velocity"][k]
    _, found = velocity.check(changed(sound, velocity=late), rig)
    assert found.status == "pass"


def test_a_standstill_compares_nothing(sound, rig):
    rng = np.random.default_rng(0)
    still = changed(sound, velocity=rng.normal(scale=0.02, size=len(sound)), position=np.zeros(len(sound)))
    assert velocity.check(still, rig)[1].status == "not_applicable"
