"""What effects say of each other and of their quantities holds.

Asked are all effects that there are, those of other packages too where some are installed.
"""

import numpy as np
import pytest

from bench.effects.present import Present
from tests.effects.axes import model
from tests.effects.recording import BASE, EFFECTS, RECORDED, SCOPES, every, plain, reported, shape_of, with_columns

AXIS = model().axis

# What it says of other effects.


@every
def test_what_excludes_another_is_excluded_by_it(effect):
    assert effect.name not in effect.not_beside | effect.replaces
    for name in effect.not_beside:
        assert effect.name in EFFECTS[name].not_beside
        assert any(name in effect.ambiguous(scope) for scope in SCOPES)


@every
def test_ambiguity_is_mutual(effect):
    for scope in SCOPES:
        for name in effect.ambiguous(scope):
            assert effect.name in EFFECTS[name].ambiguous(scope)


@every
def test_a_counterpart_is_an_effect_with_the_same_as_its_own(effect):
    names = {name for scope in SCOPES for name in effect.ambiguous(scope)}
    for name in names:
        values = effect.counterpart(name, reported(effect))
        if values is not None:
            assert Present.of(name, values).effect is EFFECTS[name]
            assert EFFECTS[name].counterpart(effect.name, values) == reported(effect)
    assert bool(names) or not effect.overrides("counterpart")


@every
def test_what_it_replaces_is_in_the_catalogue_and_has_a_shape_to_replace_it_with(effect):
    assert effect.replaces <= set(EFFECTS)
    assert bool(effect.replaces) == effect.overrides("in_place_of")


@every
def test_what_bursts_leaves_torque_open_and_a_remainder_that_is_borne(effect):
    assert effect.bursts == effect.overrides("open_torque") == (effect.tolerates is not None)
    assert effect.tolerates is None or 0.0 < effect.tolerates < 1.0


@with_columns
def test_a_simpler_form_is_contained(effect):
    own = np.array(plain(effect, RECORDED)).T
    for name in effect.simpler_forms():
        assert EFFECTS[name].simpler_forms() == ()
        simple = np.array(plain(EFFECTS[name], RECORDED)).T
        left = simple - own @ np.linalg.lstsq(own, simple, rcond=None)[0]
        assert np.abs(left).max() < 1e-9 * np.abs(simple).max()
        assert own.shape[1] > simple.shape[1]


@every
def test_what_stands_for_dry_friction_in_one_direction_is_as_large(effect):
    for torque in (0.08, -0.08):
        values = effect.instead_of_dry_friction(torque)
        if values is None:
            continue
        assert Present.of(effect.name, values).values == tuple(values.items())
        table = np.array(plain(effect, RECORDED)).T
        strengths = np.linalg.lstsq(table, np.full(RECORDED.time.size, torque), rcond=None)[0]
        np.testing.assert_allclose(table @ strengths, torque)
        assert effect.report(strengths.tolist(), shape_of(effect), BASE) == pytest.approx(values)


# How it is told.


@every
def test_it_reports_its_quantities_and_what_follows_from_them(effect):
    if not (effect.overrides("columns") or effect.overrides("see") or effect.overrides("delays")):
        assert effect.overrides("detect")
        return
    names = {quantity.name for quantity in effect.quantities}
    found = set(reported(effect))
    assert found <= names | {quantity.name for quantity in effect.derived}
    assert names - found <= set(effect.defaults(AXIS))
    assert {quantity.name for quantity in effect.derived} <= found


@every
def test_what_a_simulation_cannot_move_a_little_is_left_alone(effect):
    """Whole numbers, and instants: between two samples nothing changes."""
    whole = {slot.quantity.name for slot in effect.shapes if slot.whole}
    instants = {slot.quantity.name for slot in effect.shapes if slot.additive and slot.quantity.unit == "s"}
    assert effect.fixed_in_simulation == whole | instants
    assert effect.fixed_in_simulation <= {quantity.name for quantity in effect.quantities}


@every
def test_null_values_and_defaults_are_quantities_within_bounds(effect):
    bounds = {quantity.name: quantity for quantity in effect.quantities}
    for values in (effect.null(AXIS), effect.defaults(AXIS)):
        for name, value in values.items():
            assert bounds[name].lower <= float(value) <= bounds[name].upper
    assert effect.null(AXIS)


@every
def test_shapes_that_are_tried_are_of_its_form_and_worth_a_share(effect):
    for scope in SCOPES:
        grid = effect.grid(scope)
        assert all(len(shape) == len(effect.shapes) for shape in grid)
        tried = grid if grid and all(map(len, grid)) else [shape_of(effect)]
        assert any(effect.plausible([], [shape], scope) for shape in tried)
        for shape in tried[:: max(1, len(tried) // 5)]:
            assert 0.0 < effect.needed_share(shape, scope) < 1.0
            errors = effect.shape_errors(shape, scope, RECORDED.time)
            assert len(errors) == len(effect.shapes)
            assert min(errors, default=0.0) >= 0.0
            assert all(effect.reach(shape, k) >= 0.0 for k in range(len(effect.shapes)))


@every
def test_it_is_shown_under_the_drive_in_a_part_of_the_recording(effect):
    assert effect.shows_under_drive == effect.overrides("shown_in")
    assert effect.overrides("detect") or not effect.shows_under_drive


@every
def test_it_is_found_where_its_name_says(effect):
    assert type(effect).__module__.split(".")[-1] == effect.name
    assert not hasattr(effect, "__dict__") or not vars(effect)
