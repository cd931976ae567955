"""Dry frictions of one axis together: bristles slide at the level that all others make."""

import numpy as np
import pytest
import scipy.integrate

from bench.diagnosis.policy import Policy
from bench.diagnosis.recordings import fit_bare
from bench.diagnosis.search import search
from bench.effects.catalogue import catalogue
from bench.effects.presliding_friction import bristles, sliding_level
from bench.fit.rows import Rows
from bench.validation.independent.effects import (
    DirectionDependentFriction,
    FrictionWarmup,
    PositionDependentFriction,
    PreslidingFriction,
    StribeckFriction,
)
from bench.validation.independent.references import random_motion
from tests.recorded import QUIET

BRISTLES = PreslidingFriction(4.0, 5e-3)
BESIDE = {
    "rise": (StribeckFriction(0.16, 3.0),),
    "direction": (DirectionDependentFriction(0.05),),
    "angle": (PositionDependentFriction(0.5, 1.0),),
    "rise and warmth": (StribeckFriction(0.16, 3.0), FrictionWarmup(0.5, 2.0)),
}


@pytest.fixture(scope="module")
def recorded():
    """A recording by what is beside the bristles."""
    motion = random_motion(QUIET.axis, np.random.default_rng(5), 6.0)
    return QUIET.record({name: (BRISTLES, *more) for name, more in BESIDE.items()}, motion, 5)


def test_bristles_slide_at_the_level_of_the_other_frictions():
    """LuGre's equation with Stribeck's level, integrated by scipy."""
    time = np.arange(0.0, 3.0, 1e-3)
    position, velocity = 0.4 * np.sin(4.0 * time), 1.6 * np.cos(4.0 * time)
    rate, rise, width = 60.0, 0.8, 0.5

    def bending(t, y):
        speed = 1.6 * np.cos(4.0 * t)
        return rate * (speed - abs(speed) * y / (1.0 + rise * np.exp(-((speed / width) ** 2))))

    expected = scipy.integrate.solve_ivp(bending, (0.0, 3.0), [0.0], t_eval=time, rtol=1e-9, atol=1e-11, max_step=1e-3)
    friction = np.sign(velocity) * (1.0 + rise * np.exp(-((velocity / width) ** 2)))
    found = bristles(position, np.sign(velocity), sliding_level(np.sign(velocity), friction), rate)
    np.testing.assert_allclose(found, expected.y[0], atol=4e-3)


@pytest.mark.parametrize("name", [*list(BESIDE)[:-1], pytest.param("rise and warmth", marks=pytest.mark.slow)])
def test_bristles_are_named_beside_other_frictions(recorded, name):
    fitted = search(fit_bare(Rows.of(recorded[name], QUIET.rig)), list(catalogue().values()), Policy()).last
    hidden = (BRISTLES, *BESIDE[name])
    assert sorted(fitted.hypothesis.names) == sorted(effect.name for effect in hidden)
    assert fitted.chi < 1.1
    index = fitted.hypothesis.names.index(BRISTLES.name)
    values = fitted.terms[index].effect.report(fitted.strengths(index), fitted.terms[index].shape, fitted.base)
    assert values["bristle_stiffness"] == pytest.approx(BRISTLES.bristle_stiffness, rel=0.05)
    assert fitted.theta[:3] == pytest.approx([QUIET.axis.inertia, QUIET.axis.viscous, QUIET.axis.coulomb], rel=0.03)
