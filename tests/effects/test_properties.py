"""What effects declare of their columns is what these do: each declaration against the behaviour of the object.

Asked are all effects that there are, those of other packages too where some are installed.
"""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.effect import (
    Bristles,
    Columns,
    Coupling,
    Distortion,
    Effect,
    Lag,
    Occasional,
    Stage,
)
from bench.effects.torque import Friction, Inertia, Torque
from bench.effects.waves import Wave
from bench.plant.axis_model import build_spec
from bench.trace.signals import KNOWN_TORQUE
from bench.validation.independent.effects import KINDS
from tests.effects.axes import PARAMETERS, PERIOD, model
from tests.effects.recording import (
    BASE,
    RECORDED,
    SCOPES,
    STEP,
    changed,
    differ,
    every,
    plain,
    raw,
    reported,
    shape_of,
    with_columns,
)

AXIS = model().axis


def without_fault(effect, seen):
    """The recording as a fit with the effect sees it."""
    return effect.without_fault(seen, shape_of(effect)) if isinstance(effect, Distortion) else seen


@every
def test_it_is_sought_in_the_torque_balance_only_if_it_changes_that(effect):
    """By columns, by a delay of them, or by another motion; what only the drive shows is detected elsewhere."""
    changes = isinstance(effect, Columns | Lag | Distortion)
    assert changes or not any(effect.sought(scope) for scope in SCOPES)


@every
def test_it_copies_torque_if_its_columns_are_made_of_torque(effect):
    other = np.roll(RECORDED.torque, 300)
    assert (effect.copies_torque or effect.rescales_torque) == changed(effect, torque=other)


@every
def test_it_scales_or_carries_friction_if_its_columns_follow_the_level_others_make(effect):
    louder = changed(effect, friction=2.0 * RECORDED.friction)
    assert louder == (effect.scales_friction or isinstance(effect, Bristles))
    if effect.scales_friction:
        none, once, twice = (
            np.array(raw(effect, replace(RECORDED, friction=factor * RECORDED.friction))) for factor in (0.0, 1.0, 2.0)
        )
        np.testing.assert_allclose(twice - once, once - none, atol=1e-12)


@every
def test_it_is_of_speed_alone_if_speed_makes_all_of_its_columns_and_they_vary(effect):
    alone = False
    if isinstance(effect, Columns):
        shuffled = np.random.default_rng(0).permutation(RECORDED.time.size)
        speed = {"velocity": RECORDED.velocity[shuffled], "sign": RECORDED.sign[shuffled]}
        moved = raw(effect, replace(RECORDED, **speed))
        alone = not differ([column[shuffled] for column in raw(effect, RECORDED)], moved)
        alone = alone and changed(effect, **speed)
    assert effect.of_speed == alone


@every
def test_columns_that_are_accelerations_hear_the_noise_of_motion(effect):
    """A vibration too small for a gap comes out of the first column as the declared noise does."""
    if not isinstance(effect, Coupling):
        return
    time = STEP * np.arange(4000)
    settled = np.concatenate([np.zeros(2000), np.hanning(2000)])  # deaf to a load that drifts within its gap
    for frequency in (5.0, 40.0):
        omega = 2.0 * np.pi * frequency
        small = 1e-4 * np.exp(1j * omega * time)
        heard = 0.0 + 0.0j
        for part, unit in ((np.real, 1.0), (np.imag, 1j)):
            zero = np.zeros_like(time)
            vibration = replace(
                RECORDED, time=time, position=part(small / (1j * omega)), velocity=part(small),
                sign=zero, effort=zero, torque=zero, friction=zero,
            )  # fmt: skip
            terms = effect.columns(vibration, shape_of(effect))[0]
            listen = settled * small.conj()
            heard += unit * sum(np.sum(values * listen) * (1j * omega) ** order for values, order in terms)
        gain = heard / np.sum(settled * np.abs(small) ** 2) / (1j * omega)
        declared = effect.noise_of_motion(shape_of(effect), np.array([omega]))[0]
        assert gain == pytest.approx(declared, abs=0.02 * max(abs(declared), 1.0))


@every
def test_noise_of_motion_biases_what_filters_the_motion(effect):
    """In its own column, as a coupling does, or in all of them, as a lag: the residual is least where it is damped."""
    filters = isinstance(effect, Lag) and effect.signal != "current"
    if isinstance(effect, Coupling):
        heard = effect.noise_of_motion(shape_of(effect), 2.0 * np.pi * np.array([1.0, 10.0, 100.0]))
        filters = np.ptp(np.abs(heard)) > 0.0
    assert effect.filters_motion == filters


@every
def test_a_wave_repeats_with_its_number_and_what_repeats_is_a_wave(effect):
    number = effect.wave_number(shape_of(effect)) if isinstance(effect, Wave) else None
    position = RECORDED.position

    def shifted(by):
        seen = without_fault(effect, replace(RECORDED, position=position + by))
        return [seen.position - by, seen.velocity, *raw(effect, replace(RECORDED, position=position + by))]

    at_home, once_more, elsewhere = (shifted(by) for by in (0.0, 2.0 * np.pi, 0.7))
    assert (number is not None) == (differ(at_home, elsewhere) and not differ(at_home, once_more))
    if number is not None:
        assert not differ(at_home, shifted(2.0 * np.pi / number))
        assert differ(at_home, shifted(np.pi / number))


