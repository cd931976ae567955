"""Friction over speed against curves in closed form, and what effects say of themselves."""

import numpy as np
import pytest
from scipy import stats

from bench.axis_kind import LINEAR, ROTARY
from bench.effects.catalogue import catalogue
from bench.effects.effect import Signals
from bench.friction_map import FrictionCurve, chance, friction_map
from bench.rig.rig import Rig
from bench.trace.trace import Trace

OF_SPEED = sorted(name for name, effect in catalogue().items() if effect.of_speed)
RIGS = {kind: Rig.of({"name": "axis", "kind": kind.name}) for kind in (ROTARY, LINEAR)}
SPEEDS = np.concatenate([sign * np.geomspace(0.5, 60.0, 14) for sign in (-1.0, 1.0)])


def signals(rng, velocity):
    """Of random motion with these speeds."""
    time, position, effort, torque = rng.normal(size=(4, velocity.size))
    sign = np.sign(velocity)
    return Signals(time, position, velocity, sign, effort, torque, sign, *rng.uniform(0.5, 2.0, 2))


@pytest.mark.parametrize("name", OF_SPEED)
def test_an_effect_of_speed_alone_asks_nothing_else_of_a_recording(name):
    effect, rng = catalogue()[name], np.random.default_rng(5)
    shape = [entry.grid[0] for entry in effect.shapes]
    one, other = (effect.columns(signals(rng, SPEEDS), shape) for _ in range(2))
    assert len(one) == len(other) > 0
    for terms, same in zip(one, other, strict=True):
        for (values, order), (again, order_again) in zip(terms, same, strict=True):
            assert (order, order_again) == (0, 0)
            np.testing.assert_array_equal(values, again)
    assert {entry.quantity.unit for entry in effect.shapes} <= {"rad/s"}


def test_friction_that_bends_with_speed_is_of_speed_alone_and_cogging_is_not():
    assert {"stribeck_friction", "quadratic_drag", "direction_dependent_friction"} <= set(OF_SPEED)
    assert not {"cogging_torque", "load_dependent_friction", "friction_warmup", "torque_offset"} & set(OF_SPEED)


def recordings(kind, friction):
    """One of half a second at each speed."""
    time, units = np.arange(500) * 1e-3, {"velocity": kind.speed_unit, kind.effort: kind.effort_unit}
    for k, speed in enumerate(SPEEDS):
        values = {"velocity": np.full(500, speed), kind.effort: np.full(500, friction(speed))}
        yield Trace(time, values, units, f"closed form {k}")


@pytest.mark.parametrize("kind", RIGS, ids=lambda kind: kind.name)
def test_quadratic_drag_is_found_to_the_last_digit(kind):
    def friction(speed):
        return 8e-4 * speed + 0.06 * np.sign(speed) + 0.004 + 3e-5 * speed * abs(speed)

    found = friction_map(list(recordings(kind, friction)), RIGS[kind])
    assert (found.name, found.kind) == ("quadratic_drag", kind)
    assert found.values == {"quadratic_drag": pytest.approx(3e-5, rel=1e-9)}
    assert found.base.viscous == pytest.approx(8e-4, rel=1e-9)
    assert found.base.coulomb == pytest.approx(0.06, rel=1e-9)
    assert found.offset == pytest.approx(0.004, rel=1e-9)
    assert found.best.effort(np.array([-100.0, 100.0])) == pytest.approx([friction(-100.0), friction(100.0)], rel=1e-9)


def test_the_order_of_recordings_does_not_matter():
    def friction(speed):
        return (0.06 + 0.02 * np.exp(-((speed / 4.0) ** 2))) * np.sign(speed)

    given = list(recordings(ROTARY, friction))
    one, other = friction_map(given, RIGS[ROTARY]), friction_map(given[::-1], RIGS[ROTARY])
    assert one.name == other.name == "stribeck_friction"
    assert one.values == pytest.approx(other.values, rel=1e-6)


def test_a_chance_is_that_of_the_f_test():
    """Two numbers more save 6 of 10 squares, of 25 points."""
    plain, tried = (FrictionCurve("", (), np.zeros(3), squares, free, True) for squares, free in ((10.0, 3), (4.0, 5)))
    assert chance(plain, tried, 25, 0.0) == pytest.approx(stats.f.sf((6.0 / 2.0) / (4.0 / 20.0), 2, 20))
    assert chance(plain, tried, 25, 8.0) == pytest.approx(stats.f.sf((6.0 / 2.0) / (8.0 / 20.0), 2, 20))
    assert chance(plain, plain, 25, 0.0) == 1.0
