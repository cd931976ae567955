"""One engine: identify and diagnose tell the same of the same rows, and the floor is the noise's, whatever moves."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from bench.axis_kind import COULOMB
from bench.diagnosis.diagnosis import diagnose
from bench.diagnosis.recordings import fit_bare
from bench.effects.catalogue import catalogue
from bench.effects.effect import Coupling
from bench.effects.shape import grid_of
from bench.fit.fit import _balanced, _own, _taken, fit
from bench.fit.hypothesis import Hypothesis, Term, depended_on
from bench.fit.identify import identify
from bench.fit.rows import Rows
from bench.trace.trace import Trace
from tests.diagnosis.constructed import (
    CONSTANT,
    RIG,
    base,
    moved,
    recorded,
)

RIGID = [name for name, effect in catalogue().items() if not isinstance(effect, Coupling)]


def coloured(motion):
    white = np.random.default_rng(8).normal(scale=0.01, size=motion.time.size)
    return lfilter([0.4], [1.0, -0.8], white)


def hum(motion):
    return 0.03 * np.sin(2.0 * np.pi * 50.0 * motion.time)


def coarse(motion):
    return np.round(base(motion) / 0.01) * 0.01 - base(motion)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("noise", [None, coloured, hum, coarse], ids=["white", "coloured", "hum", "coarse"])
def test_identify_and_diagnose_tell_the_same_of_a_null(seed, noise):
    trace = recorded(moved(), seed=seed, pick_up=noise)
    diagnosed = diagnose(trace, RIG, excluded=frozenset(catalogue()) - {"unbalance"}).parameters
    found = identify(trace, RIG).parameters
    for name in ("moment_of_inertia", "viscous_friction_coefficient", "coulomb_friction_torque"):
        assert diagnosed[name].value == pytest.approx(found[name].value, rel=1e-9)
        assert diagnosed[name].ci95 == pytest.approx(found[name].ci95, rel=1e-6)


@pytest.mark.parametrize(("duration", "period"), [(1.0, 1e-3), (300.0, 2e-3)])
def test_a_clean_recording_in_one_direction_leaves_noise_alone(duration, period):
    """Position ends far from where it began, a step to any transform that takes the stretch for one period."""
    motion = moved(duration, sines=((0.8, 2.0, 0.2), (0.2, 5.3, 1.0)), drift=150.0, period=period)
    assert (motion.velocity > 0.0).all()
    rng = np.random.default_rng(4)
    signals = {
        "position": motion.position + 1e-6 * rng.normal(size=motion.time.size),
        "current": (base(motion) + 6e-3 * rng.normal(size=motion.time.size)) / CONSTANT,
    }
    trace = Trace(motion.time, signals, {"position": "rad", "current": "A"}, "one way")
    narrowest = 1.0 / period
    assert fit_bare(Rows.of(trace, RIG, cutoff=narrowest)).chi < 1.12


@pytest.mark.parametrize("name", ["cogging_torque", "torque_ripple", "position_dependent_inertia"])
def test_what_shapes_would_take_is_the_same_without_filtering_them_again(name):
    rows, effect = Rows.of(recorded(moved()), RIG), catalogue()[name]
    shapes = grid_of(effect.shapes, rows.scope)
    wave_beside = fit(
        rows, Hypothesis((Term(catalogue()["cogging_torque"], (6.0,)), Term(catalogue()["torque_offset"])))
    )
    fit_bare(rows).tried(effect, shapes)  # which filters them, and keeps their products with each other
    again = [proposal.gain for proposal in wave_beside.tried(effect, shapes)]

    def made(signals):
        return [one for shape in shapes for one in effect.columns(signals, shape)]

    columns = wave_beside.seen(made, of_motion=False)
    kept = columns if effect.copies_torque else rows.table(made)
    targets = np.column_stack([wave_beside.span, wave_beside.residual])
    expected = _taken(_own(kept, kept.shape[1] // len(shapes)), columns.T @ targets, targets)
    assert again == pytest.approx(expected, rel=1e-8, abs=1e-9 * wave_beside.squares)
    assert max(again) <= wave_beside.squares * (1.0 + 1e-9)


def test_what_an_effect_would_take_is_what_it_takes_of_rows_that_are_determined():
    rows, drag = Rows.of(recorded(moved()), RIG), catalogue()["quadratic_drag"]
    whole = fit_bare(rows)
    determined = rows.time % 1.0 > 0.4  # as beside impacts
    theta, held = _balanced(whole.layout, determined)
    fitted = replace(whole, theta=theta, held=held, determined=determined)
    beside = np.delete(fitted.columns, held, axis=1)
    more = np.column_stack([beside, fitted.seen(lambda signals: drag.columns(signals, ()), of_motion=False)])
    effort = fitted.effort[determined]

    def left(columns):
        return np.linalg.lstsq(columns[determined], effort, rcond=None)[1].item()

    assert fitted.worth([drag]) == [pytest.approx(left(beside) - left(more), rel=1e-3)]


def test_columns_depend_on_levels_of_dry_friction_over_coulombs_where_an_effect_multiplies_them():
    shapes = {"stribeck_friction": (5.0,), "position_dependent_friction": (6.0,)}
    terms = Hypothesis(tuple(Term(catalogue()[name], shape) for name, shape in shapes.items()))
    found = {COULOMB: [0.05], 0: [0.02], 1: [0.015, 0.02]}
    assert depended_on(terms, found) == pytest.approx([0.4, 0.3, 0.4])
    assert depended_on(terms.without(1), found) == []
    assert depended_on(terms, {**found, COULOMB: [0.0]}) == []