@every
def test_it_turns_only_if_it_is_a_wave_of_a_revolution(effect):
    """A linear axis has none; a harmonic is a pitch there."""
    once = isinstance(effect, Wave) and effect.once_per_revolution
    assert not (once and effect.name in KINDS and KINDS[effect.name].on_linear_axis)
    weighed = [replace(scope, signals=scope.signals | {KNOWN_TORQUE}) for scope in SCOPES if not scope.kind.turns]
    asked = [effect.sought(scope) for scope in weighed]
    assert once == (not any(asked)) or not isinstance(effect, Columns)


@every
def test_what_happens_in_one_recording_only_is_absent_for_a_while(effect):
    """A motion in which something is never felt for a while, though the axis moves as before."""
    quiet = False
    if isinstance(effect, Columns):
        stretches = [np.array_split(column, 5) for column in raw(effect, RECORDED)]
        quiet = any(not any(np.any(parts[k]) for parts in stretches) for k in range(5))
    assert isinstance(effect, Occasional) == quiet


@every
def test_several_of_a_repeatable_one_are_distinguished(effect):
    if not effect.repeatable:
        return
    assert effect.shapes
    assert all(slot.whole or slot.additive for slot in effect.shapes)
    shape = shape_of(effect)
    for k, slot in enumerate(effect.shapes):
        other = tuple(value + (1.0 if slot.whole else 0.1) * (j == k) for j, value in enumerate(shape))
        table = [values for which in (shape, other) for ((values, _),) in effect.columns(RECORDED, which)]
        assert np.linalg.matrix_rank(np.array(table)) == len(table)


@every
def test_the_level_of_friction_is_what_its_columns_make_of_dry_friction(effect):
    """Column by column: dry friction all of it, friction in proportion to speed none of it."""
    if not isinstance(effect, Friction):
        return
    shape, faster = shape_of(effect), replace(RECORDED, velocity=2.0 * RECORDED.velocity)
    columns, scaled = plain(effect, RECORDED), plain(effect, faster)
    units = [[1.0] * count + [0.0] * (len(columns) - count) for count in range(len(columns) + 1)]
    for k in range(len(columns)):
        below, level = (effect.signed(RECORDED, unit, shape) for unit in units[k : k + 2])
        level = level - below
        viscous = not differ([2.0 * columns[k]], [scaled[k]]) and np.any(columns[k])
        np.testing.assert_allclose(level, 0.0 * columns[k] if viscous else columns[k], atol=1e-12)


@with_columns
def test_stiffness_is_the_slope_of_its_torque_over_position(effect):
    higher, lower = (plain(effect, replace(RECORDED, position=RECORDED.position + by)) for by in (0.5, -0.5))
    slopes = [a - b for a, b in zip(higher, lower, strict=True)]
    straight = slopes and all(np.ptp(slope) < 1e-9 for slope in slopes)
    assert effect.spring == bool(straight and sum(float(s[0]) for s in slopes))
    if effect.spring:
        assert [float(s[0]) for s in slopes] == pytest.approx([1.0, 0.0])  # and what its reference makes constant


@every
def test_a_torque_without_memory_is_the_sum_of_its_columns(effect):
    """It is linear in its strengths, so the same to the balance and to a step."""
    if isinstance(effect, Torque) and not isinstance(effect, Inertia):
        columns, shape = plain(effect, RECORDED), shape_of(effect)
        strengths = [0.02, -0.013][: len(columns)]
        found = effect.torque(effect.report(strengths, shape, RECORDED.unit), RECORDED.unit, RECORDED.state)
        if isinstance(effect, Friction):
            found = found + effect.signed(RECORDED, strengths, shape)
        np.testing.assert_allclose(np.array(strengths) @ columns, found * np.ones(RECORDED.time.size), atol=1e-12)


@every
def test_a_torque_acts_at_a_stage_that_is_simulated(effect):
    if isinstance(effect, Torque):
        of_mechanics = isinstance(effect, Friction | Inertia)
        chain = () if of_mechanics else (Stage.CURRENT_SENSOR, Stage.TORQUE_CONSTANT, Stage.COMMUTATION)
        assert effect.stage in (*chain, Stage.MECHANICS)


@every
def test_friction_follows_a_load_if_its_columns_do(effect):
    assert effect.follows_load == changed(effect, load=np.sin(RECORDED.time))


@every
def test_what_may_act_on_a_load_is_a_torque_of_motion_and_time_alone(effect):
    """A load has no motor torque, no friction here and no harmonics of a motor; a constant only twists the coupling."""
    outer = effect.stage == Stage.MECHANICS and isinstance(effect, Columns)
    outer = outer and not isinstance(effect, Coupling | Friction)
    if outer:
        shaken = np.random.default_rng(0).normal(size=RECORDED.time.size)
        alone = not changed(effect, torque=shaken, effort=shaken, friction=shaken, sign=shaken)
        varies = any(np.ptp(column) > 0.0 for column in raw(effect, RECORDED))
        torque = all([order for _, order in column] == [0] for column in effect.columns(RECORDED, shape_of(effect)))
        outer = alone and varies and torque and not any(slot.whole for slot in effect.shapes)
    assert effect.external == outer, f"columns of {effect.name} {'are' if outer else 'are not'} such"


@every
def test_a_coupling_gives_the_axis_a_second_degree_of_freedom(effect):
    joints = 1
    if type(effect).add is not Effect.add:
        spec = build_spec(PARAMETERS, PERIOD)
        effect.add(spec, effect.name, {**effect.defaults(AXIS), **reported(effect)}, AXIS)
        joints = spec.compile().nv
    assert isinstance(effect, Coupling) == (joints == 2)
    if isinstance(effect, Coupling):
        assert effect.physical([0.5 * BASE.inertia], shape_of(effect), BASE)
        assert not effect.physical([BASE.inertia], shape_of(effect), BASE)
