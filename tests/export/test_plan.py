"""A planned motion tells what it promises; it stays inside the rig's limits, and what cannot be planned is reported."""

import numpy as np
import pytest

import bench
from bench.assets import asset
from bench.effects.present import Present
from bench.errors import InputError
from bench.export.plan import motions
from bench.plant.plant import Plant
from bench.plant.profiles import MotionLimits
from bench.rig.rig import load_rig

RIG = load_rig(asset("data", "rigs", "sh30701p.toml"))
LIMITS = MotionLimits.from_rig(RIG, Plant.from_rig(RIG).axis.parameters, 250e-6)


@pytest.fixture(scope="module")
def planned():
    return motions(RIG)


def test_the_best_comes_first_and_stays_inside_the_limits(planned):
    worst = [each.worst for each in planned]
    assert worst == sorted(worst)
    for each in planned:
        assert np.abs(each.motion.velocity).max() <= LIMITS.speed * (1.0 + 1e-9)
        assert np.abs(each.motion.acceleration).max() <= LIMITS.acceleration * (1.0 + 1e-9)
        assert each.motion.time[-1] >= 4.0


@pytest.mark.slow
def test_the_errors_expected_are_those_that_come(planned):
    """Over recordings with noise of their own the estimates scatter as the plan says, within what twelve can tell."""
    best, names = planned[0], ("moment_of_inertia", "viscous_friction_coefficient", "coulomb_friction_torque")
    scatter = {name: [] for name in names}
    for seed in range(1, 13):
        found = bench.identify(bench.simulate(RIG, best.profile, seed, best.motion).trace, RIG)
        for name in names:
            scatter[name].append(found[name].value)
    for name, values in scatter.items():
        ratio = float(np.std(values, ddof=1)) / best.expected[name].std_error
        print(f"\n{name}: scatter {np.std(values, ddof=1):.3g}, expected {best.expected[name].std_error:.3g}", end="")
        assert 0.4 < ratio < 1.8


def test_one_that_is_asked_for_is_reported():
    """Of two motions, the one that passes the speeds at which friction falls slowly enough."""
    wanted = Present.of("stribeck_friction", {"static_friction": 0.12, "stribeck_velocity": 2.0})
    (best,), (other,) = (motions(RIG, wanted, profile) for profile in ("identification", "speed_staircase"))
    assert best.profile == "identification"
    assert best.expected["static_friction"].value == pytest.approx(0.12, rel=0.1)
    assert best.worst < 0.2 * other.worst


def test_what_no_torque_balance_tells_cannot_be_planned():
    with pytest.raises(InputError, match="none of the torque balance"):
        motions(RIG, Present.of("voltage_limit", {"voltage": 30.0}))


def test_a_motion_repeated_goes_on_from_where_it_ends(planned):
    short = planned[0].motion
    twice = short.repeated(2)
    np.testing.assert_allclose(np.diff(twice.time), np.full(2 * short.time.size - 1, short.period))
    assert abs(np.diff(twice.position)).max() <= np.abs(short.velocity).max() * short.period * 1.01
