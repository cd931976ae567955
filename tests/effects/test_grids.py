"""Where a search looks first: on every axis, as fast or slow as it is, where a scaled one looks."""

from dataclasses import replace

import numpy as np
import pytest

from bench.axis_kind import LINEAR, ROTARY
from bench.effects.catalogue import catalogue
from bench.effects.impacts import CONTACTS, contacts_of
from bench.effects.rivals import RIVALS
from bench.effects.shape import extended, places
from tests.effects.recording import scopes

USUAL = replace(next(scopes()), kind=ROTARY, top_speed=100.0, width=1.5e-3, duration=8.0)
MEASURED = [(effect, shape) for effect in catalogue().values() for shape in effect.shapes if shape.measure]
FACTORS = (1e-3, 0.05, 0.7, 1.0, 1.8, 30.0, 1e3)


def scaled(factor):
    """The usual recording of an axis so many times as fast, as its motor and itself are, for so much less long."""
    slower = {"width": USUAL.width / factor, "duration": USUAL.duration / factor}
    return replace(USUAL, top_speed=USUAL.top_speed * factor, **slower)


@pytest.mark.parametrize(("effect", "shape"), MEASURED, ids=lambda one: getattr(one, "name", ""))
@pytest.mark.parametrize("factor", FACTORS)
def test_a_scaled_axis_is_searched_where_the_usual_one_is(effect, shape, factor):
    """Within what one search of the shape reaches."""
    scope = scaled(factor)
    tried, by = places(shape, scope), shape.measure.factor(scope)
    assert list(tried) == sorted(set(tried)) and set(shape.grid) <= set(tried)
    reach = 2.718281828 ** effect.reach(shape.grid, effect.shapes.index(shape))
    for value in shape.grid:
        assert any(value * by / reach <= there <= value * by * reach for there in tried), value


@pytest.mark.parametrize(("effect", "shape"), MEASURED, ids=lambda one: getattr(one, "name", ""))
def test_what_a_shape_goes_with_has_the_power_of_its_unit(effect, shape):
    """Twice the speed in half the time: seconds halve, what is per second doubles, and per angle of speed halves."""
    by = {"s": 0.5, "rad/s": 2.0, "1/rad": 0.5}[shape.quantity.unit]
    assert shape.measure.factor(scaled(2.0)) == by


@pytest.mark.parametrize(("effect", "shape"), MEASURED, ids=lambda one: getattr(one, "name", ""))
def test_angles_say_nothing_on_a_linear_axis(effect, shape):
    scope = replace(scaled(1e-3), kind=LINEAR)
    stated = set(shape.grid) & set(places(shape, scope))
    assert stated == (set() if shape.measure.angular else set(shape.grid))


def test_a_grid_is_extended_on_the_side_where_it_ends():
    assert extended((1.0, 2.0, 4.0), 1.0) == (1.0, 2.0, 4.0)
    assert extended((1.0, 2.0, 4.0), 0.5) == (0.5, 1.0, 2.0, 4.0)
    assert extended((1.0, 2.0, 4.0), 100.0) == (1.0, 2.0, 4.0, 100.0, 200.0, 400.0)


def test_no_contact_is_sought_that_swings_faster_than_samples_follow():
    np.testing.assert_allclose(contacts_of(USUAL), CONTACTS)
    slow = contacts_of(replace(USUAL, sample_period=0.02, width=0.03))
    assert max(slow) == np.pi / 0.02 and min(slow) == pytest.approx(min(CONTACTS) / 20.0)


def test_an_angle_is_sought_all_around_a_turn():
    """Of what is at one angle, no two places that are tried are the same one a turn on, and no gap is wider."""
    shapes = [shape for effect in (*catalogue().values(), *RIVALS) for shape in getattr(effect, "shapes", ())]
    grids = [shape.grid for shape in shapes if shape.additive and shape.quantity.unit == "rad"]
    angles = [np.sort(np.mod(grid, 2.0 * np.pi)) for grid in grids if grid]
    assert angles
    for places_tried in angles:
        around = np.diff(np.append(places_tried, places_tried[0] + 2.0 * np.pi))
        np.testing.assert_allclose(around, 2.0 * np.pi / places_tried.size, rtol=1e-9)
