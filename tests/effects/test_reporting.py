"""What effects say of each other and of their quantities holds.

Asked are all effects that there are, those of other packages too where some are installed.
"""

import numpy as np
import pytest

from bench.effects.catalogue import simpler_forms
from bench.effects.effect import Columns, Distortion, Effect, Lag
from bench.effects.present import Present
from bench.effects.shape import grid_of
from bench.effects.signals import Axis
from tests.effects.axes import model
from tests.effects.recording import BASE, EFFECTS, RECORDED, SCOPES, every, plain, reported, shape_of, with_columns

AXIS = model().axis

# What it says of other effects.


@every
def test_lags_are_distinguished_by_no_recording_or_by_some(effect):
    if isinstance(effect, Lag):
        names = {name for scope in SCOPES for name in effect.ambiguous(scope)}
        assert names
        assert all(isinstance(EFFECTS[name], Lag) for name in names)
        assert effect.name not in names


@every
def test_ambiguity_is_mutual(effect):
    for scope in SCOPES:
        for name in effect.ambiguous(scope):
            assert effect.name in EFFECTS[name].ambiguous(scope)


@every
def test_a_lag_of_the_motion_looks_like_another_with_the_same_values(effect):
    if isinstance(effect, Lag) and effect.filters_motion:
        for name in {name for scope in SCOPES for name in effect.ambiguous(scope)}:
            if EFFECTS[name].filters_motion:
                assert dict(Present.of(name, reported(effect)).values) == reported(effect)


@every
def test_what_it_replaces_is_in_the_catalogue(effect):
    assert effect.replaces <= set(EFFECTS) - {effect.name}


@with_columns
def test_a_simpler_form_is_contained(effect):
    own = np.array(plain(effect, RECORDED)).T
    for form in (form for scope in SCOPES for form in simpler_forms(effect, scope)):
        assert not any(simpler_forms(form, scope) for scope in SCOPES)
        simple = np.array(plain(form, RECORDED)).T
        left = simple - own @ np.linalg.lstsq(own, simple, rcond=None)[0]
        assert np.abs(left).max() < 1e-9 * np.abs(simple).max()
        assert own.shape[1] > simple.shape[1]


@every
def test_a_constant_torque_is_its_strength_in_every_motion(effect):
    """So that in one direction it stands for dry friction as large."""
    constant = isinstance(effect, Columns) and not effect.shapes
    constant = constant and [column.tolist() for column in plain(effect, RECORDED)] == [[1.0] * RECORDED.time.size]
    assert effect.constant == constant
    if constant:
        values = effect.report([-0.08], (), BASE)
        assert Present.of(effect.name, values).values == tuple(values.items())


# How it is reported.


@every
def test_it_reports_its_quantities_and_what_follows_from_them(effect):
    if not isinstance(effect, (Columns, Distortion)):
        assert type(effect).detect is not Effect.detect
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
    assert instants == {slot.quantity.name for slot in effect.shapes if slot.quantity.instant}
    assert whole | instants <= {quantity.name for quantity in effect.quantities}


@every
def test_null_values_and_defaults_are_quantities_within_bounds(effect):
    bounds = {quantity.name: quantity for quantity in effect.quantities}
    for values in (effect.null(AXIS), effect.defaults(AXIS)):
        for name, value in values.items():
            assert bounds[name].lower <= float(value) <= bounds[name].upper
    assert effect.null(AXIS)


@every
def test_shapes_that_are_tried_are_of_its_form(effect):
    for scope in SCOPES:
        grid = grid_of(effect.shapes, scope)
        assert all(len(shape) == len(effect.shapes) for shape in grid)
        tried = grid if grid and all(map(len, grid)) else [shape_of(effect)]
        assert any(effect.plausible([], [shape], scope) for shape in tried)
        for shape in tried[:: max(1, len(tried) // 5)]:
            errors = effect.shape_errors(shape, scope, RECORDED.time)
            assert len(errors) == len(effect.shapes)
            assert min(errors, default=0.0) >= 0.0
            assert all(effect.reach(shape, k) >= 0.0 for k in range(len(effect.shapes)))


@every
def test_it_is_found_where_its_name_says(effect):
    assert type(effect).__module__.split(".")[-1] == effect.name
    assert not hasattr(effect, "__dict__") or not vars(effect)


@pytest.mark.parametrize(
    ("name", "strengths", "shape", "expected"),
    [
        ("torsion_spring", (15.0, 4.5), (), {"stiffness": 15.0, "reference": 0.3}),
        ("torsion_spring", (0.0, 4.5), (), {"stiffness": 0.0, "reference": 0.0}),
        (
            "directional_load_friction",
            (0.2,),
            (3.0,),
            {"motor_coefficient": 0.2, "load_ratio": 3.0, "load_coefficient": 0.6},
        ),
    ],
)
def test_quantities_of_a_fit(name, strengths, shape, expected):
    assert EFFECTS[name].report(strengths, shape, BASE) == pytest.approx(expected)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_friction_that_a_fit_found_warming_moves_as_it_was_fitted(share):
    """Strengths of its columns, dry and viscous, as quantities: the torque of the columns is that of the model."""
    effect, base = EFFECTS["friction_warmup"], Axis(1e-3, 2e-3, 0.06)
    strengths = [1.5 * base.coulomb, share * 1.5 * base.viscous]
    values = effect.report(strengths, [0.3], base)
    assert values == pytest.approx({"relative_amplitude": 1.5, "time_constant": 0.3, "viscous_share": share})
    columns = [values for ((values, _),) in effect.columns(RECORDED, [0.3])]
    at = RECORDED.state._replace(friction=base.coulomb * RECORDED.friction)
    moves = effect.friction(values, base, at) + effect.torque(values, base, at)
    np.testing.assert_allclose(np.array(strengths) @ columns, moves, atol=1e-12)
